"""The page that `continuation inspect` prints."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np

from continuation.archive.reader import Archive
from continuation.archive.resume import RESUMABLE
from continuation.archive.schema import COUNT_NAMES, PARAMETER
from continuation.arguments.checks import complain
from continuation.path import LocatedEvent, Step
from continuation.status import Status

UNFINISHED = Status.INTERRUPTED, Status.TRACING, Status.ABANDONED, Status.RAISED
_DETAILED, _LISTED, _SHOWN, _WIDTH, _LINES = 3, 12, 4, 92, 5
"""Limits of paths with a section, events or paths, components, columns, lines."""
_SOFTWARE = {
    "continuation": "library", "Python": "python", "numpy": "numpy", "scipy": "scipy", "h5py": "h5py", "HDF5": "hdf5",
}  # fmt: skip
_SETTINGS = ("predictor", "corrector", "controller", "metric", "tolerance", "budget", "target", "events")


def describe(archive: Archive) -> str:
    """The page.

    Parameters
    ----------
    archive : Archive

    Raises
    ------
    ArchiveError
        If the file is damaged.
    """
    if not isinstance(archive, Archive):
        raise complain(TypeError, "archive", "an open Archive, as open_archive(file) returns", archive)
    page = archive.contents.guarded(lambda: _page(archive))
    # A foreign title must not send control codes to the terminal.
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in page)


def _page(archive: Archive) -> str:
    few = len(archive) <= _DETAILED
    parts = [_one_path(archive, k) for k in range(len(archive))] if few else [_many_paths(archive)]
    return "\n\n".join(filter(None, (_head(archive), *(parts or ["No path was begun."]), _hint(archive)))) + "\n"


def _head(archive: Archive) -> str:
    about: Mapping[str, Any] = {"title": "", "settings": "{}", "parameters": "{}", **archive.attributes}
    settings, size = json.loads(about["settings"]), archive.contents.size
    said = {
        "file": f"{archive.file}, {size:,} bytes, {about.get('schema', '')}",
        "holds": f"{len(archive)} paths, {archive.points.size} points; unknowns: {archive.layout.unknowns}",
        "when": f"{about.get('created', '')} on {about.get('host', '')}",
        "homotopy": f"{about.get('homotopy', '')} ({about.get('homotopy_distribution', '')})".removesuffix(" ()"),
        "parameters": _fields(json.loads(about["parameters"] or "{}")),
        **{name: _shown(settings[name]) for name in _SETTINGS if name in settings},
        "software": ", ".join(f"{name} {about.get(f'{key}_version', '?')}" for name, key in _SOFTWARE.items()),
        "BLAS": f"{about.get('blas', '')}, threads {about.get('blas_threads', '')}",
        "parent": str(about.get("parent", "")),
    }
    lines = [*said.items(), *(("history", line) for line in str(about.get("history", "")).splitlines())]
    return "\n".join(
        [_titled(str(about["title"]), "="), *(_wrapped(f"{name:<11}", text) for name, text in lines if text)]
    )


def _shown(tree: Any) -> str:
    if not isinstance(tree, dict):
        return f"{tree:g}" if isinstance(tree, float) else str(tree)
    if "class" in tree:
        name = tree["class"].rpartition(":")[2].rpartition(".")[2]
        return f"{name}({_fields(tree.get('fields') or tree.get('data', {}))})"
    if "dict" in tree:
        return _fields(tree)
    items, place = tree.get("tuple", tree.get("list")), tree.get("array", tree)
    shape = f"array of shape {tuple(place.get('shape', ()))}"
    return ", ".join(map(_shown, items)) if items is not None else str(tree.get("function", place.get("values", shape)))


def _fields(tree: Any) -> str:
    fields = tree.get("dict", tree) if isinstance(tree, dict) else {}
    return ", ".join(f"{name}={_shown(value)}" for name, value in fields.items())


def _one_path(archive: Archive, number: int) -> str:
    path = archive.path(number, keep="ends")
    lines = [_titled(f"Path {number}: {path.status.name}", "-"), f"  {path.message}"]
    named = [(name, archive.paths[PARAMETER + name][number]) for name in archive.layout.own(PARAMETER)]
    own = ", ".join(f"{name}={value:g}" for name, value in named)
    lines += [f"  with {own}"] if own and len(archive) > 1 else []
    if path.steps:
        lines += ["", f"  {'':<24}{'lambda':>16}{'arclength':>14}{'residual':>10}  y"]
        listed: list[tuple[str, Step | LocatedEvent]] = [("start", path.steps[0])]
        listed += [(event.name[:23], event) for event in path.events[:_LISTED]]
        for name, at in (*listed, ("end", path.steps[-1])):
            y = ", ".join(f"{value:.6g}" for value in at.y[:_SHOWN]) + (", ..." if at.y.size > _SHOWN else "")
            lines.append(f"  {name:<24}{at.lam:>16.10g}{at.arclength:>14.8g}{at.residual_norm:>10.1e}  ({y})")
    more = len(path.events) - _LISTED
    lines += [f"  ... and {more} more events"] if more > 0 else []
    lines += [] if path.end_error is None else [f"  end point known to {path.end_error:.1e}"]
    return "\n".join([*lines, "", _work(archive, slice(number, number + 1))])


def _many_paths(archive: Archive) -> str:
    statuses, paths = archive.paths["status"], archive.points["path_index"]
    lines = [_titled("How they ended", "-")]
    lines += [f"  {n:>8}  {Status(int(value)).name}" for value, n in zip(*np.unique(statuses, return_counts=True))]
    lines += ["", _titled("Events", "-")]
    for number, name in enumerate(archive.event_names):
        at = paths[archive.points["event_index"] == number]
        lines.append(f"  {at.size:>8}  {name}, on {np.unique(at).size} of the paths")
    messages, members = archive.paths["message"], archive.paths["member"]
    unfinished = np.flatnonzero(np.isin(statuses, [int(status) for status in UNFINISHED]))
    lines += ["", _titled("Not finished", "-")] if unfinished.size else []
    for row in unfinished[:_LISTED]:
        text = messages[row].decode(errors="replace") or "still being traced, or its writer was killed"
        lines.append(f"  path {row} (member {members[row]}): {text}")
    lines += [f"  ... and {unfinished.size - _LISTED} more"] if unfinished.size > _LISTED else []
    return "\n".join([*lines, "", _work(archive, slice(0, len(archive)))])


def _hint(archive: Archive) -> str:
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


def _titled(text: str, line: str) -> str:
    return f"{text}\n{line * len(text)}"


def _wrapped(name: str, text: str) -> str:
    indent = " " * (2 + len(name))
    return textwrap.fill(
        text, _WIDTH, initial_indent=f"  {name}", subsequent_indent=indent, max_lines=_LINES, placeholder=" ...",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip


def _work(archive: Archive, rows: slice) -> str:
    counts = ", ".join(f"{int(archive.paths[name][rows].sum())} {name}" for name in COUNT_NAMES.values())
    return _wrapped("work: ", f"{counts}; {archive.paths['wall_time'][rows].sum():.3g} s")
