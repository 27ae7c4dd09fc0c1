"""What is sound of a damaged archive: whole paths, and the beginnings of others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from continuation.archive import record
from continuation.archive.contents import Contents
from continuation.archive.copies import Share
from continuation.archive.schema import TEXT, text
from continuation.path import Path
from continuation.status import Kind, Status

Spans = Sequence[tuple[int, int]]


def salvaged(contents: Contents, lost: Mapping[str, Spans]) -> list[Share]:
    """The sound rows, path by path: each from its first point to the one before its first damaged block.

    `lost` has the unsound blocks of the tables ``"point"`` and ``"path"``.
    """
    committed = contents.committed
    sound = _outside(lost["point"], committed.points)
    rows = _outside(lost["path"], committed.paths)
    runs = dict(_runs(contents, sound))
    shares = []
    for number in sorted({*runs, *np.flatnonzero(rows).tolist()}):
        points = runs.get(number, slice(0, 0))
        own = number < committed.paths and bool(rows[number])
        shares.append(Share(contents, _row(contents, number, own, points.stop - points.start), points, number))
    return shares


def nothing(contents: Contents) -> Share:
    """No row at all, of a file to which none was committed."""
    columns = contents.layout.path_columns
    empty = {column.name: contents.read("path", column.name, slice(0, 0)) for column in columns}
    return Share(contents, empty, slice(0, 0))


def _outside(spans: Spans, size: int) -> np.ndarray[Any, Any]:
    mask = np.ones(size, dtype=bool)
    for start, stop in spans:
        mask[start:stop] = False
    return mask


def _runs(contents: Contents, sound: np.ndarray[Any, Any]) -> Iterator[tuple[int, slice]]:
    """For each path with a sound first point: its number, and the rows up to the first damaged block."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], sound, [False])).astype("i1")))
    for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist()):
        rows = slice(start, stop)
        paths, kinds = (contents.read("point", name, rows) for name in ("path_index", "kind"))
        changes = np.concatenate(([0], np.flatnonzero(np.diff(paths)) + 1, [stop - start])).tolist()
        for first, last in pairwise(changes):
            # A run that begins in the middle of a path is that path's end, of no use without its beginning.
            if kinds[first] == Kind.START:
                yield int(paths[first]), slice(start + first, start + last)


def _row(contents: Contents, number: int, own: bool, points: int) -> dict[str, Any]:
    """The path's own row; where it is lost, or has lost points, with the status INTERRUPTED."""
    columns = contents.layout.path_columns
    if own:
        row = {column.name: contents.read("path", column.name, slice(number, number + 1)) for column in columns}
    else:
        empty = {**record.of_path(Path(), None, ()), "path": number, "member": number, "n_points": points}
        row = record.to_columns(empty, contents.layout)
    if not own or row["n_points"][0] != points:
        row["status"][:], row["n_points"][:] = int(Status.INTERRUPTED), points
        row["message"][:] = text(f"{Status.INTERRUPTED} The rest of it was damaged.", TEXT)
    return row
