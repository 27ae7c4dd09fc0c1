"""`recover`: what a killed writer or a damaged disk left, made into a whole file."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from itertools import pairwise
from os import PathLike
from pathlib import Path as File
from typing import Any

import numpy as np

from continuation.archive.atomic import ArchiveError, Lock, as_file, locked
from continuation.archive.checkpoint import Checkpoint, pack
from continuation.archive.contents import Contents
from continuation.archive.copies import Share, filled, interrupt, share_of, write_copy
from continuation.archive.provenance import history
from continuation.archive.reader import open_archive
from continuation.archive.rows import record_of, row_columns
from continuation.archive.schema import SLOTS, TEXT, text
from continuation.archive.store import put
from continuation.path import Path
from continuation.status import Kind, Status

Spans = Sequence[tuple[int, int]]


def salvaged(contents: Contents, lost: Mapping[str, Spans]) -> list[Share]:
    """The sound rows, path by path: each from its first point to the one before its first damaged block.

    `lost` has the unsound blocks of the tables ``"point"`` and ``"path"``. Of a file without rows there is one share.
    """
    committed, layout = contents.committed, contents.layout
    rows = _outside(lost["path"], committed.paths)
    runs = dict(_runs(contents, _outside(lost["point"], committed.points)))
    shares = []
    for number in sorted({*runs, *np.flatnonzero(rows).tolist()}):
        points = runs.get(number, slice(0, 0))
        own = number < committed.paths and bool(rows[number])
        shares.append(Share.of(contents, _row(contents, number, own, points.stop - points.start), points, number))
    nothing = Share.of(contents, filled({}, layout, layout.path_columns, 0), slice(0, 0))
    return shares or ([] if any(lost.values()) or any(contents.cut_off.values()) else [nothing])


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
        empty = {**record_of(Path(), None, ()), "path": number, "member": number, "n_points": points}
        row = row_columns(empty, contents.layout)
    if not own or row["n_points"][0] != points:
        row["status"][:], row["n_points"][:] = int(Status.INTERRUPTED), points
        row["message"][:] = text(f"{Status.INTERRUPTED} The rest of it was damaged.", TEXT)
    return row


def recover(file: str | PathLike[str], *, force: bool = False) -> File:
    """Make the file of a killed writer whole: its committed rows, copied, in its place.

    A path without an end gets the status INTERRUPTED, and can be resumed. A file that was closed properly and is sound
    stays as it is. Of a damaged one the sound rows are kept: a path is cut before its first row that is not what was
    written, and the damaged file is kept beside as ``NAME.damaged``.

    Parameters
    ----------
    file : path
    force : bool
        Also if the process that wrote it seems to be alive. A file that is still being written must not be
        recovered: its writer would go on with the old one.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    ArchiveError
        If it is no archive, its structure is damaged, it is read-only, or is being written.
    """
    name = as_file("file", file)
    with ExitStack() as stack:
        contents = stack.enter_context(closing(Contents(name, salvage=True)))
        lost = {table: contents.unsound(table) for table in ("point", "path")}
        damaged, slots = any(lost.values()) or any(contents.cut_off.values()), dict[int, bytes]()
        if damaged or contents.flaws:
            shares = salvaged(contents, lost)
            dropped = sum(stop - start for start, stop in lost["point"]) + contents.cut_off["point"]
            flaws = "; ".join(contents.flaws) or "damaged"
            what = f"recovered: {flaws}; {dropped} points were not what was written"
        else:
            archive = stack.enter_context(open_archive(name))
            if archive.closed_by_writer and (not len(archive) or archive.paths["status"][-1] != Status.TRACING):
                return name
            shares, what = [share_of(archive)], "recovered after its writer was killed"
            interrupt(shares[0].paths)
            slots = kept(archive.checkpoint())
        real = File(os.path.realpath(name))
        stack.enter_context(closing(own(contents, real, force=force)))
        if not shares:
            raise ArchiveError(f"{name}: is damaged, and none of its rows is sound")
        attributes = _legible({**contents.attributes, **history(contents.attributes, what)})
        # What is dropped may be worth more to somebody else than it is to us.
        if damaged:
            _keep_aside(real)
        put(real, lambda part: write_copy(shares, part, attributes=attributes, checkpoints=slots), replace=True)
    return name


def _keep_aside(file: File) -> None:
    """The damaged file under a name of its own."""
    aside = file.with_name(f"{file.name}.damaged")
    try:
        os.link(file, aside)
    except FileExistsError:
        raise ArchiveError(f"{file}: is damaged, and would be kept as {aside.name}, which exists already") from None
    except OSError as error:
        raise ArchiveError(f"{file}: is damaged, and cannot be kept as {aside.name} ({error.strerror})") from None


def _legible(attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes that can be written again, whatever happened to their text."""
    return {
        name.encode(errors="replace").decode(): value.encode(errors="replace").decode()
        if isinstance(value, str) else value
        for name, value in attributes.items()
    }  # fmt: skip


def kept(checkpoint: Checkpoint | None) -> dict[int, bytes]:
    """The checkpoint in its slot of a new file, which is not the one that the next is written to."""
    return {} if checkpoint is None else {checkpoint.sequence % SLOTS: pack(checkpoint)}


def own(contents: Contents, file: File, *, force: bool = False) -> Lock:
    """The right to replace a file (no link to it) that was read; by force also if its writer seems to be at work.

    Raises `ArchiveError` if it may not be written, is being written, or was replaced since it was opened.
    """
    # The mode too, since root may write everything: who took the right away meant it.
    if not os.access(file, os.W_OK) or not file.stat().st_mode & 0o222:
        raise ArchiveError(f"{file}: is read-only; copy it, or write to another file")
    if not os.access(file.parent, os.W_OK):
        raise ArchiveError(f"{file}: the directory {file.parent} may not be written; copy the file to another one")
    return locked(file, contents.descriptor, f"process {contents.attributes.get('process', 'unknown')}", force=force)
