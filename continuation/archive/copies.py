"""Copies of committed rows in a file of their own: what recovery, resuming, merging and export are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Integral
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.archive.contents import Contents
from continuation.archive.errors import ArchiveError
from continuation.archive.reader import Archive
from continuation.archive.schema import ORIGIN_COLUMNS, SCHEMA, TEXT, Layout, text
from continuation.archive.store import Store
from continuation.status import Status

_BLOCK_BYTES, _BLOCK_ROWS = 1 << 23, 4096
"""Of what is copied at once, and so of the blocks that a reader checks whole."""


@frozen(eq=False)
class Share:
    """What is copied of one archive: the rows of its paths from number `first` on, by column, and of their points.

    Of the last path it may be the first points only.
    """

    source: Contents
    paths: Mapping[str, Any]
    points: slice
    first: int = 0

    @property
    def size(self) -> int:
        """The number of points."""
        return int(self.points.stop - self.points.start)


def check_level(compression: Any) -> None:
    """Raise unless gzip knows the level."""
    if not isinstance(compression, Integral) or not 0 <= int(compression) <= 9:
        raise ValueError(f"compression: expected a level from 0 to 9, found {compression!r}")


def share_of(archive: Archive, first: int = 0, last: int | None = None, points: int | None = None) -> Share:
    """Paths of an archive from number `first` to before `last`, or all, and their points, or so many from the first on.

    Each path has its homotopy and its source: those of the file, where its row does not say.
    """
    stop, contents = len(archive) if last is None else last, archive.contents
    paths, about, count = archive.paths.block(slice(first, stop)), contents.attributes, stop - first
    # Of files without an identifier the time, the process and the name must do.
    unnamed = f"{about.get('created', '')}/{about.get('process', '')}/{contents.file.name}".replace(" ", "_")
    identifier = about.get("identifier", unnamed)
    said = {
        "homotopy": [about.get("homotopy", "")] * count,
        "source": [f"{identifier} {first + k} {contents.file.name}" for k in range(count)],
    }
    for column in ORIGIN_COLUMNS:
        own = paths.get(column.name, np.zeros(count, dtype=column.storage))
        filled = np.array([text(str(value), column.length) for value in said[column.name]], dtype=column.storage)
        paths[column.name] = np.where(own == b"", filled, own)
    begin = archive.rows(first).start if count else 0
    end = begin + points if points is not None else archive.rows(stop - 1).stop if count else 0
    return Share(contents, paths, slice(begin, end), first)


def interrupt(paths: Mapping[str, Any]) -> None:
    """A path that was being traced when its writer died counts as interrupted."""
    open_ = paths["status"] == int(Status.TRACING)
    paths["status"][open_] = int(Status.INTERRUPTED)
    paths["message"][open_] = text(f"{Status.INTERRUPTED} Its writer was killed.", TEXT)


def leading(shares: Sequence[Share]) -> Contents:
    """The archive of the first point: its settings and problem stand for all; one of failures alone has none."""
    return next((share.source for share in shares if share.size), shares[0].source)


def write_copy(
    shares: Sequence[Share],
    part: File,
    *,
    attributes: Mapping[str, Any],
    checkpoints: Mapping[int, bytes] | None = None,
    compression: int = 0,
) -> Store:
    """Concatenate shares into a new file, which is still open.

    Raises `ArchiveError` if the archives differ in the number of unknowns, or the file cannot be written.
    """
    problem = leading(shares).problem()
    store = Store(part, _joint(shares), {**attributes, "schema": SCHEMA}, problem, compression=compression)
    try:
        points = paths = 0
        for share in shares:
            points, paths = _copy(share, store, points, paths)
        store.commit(checkpoints=checkpoints)
    except BaseException:
        store.close()
        raise
    return store


def _joint(shares: Sequence[Share]) -> Layout:
    """One layout that holds them all: a column that only some have is missing elsewhere."""
    head = leading(shares)
    first, layouts = head.layout, [share.source.layout for share in shares]
    for share, layout in zip(shares, layouts):
        if layout.unknowns != first.unknowns and share.size:
            raise ArchiveError(
                f"{share.source.file}: holds paths of {layout.unknowns} unknowns, {head.file} of "
                f"{first.unknowns}; one file holds one number"
            )
    return evolve(
        first,
        controller=max(layout.controller for layout in layouts),
        observed=tuple(sorted({name for layout in layouts for name in layout.observed})),
        scalars=tuple(sorted({name for layout in layouts for name in layout.scalars})),
        tangents=any(layout.tangents for layout in layouts),
        pieces=any(layout.pieces for layout in layouts),
        origins=any(layout.origins for layout in layouts) or len(layouts) > 1,
    )


def _copy(share: Share, store: Store, point: int, path: int) -> tuple[int, int]:
    """Append a share; the numbers of points and paths then."""
    source, layout, rows = share.source, store.layout, share.points
    numbers = np.array([store.name_event(name) for name in source.event_names] + [-1], dtype="i2")
    size = min(max(_BLOCK_BYTES // (8 * (layout.unknowns + 16)), 1), _BLOCK_ROWS)
    for start in range(rows.start, rows.stop, size):
        part = slice(start, min(start + size, rows.stop))
        block = {column.name: source.read("point", column.name, part) for column in source.layout.point_columns}
        block["path_index"] = (block["path_index"] + (path - share.first)).astype("i4")
        if np.any(block["event_index"] >= len(source.event_names)) or np.any(block["event_index"] < -1):
            raise source.damaged(ValueError("its points refer to events that it does not name"))
        # The number -1, no event, finds the last entry.
        block["event_index"] = numbers[block["event_index"]]
        store.commit(_filled(block, layout, layout.point_columns, part.stop - start), point)
        point += part.stop - start
    count = len(share.paths["path"])
    if count:
        columns = {**share.paths, "path": np.arange(path, path + count)}
        store.commit(paths=_filled(columns, layout, layout.path_columns, count), path=path)
    return point, path + count


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
