"""The page that `continuation inspect` shows: what ran, when, with what, how it ended, its events and its work."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from continuation.archive.atomic import ArchiveError
from continuation.archive.reader import Archive
from continuation.archive.resume import RESUMABLE
from continuation.archive.schema import ACCEPTED, COUNT_NAMES
from continuation.arguments.checks import complain
from continuation.path import Path
from continuation.status import Status

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


def describe(archive: Archive) -> str:
    """The page: one section a path where there are few, an overview where there are many.

    Parameters
    ----------
    archive : Archive

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
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in page)


def _page(archive: Archive) -> str:
    if 0 < len(archive) <= _DETAILED:
        parts = [_one_path(archive, number) for number in range(len(archive))]
    else:
        parts = [_many_paths(archive) if len(archive) else "No path was begun."]
    return "\n\n".join(filter(None, (_head(archive), *parts, _hint(archive)))) + "\n"


# -- what ran -------------------------------------------------------------------------------------------------


def _head(archive: Archive) -> str:
    about: Mapping[str, Any] = {"title": "", "settings": "{}", "parameters": "{}", **archive.attributes}
    title, settings = str(about["title"]), json.loads(about["settings"])
    homotopy = f"{about.get('homotopy', '')} ({about.get('homotopy_distribution', '')})".removesuffix(" ()")
    held = f"{_plural(len(archive), 'path')}, {_plural(archive.points.size, 'point')}"
    said = {
        "file": f"{archive.file}, {_bytes(archive.contents.size)}, {about.get('schema', '')}",
        "holds": f"{held} of {_plural(archive.layout.unknowns, 'unknown')}",
        "when": f"{about.get('created', '')} on {about.get('host', '')}",
        "homotopy": homotopy,
        "parameters": _fields(json.loads(about["parameters"] or "{}")),
        **{name: _shown(settings[name]) for name in _SETTINGS if name in settings},
        "software": ", ".join(f"{name} {about.get(f'{key}_version', '?')}" for name, key in _SOFTWARE.items()),
        "BLAS": f"{about.get('blas', '')}, threads {about.get('blas_threads', '')}",
        "parent": str(about.get("parent", "")),
    }
    lines = [*said.items(), *(("history", line) for line in str(about.get("history", "")).splitlines())]
    body = "\n".join(_wrapped(f"  {name:<11}", text) for name, text in lines if text)
    return f"{title}\n{'=' * len(title)}\n{body}"


def _shown(tree: Any) -> str:
    """A stored description as Python would print it."""
    if not isinstance(tree, dict):
        return f"{tree:g}" if isinstance(tree, float) else str(tree)
    if "class" in tree:
        name = tree["class"].rpartition(":")[2].rpartition(".")[2]
        return f"{name}({_fields(tree.get('fields') or tree.get('data', {}))})"
    if "dict" in tree:
        return _fields(tree)
    items = tree.get("tuple", tree.get("list"))
    place = tree.get("array", tree)
    shape = f"array of shape {tuple(place.get('shape', ()))}"
    return ", ".join(map(_shown, items)) if items is not None else str(tree.get("function", place.get("values", shape)))


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
        found = [
            f"  {e.name[:23]:<24}{e.lam:>16.10g}{e.arclength:>14.8g}{e.residual_norm:>10.1e}  {_vector(e.y)}"
            for e in path.events
        ]
        head = f"  {'event':<24}{'lambda':>16}{'arclength':>14}{'residual':>10}  y"
        lines += ["", head, *_first(found)] if found else ["  no events"]
    work = _work({name: int(row[name]) for name in COUNT_NAMES.values()})
    return "\n".join([*lines, "", _wrapped("  work: ", f"{work}; {row['wall_time']:.3g} s")])


