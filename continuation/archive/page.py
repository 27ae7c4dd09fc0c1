"""The page that `continuation inspect` shows: what ran, when, with what, how it ended, its events and its work."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from continuation.archive.atomic import ArchiveError
from continuation.archive.checkpoint import Checkpoint
from continuation.archive.reader import Archive
from continuation.archive.resume import RESUMABLE
from continuation.archive.schema import ACCEPTED, COUNT_NAMES
from continuation.archive.trust import is_registered, registry
from continuation.arguments.checks import complain
from continuation.path import Path
from continuation.status import Kind, Status

UNFINISHED = Status.INTERRUPTED, Status.TRACING, Status.ABANDONED, Status.RAISED
_DETAILED = 3
_LISTED = 12
_SHOWN = 4
WIDTH = 92
_MOST_LINES = 5
_UNBROKEN = "\N{NO-BREAK SPACE}"
_SOFTWARE = {
    "continuation": "library", "Python": "python", "numpy": "numpy", "scipy": "scipy", "h5py": "h5py", "HDF5": "hdf5",
}  # fmt: skip
_SETTINGS = ("predictor", "corrector", "controller", "metric", "tolerance", "budget", "target", "events")


def describe(archive: Archive, width: int = WIDTH) -> str:
    """The page: one section a path where there are few, an overview where there are many.

    Parameters
    ----------
    archive : Archive
    width : int
        Columns; a narrower page than the usual one has its lines broken.

    Raises
    ------
    TypeError
        For anything else.
    ArchiveError
        If what the file says of itself makes no sense.
    """
    if not isinstance(archive, Archive):
        raise complain(TypeError, "archive", "an open Archive, as open_archive(file) returns", archive)
    try:
        page = _page(archive)
    except ArchiveError:
        raise
    except (ValueError, TypeError, AttributeError, LookupError, RecursionError, ArithmeticError) as error:
        raise archive.contents.damaged(error) from error
    # A title of somebody else's is no way to the terminal's control codes.
    plain = "".join(c if c.isprintable() or c == "\n" else "?" for c in page)
    fitted = (part for line in plain.split("\n") for part in _fitted(line, width))
    return plain if width >= WIDTH else "\n".join(fitted)


def _fitted(line: str, width: int) -> list[str]:
    """The line, or several if it is wider than the page."""
    if len(line) <= width:
        return [line]
    indent = " " * min(len(line) - len(line.lstrip()) + 2, width // 2)
    # A command stays in one piece.
    whole = re.sub(r"`[^`]*`", lambda command: command[0].replace(" ", _UNBROKEN), line)
    parts = textwrap.wrap(whole, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return [part.replace(_UNBROKEN, " ") for part in parts]


def _page(archive: Archive) -> str:
    few = range(len(archive) if len(archive) <= _DETAILED else 0)
    parts = [_head(archive), *(_one_path(archive, number) for number in few)]
    if not few:
        parts.append(_many_paths(archive) if len(archive) else "No path was begun.")
    return "\n\n".join(filter(None, (*parts, _hint(archive)))) + "\n"


# -- what ran -------------------------------------------------------------------------------------------------


def _head(archive: Archive) -> str:
    about = archive.attributes
    title = str(about.get("title", ""))
    homotopy = f"{about.get('homotopy', '')} ({about.get('homotopy_distribution', '')})".removesuffix(" ()")
    held = f"{_plural(len(archive), 'path')}, {_plural(archive.points.size, 'point')}"
    settings = json.loads(about.get("settings", "{}"))
    versions = ", ".join(f"{name} {about.get(f'{key}_version', '?')}" for name, key in _SOFTWARE.items())
    lines = [
        ("file", f"{archive.file}, {_bytes(archive.contents.size)}, {about.get('schema', '')}"),
        ("holds", f"{held} of {_plural(archive.layout.unknowns, 'unknown')}"),
        ("when", f"{about.get('created', '')} on {about.get('host', '')}"),
        ("homotopy", homotopy),
        ("parameters", _fields(json.loads(about.get("parameters", "{}") or "{}"))),
        *((name, _shown(settings[name])) for name in _SETTINGS if name in settings),
        ("software", versions),
        ("BLAS", f"{about.get('blas', '')}, threads {about.get('blas_threads', '')}"),
        ("parent", str(about.get("parent", ""))),
        *(("history" if i == 0 else "", line) for i, line in enumerate(str(about.get("history", "")).splitlines())),
    ]
    body = "\n".join(_wrapped(f"  {name:<11}", text) for name, text in lines if text)
    return f"{title}\n{'=' * len(title)}\n{body}"


def _shown(tree: Any) -> str:
    """A stored description as Python would print it."""
    if not isinstance(tree, dict):
        return f"{tree:g}" if isinstance(tree, float) else str(tree)
    if "class" in tree:
        name = tree["class"].rpartition(":")[2].rpartition(".")[2]
        return f"{name}({_fields(tree.get('fields') or tree.get('data', {}))})"
    items = tree.get("tuple", tree.get("list"))
    if items is not None:
        return ", ".join(map(_shown, items))
    if "array" in tree:
        place = tree["array"]
        return str(place.get("values", f"array of shape {tuple(place.get('shape', ()))}"))
    sparse = f"sparse matrix of shape {tuple(tree.get('shape', ()))}"
    return _fields(tree) if "dict" in tree else str(tree.get("function", sparse))


def _fields(tree: Any) -> str:
    fields = tree.get("dict", tree) if isinstance(tree, dict) else {}
    return ", ".join(f"{name}={_shown(value)}" for name, value in fields.items())


# -- how it went ----------------------------------------------------------------------------------------------


def _one_path(archive: Archive, number: int) -> str:
    path = archive.path(number, keep="ends")
    row = {name: column[0] for name, column in archive.paths.block(slice(number, number + 1)).items()}
    head = f"Path {number}: {path.status.name}"
    lines = [head, "-" * len(head), f"  {path.message}"]
    own = ", ".join(f"{name}={row[f'homotopy_{name}']:g}" for name in archive.layout.scalars)
    lines += [f"  with {own}"] if own and len(archive) > 1 else []
    if path.steps:
        lines += _course(archive, number, path)
        lines += _events(path)
    work = _work({name: int(row[name]) for name in COUNT_NAMES.values()})
    lines += ["", _wrapped("  work: ", f"{work}; {row['wall_time']:.3g} s")]
    return "\n".join(lines)


def _course(archive: Archive, number: int, path: Path) -> list[str]:
    start, end = path.steps[0], path.steps[-1]
    accepted = archive.points.some("role", archive.rows(number)) == ACCEPTED
    lengths, residuals, angles = (
        archive.points.some(name, archive.rows(number))[accepted] for name in ("step_length", "residual_norm", "angle")
    )
    lengths = lengths[1:]
    lines = [
        "",
        f"  {'':<8}{'lambda':>14}{'arclength':>14}  y",
        f"  {'start':<8}{start.lam:>14.8g}{start.arclength:>14.8g}  {_vector(start.y)}",
        f"  {'end':<8}{end.lam:>14.8g}{end.arclength:>14.8g}  {_vector(end.y)}",
        "",
    ]
    if lengths.size:
        residual, angle = residuals.max(), angles.max()
        lines.append(
            f"  {_plural(lengths.size, 'step')} of length {lengths.min():.3g} to {lengths.max():.3g}, median "
            f"{np.median(lengths):.3g}; largest residual {residual:.1e}; largest angle {angle:.2g} rad"
        )
    if path.end_error is not None:
        lines.append(f"  end point known to {path.end_error:.1e}")
    return lines


def _events(path: Path) -> list[str]:
    head = f"  {'event':<24}{'lambda':>16}{'arclength':>14}{'residual':>10}  y"
    lines = [
        f"  {e.name[:23]:<24}{e.lam:>16.10g}{e.arclength:>14.8g}{e.residual_norm:>10.1e}  {_vector(e.y)}"
        for e in path.events
    ]
    return ["", head, *_first(lines)] if lines else ["  no events"]


def _first(lines: list[str]) -> list[str]:
    """As many as are listed."""
    more = len(lines) - _LISTED
    return [*lines[:_LISTED], f"  ... and {more} more"] if more > 0 else lines


def _many_paths(archive: Archive) -> str:
    statuses, kinds = archive.paths["status"], archive.points["kind"]
    steps, times = archive.paths[COUNT_NAMES["accepted"]], archive.paths["wall_time"]
    lines = ["How they ended", "--------------"]
    for value, count in zip(*np.unique(statuses, return_counts=True)):
        lines.append(f"  {count:>8}  {Status(int(value)).name}")
    lines += ["", "Events", "------"]
    for number, name in enumerate(archive.event_names):
        rows = archive.points["event_index"] == number
        if rows.any():
            involved = np.unique(archive.points["path_index"][rows]).size
            lines.append(f"  {int(rows.sum()):>8}  {name}, on {_plural(involved, 'path')}")
    if not (kinds > Kind.TARGET).any():
        lines.append("  none")
    totals = {name: int(archive.paths[name].sum()) for name in COUNT_NAMES.values()}
    lines += ["", "Work", "----", _wrapped("  ", f"{_work(totals)}; {times.sum():.3g} s")]
    lines.append(f"  steps a path: {_spread(steps)}; seconds a path: {_spread(times)}")
    return "\n".join([*lines, *_failures(archive)])


def _failures(archive: Archive) -> list[str]:
    """Paths that ended by an error, with its text."""
    rows = np.flatnonzero(np.isin(archive.paths["status"], [int(status) for status in UNFINISHED]))
    messages, members = archive.paths["message"], archive.paths["member"]
    nothing = "still being traced, or its writer was killed"
    said = [
        f"  path {row} (member {members[row]}): {messages[row].decode(errors='replace') or nothing}" for row in rows
    ]
    return ["", "Not finished", "------------", *_first(said)] if said else []


def _hint(archive: Archive) -> str:
    """The next move, where there is one."""
    if not archive.closed_by_writer:
        return "Its writer is still at work, or was killed: then `continuation recover` makes the file whole."
    last, checkpoint = len(archive) - 1, archive.checkpoint()
    if checkpoint is None or checkpoint.path != last:
        return ""
    status = Status(int(archive.paths["status"][last]))
    if status not in RESUMABLE:
        return ""
    name = str(archive.attributes.get("homotopy", ""))
    if name.startswith("__main__:"):
        name = f"MODULE:{name.partition(':')[2]}"
    command = f"continuation resume {archive.file}" + ("" if _makeable(archive, checkpoint) else f" --homotopy {name}")
    if status is Status.BUDGET_EXHAUSTED:
        return f"Path {last} can be resumed with more steps: `{command} --steps N`."
    return f"Path {last} can be resumed: `{command}`."


def _makeable(archive: Archive, checkpoint: Checkpoint) -> bool:
    """Whether `resume` makes the homotopy without being told its class; nothing is made here."""
    described: Any = checkpoint.run.get("homotopy", {})
    if described.get("problem"):
        described = json.loads(archive.problem()[0])
    name = described.get("class") if isinstance(described, dict) else None
    return name is not None and (name in registry() or is_registered(name))


# -- words ----------------------------------------------------------------------------------------------------


def _wrapped(name: str, text: str) -> str:
    """The text after its name, in lines of the page's width; a matrix that would fill the page is cut."""
    filled = textwrap.fill(
        text,
        WIDTH,
        initial_indent=name,
        subsequent_indent=" " * len(name),
        max_lines=_MOST_LINES,
        placeholder=" ...",
        break_long_words=False,
        break_on_hyphens=False,
    )
    return filled.replace(_UNBROKEN, " ")


def _work(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{value}{_UNBROKEN}{name}" for name, value in counts.items())


def _spread(values: Any) -> str:
    low, middle, high = np.min(values), np.median(values), np.max(values)
    return f"{low:.3g} to {high:.3g}, median {middle:.3g}"


def _vector(y: Sequence[float] | Any) -> str:
    shown = ", ".join(f"{value:.6g}" for value in y[:_SHOWN])
    return f"({shown}{', ...' if len(y) > _SHOWN else ''})"


def _plural(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _bytes(size: float) -> str:
    power = min((int(size).bit_length() - 1) // 10, 3) if size else 0
    return f"{size / 1024**power:.{power and 1}f} {('bytes', 'KiB', 'MiB', 'GiB')[power]}"
