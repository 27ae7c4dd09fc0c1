"""Paths as columns, read from a file or held in memory, and appended elsewhere.

A `Share` is some paths with their points; `append` adds one to a file that grows, `write_copy` makes a new file of
several. Recovery, resuming, merging, export, diagrams and the parts of a sweep are shares and one of the two.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.archive.atomic import ArchiveError
from continuation.archive.contents import Contents
from continuation.archive.reader import Archive
from continuation.archive.schema import ORIGIN_COLUMNS, SCHEMA, Column, Layout, text
from continuation.archive.store import Store
from continuation.archive.tables import ROWS_AT_ONCE

Block = dict[str, Any]

_BLOCK_BYTES = 1 << 23
"""Of what is copied at once, and so of the blocks that a reader checks whole."""


@frozen(eq=False)
class Share:
    """Some paths and their points.

    `paths`: Rows of the path table, by column. `points`: Which rows of the point table; of the last path it may be the
    first ones only. `fetch`: (column, rows) -> numbers. `names`: What `event_index` counts. `first`: The number that
    the first path has in `path_index`. `origin`: The open file, where it is of one.
    """

    layout: Layout
    names: Sequence[str]
    paths: Mapping[str, Any]
    points: slice
    fetch: Callable[[str, slice], Any]
    first: int = 0
    origin: Contents | None = None

    @classmethod
    def of(cls, contents: Contents, paths: Mapping[str, Any], points: slice, first: int = 0) -> Share:
        """A share of an open file."""
        return cls(
            contents.layout, contents.event_names, paths, points, partial(contents.read, "point"), first, contents
        )

    @property
    def size(self) -> int:
        """The number of points."""
        return int(self.points.stop - self.points.start)


def share_of(archive: Archive, first: int = 0, last: int | None = None, points: int | None = None) -> Share:
    """Paths of an archive from number `first` to before `last`, or all, and their points, or so many from the first on.

    Each path has its homotopy and its source: those of the file, where its row does not say.
    """
    stop, contents = len(archive) if last is None else last, archive.contents
    about, begin = contents.attributes, archive.rows(first).start if stop > first else 0
    # Of files without an identifier the time, the process and the name must do.
    unnamed = f"{about.get('created', '')}/{about.get('process', '')}/{contents.file.name}".replace(" ", "_")
    end = begin + points if points is not None else archive.rows(stop - 1).stop if stop > first else 0
    share = Share.of(contents, archive.paths.block(slice(first, stop)), slice(begin, end), first)
    return sourced(share, about.get("identifier", unnamed), contents.file.name, about.get("homotopy", ""))


def sourced(share: Share, identifier: str, file: str, homotopy: str = "", first: int | None = None) -> Share:
    """The share, of which each path says what it is of, and in which file it was first, where it does not say so yet.

    `first`: The number of the first path there.
    """
    count, begin = len(share.paths["path"]), share.first if first is None else first
    said = {"homotopy": [homotopy] * count, "source": [f"{identifier} {begin + k} {file}" for k in range(count)]}
    paths = dict(share.paths)
    for column in ORIGIN_COLUMNS:
        own = paths.get(column.name, np.zeros(count, dtype=column.storage))
        here = np.array([text(value.strip(), column.length) for value in said[column.name]], dtype=column.storage)
        paths[column.name] = np.where(own == b"", here, own)
    return evolve(share, paths=paths)


def leading(shares: Sequence[Share]) -> Contents:
    """The archive of the first point: its settings and problem stand for all; one of failures alone has none."""
    found = next((share for share in shares if share.size), shares[0]).origin
    assert found is not None
    return found


def append(store: Store, share: Share) -> None:
    """Add a share that is in memory to a file, in one commit."""
    number = store.committed.paths
    points = _numbered(share, store, share.points, number) if share.size else None
    store.commit(points, _rows(share, store.layout, number))


def write_copy(
    shares: Sequence[Share],
    part: File,
    *,
    attributes: Mapping[str, Any],
    checkpoints: Mapping[int, bytes] | None = None,
    compression: int = 0,
) -> Store:
    """Concatenate shares of open files into a new one, which is still open.

    Raises `ArchiveError` if the archives differ in the number of unknowns, or the file cannot be written.
    """
    layout = _joint(shares)
    store = Store(part, layout, {**attributes, "schema": SCHEMA}, leading(shares).problem(), compression=compression)
    try:
        for block in _blocks(shares, store):
            store.commit(block)
        counts = np.cumsum([0, *(len(share.paths["path"]) for share in shares)]).tolist()
        rows = [_rows(share, layout, number) for share, number in zip(shares, counts)]
        store.commit(paths=_joined(rows) if counts[-1] else None, checkpoints=checkpoints)
    except BaseException:
        store.close()
        raise
    return store


def _joint(shares: Sequence[Share]) -> Layout:
    """One layout that holds them all: a column that only some have is missing elsewhere."""
    head = leading(shares)
    first, layouts = head.layout, [share.layout for share in shares]
    for share in shares:
        if share.layout.unknowns != first.unknowns and share.size and share.origin is not None:
            raise ArchiveError(
                f"{share.origin.file}: holds paths of {share.layout.unknowns} unknowns, {head.file} of "
                f"{first.unknowns}; one file holds one number"
            )
    joint: dict[str, Any] = {
        name: max(getattr(layout, name) for layout in layouts) for name in ("controller", "tangents", "pieces")
    }
    for name in ("observed", "scalars"):
        joint[name] = tuple(sorted({own for layout in layouts for own in getattr(layout, name)}))
    return evolve(first, origins=any(layout.origins for layout in layouts) or len(layouts) > 1, **joint)


def _blocks(shares: Sequence[Share], store: Store) -> Iterator[Block]:
    """The points of all of them, in blocks of nearly one size: what is small is joined, what is large cut."""
    size = min(max(_BLOCK_BYTES // (8 * (store.layout.unknowns + 16)), 1), ROWS_AT_ONCE)
    waiting: list[Block] = []
    held = path = 0
    for share in shares:
        for start in range(share.points.start, share.points.stop, size):
            part = slice(start, min(start + size, share.points.stop))
            waiting.append(_numbered(share, store, part, path))
            held += part.stop - part.start
            if held >= size:
                yield _joined(waiting)
                waiting, held = [], 0
        path += len(share.paths["path"])
    if waiting:
        yield _joined(waiting)


def _joined(blocks: Sequence[Block]) -> Block:
    return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}


def _numbered(share: Share, store: Store, rows: slice, path: int) -> Block:
    """Points as a block of the store's columns, with its numbers of events, the share's first path being `path`."""
    numbers = np.array([store.name_event(name) for name in share.names] + [-1], dtype="i2")
    block = {column.name: share.fetch(column.name, rows) for column in share.layout.point_columns}
    block["path_index"] = (block["path_index"] + (path - share.first)).astype("i4")
    if share.origin and (np.any(block["event_index"] >= len(share.names)) or np.any(block["event_index"] < -1)):
        raise share.origin.damaged(ValueError("its points refer to events that it does not name"))
    # The number -1, no event, finds the last entry.
    block["event_index"] = numbers[block["event_index"]]
    return filled(block, store.layout, store.layout.point_columns, rows.stop - rows.start)


def _rows(share: Share, layout: Layout, path: int) -> Block:
    """The share's rows of the path table, numbered from `path` on."""
    count = len(share.paths["path"])
    columns = {**share.paths, "path": np.arange(path, path + count)}
    return filled(columns, layout, layout.path_columns, count)


def filled(block: Mapping[str, Any], layout: Layout, columns: Sequence[Column], rows: int) -> Block:
    """The block in the columns of the layout; what it lacks is missing (NaN)."""
    whole = {}
    for column in columns:
        values, shape = block.get(column.name), (rows, *layout.width(column))
        if values is None or values.shape != shape:
            missing = np.full(shape, column.missing, dtype=column.storage)
            if values is not None:
                missing[:, : values.shape[1]] = values
            values = missing
        whole[column.name] = np.ascontiguousarray(values)
    return whole