def _course(archive: Archive, number: int, path: Path) -> list[str]:
    rows = archive.rows(number)
    accepted = archive.points.some("role", rows) == ACCEPTED
    lengths, residuals, angles = (
        archive.points.some(name, rows)[accepted] for name in ("step_length", "residual_norm", "angle")
    )
    lines = ["", f"  {'':<8}{'lambda':>14}{'arclength':>14}  y"]
    for name, at in (("start", path.steps[0]), ("end", path.steps[-1])):
        lines.append(f"  {name:<8}{at.lam:>14.8g}{at.arclength:>14.8g}  {_vector(at.y)}")
    if lengths.size > 1:
        steps, said = _plural(lengths.size - 1, "step"), f"{lengths[1:].min():.3g} to {lengths[1:].max():.3g}"
        most = f"largest residual {residuals.max():.1e}; largest angle {angles.max():.2g} rad"
        lines += ["", f"  {steps} of length {said}, median {np.median(lengths[1:]):.3g}; {most}"]
    return [*lines, *([] if path.end_error is None else [f"  end point known to {path.end_error:.1e}"])]


def _first(lines: list[str]) -> list[str]:
    """As many as are listed."""
    more = len(lines) - _LISTED
    return [*lines[:_LISTED], f"  ... and {more} more"] if more > 0 else lines


def _many_paths(archive: Archive) -> str:
    statuses, paths = archive.paths["status"], archive.points["path_index"]
    ended = zip(*np.unique(statuses, return_counts=True))
    lines = ["How they ended", "--------------", *(f"  {n:>8}  {Status(int(value)).name}" for value, n in ended)]
    indices = archive.points["event_index"]
    at = {name: paths[indices == number] for number, name in enumerate(archive.event_names)}
    events = [f"  {p.size:>8}  {name}, on {_plural(np.unique(p).size, 'path')}" for name, p in at.items() if p.size]
    totals = {name: int(archive.paths[name].sum()) for name in COUNT_NAMES.values()}
    steps, times = archive.paths[COUNT_NAMES["accepted"]], archive.paths["wall_time"]
    lines += ["", "Events", "------", *(events or ["  none"]), "", "Work", "----"]
    lines.append(_wrapped("  ", f"{_work(totals)}; {times.sum():.3g} s"))
    lines.append(f"  steps a path: {_spread(steps)}; seconds a path: {_spread(times)}")
    # Paths that ended by an error, with its text.
    messages, members = archive.paths["message"], archive.paths["member"]
    nothing = "still being traced, or its writer was killed"
    said = [
        f"  path {row} (member {members[row]}): {messages[row].decode(errors='replace') or nothing}"
        for row in np.flatnonzero(np.isin(statuses, [int(status) for status in UNFINISHED]))
    ]
    return "\n".join([*lines, *(["", "Not finished", "------------", *_first(said)] if said else [])])


def _hint(archive: Archive) -> str:
    """The next move, where there is one."""
    if not archive.closed_by_writer:
        return "Its writer is still at work, or was killed: then `continuation recover` makes the file whole."
    last, checkpoint = len(archive) - 1, archive.checkpoint()
    if checkpoint is None or checkpoint.path != last or archive.status(last) not in RESUMABLE:
        return ""
    about = archive.attributes
    name = str(about.get("homotopy", "")).replace("__main__:", "MODULE:")
    makeable = name.startswith("continuation.") or about.get("homotopy_entry_point", "")
    command = f"continuation resume {archive.file}" + ("" if makeable else f" --homotopy {name}")
    if archive.status(last) is Status.BUDGET_EXHAUSTED:
        return f"Path {last} can be resumed with more steps: `{command} --steps N`."
    return f"Path {last} can be resumed: `{command}`."


# -- words ----------------------------------------------------------------------------------------------------


def _wrapped(name: str, text: str) -> str:
    """The text after its name, in lines of the page's width; a matrix that would fill the page is cut."""
    lines = textwrap.fill(
        text,
        WIDTH,
        initial_indent=name,
        subsequent_indent=" " * len(name),
        max_lines=_MOST_LINES,
        placeholder=" ...",
        break_long_words=False,
        break_on_hyphens=False,
    )
    return lines.replace(_UNBROKEN, " ")


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
