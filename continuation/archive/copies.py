"""Copies of committed rows in a file of their own: what recovery, resuming, merging and export are made of."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.archive.errors import ArchiveError
from continuation.archive.reader import Archive
from continuation.archive.schema import Layout
from continuation.archive.store import Store

_BLOCK_BYTES = 1 << 23


@frozen(eq=False)
class Share:
    """What is copied of one archive: its first paths, and how many rows of the last of them.

    `amend` changes the path rows on the way.
    """

    archive: Archive
    paths: int
    points: int
    amend: Callable[[dict[str, Any]], dict[str, Any]] = lambda block: block


def everything(archive: Archive) -> Share:
    """All that was committed."""
    return Share(archive, len(archive), archive.points.size)


def leading(archives: Sequence[Archive]) -> Archive:
    """The first archive with a point in it: its settings and problem stand for all; one of failures alone has none."""
    return next((archive for archive in archives if archive.points.size), archives[0])


def write_copy(
    shares: Sequence[Share],
    target: File,
    *,
    attributes: Mapping[str, Any],
    checkpoints: Mapping[int, bytes] | None = None,
    compression: int = 0,
) -> Store:
    """Concatenate shares into a new file, on the disk when this returns, and open to be written to.

    Raises
    ------
    ArchiveError
        If the archives differ in the number of unknowns, or the file cannot be written.
    """
    layout = _joint([share.archive for share in shares])
    problem = leading([share.archive for share in shares]).problem()
    store = Store(target, layout, attributes, problem, compression=compression, swmr=False)
    try:
        points = paths = 0
        for share in shares:
            _copy(share, store, points, paths)
            points, paths = points + share.points, paths + share.paths
        store.commit(checkpoints=checkpoints)
        store.sync()
    except BaseException:
        store.close()
        raise
    return store


def _joint(archives: Sequence[Archive]) -> Layout:
    """One layout that holds them all: a column that only some have is missing elsewhere."""
    head = leading(archives)
    first = head.layout
    for archive in archives:
        if archive.layout.unknowns != first.unknowns and archive.points.size:
            raise ArchiveError(
                f"{archive.file}: holds paths of {archive.layout.unknowns} unknowns, {head.file} of "
                f"{first.unknowns}; one file holds one number"
            )
    layouts = [archive.layout for archive in archives]
    return evolve(
        first,
        controller=max(layout.controller for layout in layouts),
        observed=tuple(sorted({name for layout in layouts for name in layout.observed})),
        scalars=tuple(sorted({name for layout in layouts for name in layout.scalars})),
        tangents=any(layout.tangents for layout in layouts),
    )


def _copy(share: Share, store: Store, point: int, path: int) -> None:
    archive, layout = share.archive, store.layout
    numbers = np.array([store.name_event(name) for name in archive.event_names] + [-1], dtype="i2")
    size = max(_BLOCK_BYTES // (8 * (layout.unknowns + 16)), 1)
    for start in range(0, share.points, size):
        stop = min(start + size, share.points)
        block = archive.points.block(slice(start, stop))
        block["path_index"] = (block["path_index"] + path).astype("i4")
        # The number -1, no event, finds the last entry.
        block["event_index"] = numbers[block["event_index"]]
        store.commit(_filled(block, layout, layout.point_columns, stop - start), point + start)
    if share.paths:
        block = share.amend(archive.paths.block(slice(0, share.paths)))
        block["path"] = block["path"] + path
        store.commit(paths=_filled(block, layout, layout.path_columns, share.paths), path=path)


def _filled(block: Mapping[str, Any], layout: Layout, columns: Sequence[Any], rows: int) -> dict[str, Any]:
    """The block in the columns of the layout; what it lacks is missing (NaN)."""
    filled = {}
    for column in columns:
        whole = np.full((rows, *layout.width(column)), column.missing, dtype=column.storage)
        values = block.get(column.name)
        if values is not None and values.shape == whole.shape:
            whole = np.ascontiguousarray(values)
        elif values is not None:
            whole[:, : values.shape[1]] = values
        filled[column.name] = whole
    return filled


def put(target: File, write: Callable[[File], Store]) -> Store:
    """Write a whole new file beside `target`, then give it that name in one step: a kill leaves the one or the other.

    The file is still open, and may go on to grow.
    """
    part = target.with_name(target.name + ".part")
    # What a killed attempt left behind was never anything but a copy.
    part.unlink(missing_ok=True)
    try:
        store = write(part)
        os.replace(part, target)
    finally:
        part.unlink(missing_ok=True)
    store.file = target
    return store
