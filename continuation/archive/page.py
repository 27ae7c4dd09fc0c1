"""The page that `continuation inspect` prints."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from continuation.archive.reader import Archive
from continuation.archive.resume import RESUMABLE
from continuation.archive.schema import COUNT_NAMES, KINK_PART
from continuation.arguments.checks import expect
from continuation.status import Kind, Status

_LISTED = 12
"""Paths, and points, with a line of their own."""

_SOFTWARE = "library", "python", "numpy", "scipy", "h5py", "hdf5"
_SETTINGS = "predictor", "corrector", "controller", "metric", "target"


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
    expect(
        isinstance(archive, Archive), "archive", "an open Archive, as open_archive(file) returns", archive, TypeError
    )
    page = archive.contents.guarded(lambda: "\n".join(_lines(archive)))
    # A foreign title must not send control codes to the terminal.
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in page) + "\n"


def _lines(archive: Archive) -> Iterator[str]:
    about: Mapping[str, Any] = {"title": "", "settings": "{}", "parameters": "{}", **archive.attributes}
    settings, parameters = json.loads(about["settings"]), json.loads(about["parameters"])
    named = {name: settings[name] for name in _SETTINGS if name in settings}
    said = {
        "file": f"{archive.file}, {archive.contents.size:,} bytes, {about['schema']}",
        "holds": f"{len(archive)} paths, {archive.points.size} points; unknowns: {archive.layout.unknowns}",
        "when": f"{about.get('created', '')} on {about.get('host', '')}",
        "homotopy": f"{about.get('homotopy', '')} ({about.get('homotopy_distribution', '')})".removesuffix(" ()"),
        "parameters": _fields(parameters.get("dict", parameters)),
        "settings": _fields(named),
        "software": ", ".join(f"{name} {about.get(f'{name}_version', '?')}" for name in _SOFTWARE),
        "BLAS": f"{about.get('blas', '')}, threads {about.get('blas_threads', '')}",
        "parent": str(about.get("parent", "")),
        "work": ", ".join(f"{int(archive.paths[name].clip(0).sum())} {name}" for name in COUNT_NAMES.values()),
        "seconds": f"{np.nansum(archive.paths['wall_time']):.3g}",
    }
    yield from _titled(str(about["title"]), "=")
    for name, told in (*said.items(), *(("history", line) for line in str(about.get("history", "")).splitlines())):
        yield from (f"  {name:<11}{textwrap.shorten(told, 300, placeholder=' ...')}",) if told else ()
    yield from ("", *_titled("Paths", "-"), *_paths(archive), "", *_titled("Starts, events and ends", "-"))
    yield from (*_points(archive), "", _hint(archive))


def _titled(text: str, line: str) -> tuple[str, str]:
    return text, line * len(text)


def _fields(trees: Mapping[str, Any]) -> str:
    """Numbers, texts, and the names of classes."""
    plain = {name: tree.get("class", "...") if isinstance(tree, dict) else tree for name, tree in trees.items()}
    return ", ".join(f"{name}={str(value).rpartition(':')[2]}" for name, value in plain.items())


def _paths(archive: Archive) -> Iterator[str]:
    statuses, members, messages = (archive.paths[name] for name in ("status", "member", "message"))
    for value, count in zip(*np.unique(statuses, return_counts=True)):
        yield f"  {count:>8}  {Status(int(value)).name}"
    # Those that can be resumed or raised come first.
    for row in np.argsort(~np.isin(statuses, RESUMABLE), kind="stable")[:_LISTED].tolist():
        text = messages[row].decode(errors="replace") or "still being traced, or its writer was killed"
        yield f"  path {row} (member {members[row]}): {text}"


def _points(archive: Archive) -> Iterator[str]:
    points, lengths = archive.points, archive.paths["n_points"]
    ends = (np.cumsum(lengths) - 1)[lengths > 0]
    events = np.flatnonzero((points["kind"] != Kind.REGULAR) & (points["role"] != KINK_PART))
    for number, name in enumerate(archive.event_names):
        yield f"  {np.count_nonzero(points['event_index'] == number):>8}  {name}"
    yield f"  {'':<24}{'lambda':>16}{'arclength':>14}{'residual':>10}  y"
    for row in np.union1d(events, ends).astype(int)[:_LISTED].tolist():
        at = {name: points.some(name, slice(row, row + 1))[0] for name in points}
        name = archive.event_names[at["event_index"]] if at["event_index"] >= 0 else Kind(int(at["kind"])).flag
        y = ", ".join(f"{value:.6g}" for value in at["y"][:4])
        numbers = f"{at['parameter']:>16.10g}{at['arclength']:>14.8g}{at['residual_norm']:>10.1e}"
        yield f"  {name[:23]:<24}{numbers}  ({y}{', ...' if at['y'].size > 4 else ''})"


def _hint(archive: Archive) -> str:
    if not archive.closed_by_writer:
        return "Its writer is still at work, or was killed: then `continuation recover` makes the file whole."
    last, checkpoint = len(archive) - 1, archive.checkpoint()
    if checkpoint is None or checkpoint.path != last or archive.status(last) not in RESUMABLE:
        return ""
    name = str(archive.attributes.get("homotopy", "")).replace("__main__:", "MODULE:")
    makeable = name.startswith("continuation.") or archive.attributes.get("homotopy_entry_point", "")
    command = f"continuation resume {archive.file}" + ("" if makeable else f" --homotopy {name}")
    if archive.status(last) is Status.BUDGET_EXHAUSTED:
        return f"Path {last} can be resumed with more steps: `{command} --steps N`."
    return f"Path {last} can be resumed: `{command}`."
