"""Paths as columns (`Share`), appended to a growing file or copied to a new one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.archive.atomic import ArchiveError
from continuation.archive.contents import Contents
from continuation.archive.provenance import history
from continuation.archive.reader import Archive
from continuation.archive.rows import layout_of, record_of, row_columns, rows_of, to_columns
from continuation.archive.schema import ORIGIN_COLUMNS, ORIGINS, SCHEMA, Layout, text
from continuation.archive.store import Store
from continuation.archive.tables import Block, Table, joined
from continuation.path import Path


@frozen(eq=False)
class Share:
    """Some paths and their points.

    `points`, `rows`: a point table and their rows in it. `names`: event names. `first`: first number in `path_index`.
    `origin`: the open file.
    """

    layout: Layout
    names: Sequence[str]
    paths: Block
    points: Table
    rows: slice
    first: int = 0
    origin: Contents | None = None

    @property
    def size(self) -> int:
        """The number of points."""
        return int(self.rows.stop - self.rows.start)


def share_of(archive: Archive, first: int = 0, last: int | None = None, points: int | None = None) -> Share:
    """Paths `first` to `last` - 1 of an archive with their first `points` points; by default all."""
    stop, contents = len(archive) if last is None else last, archive.contents
    about, begin = contents.attributes, archive.rows(first).start if stop > first else 0
    # Time, process and name replace a missing identifier.
    unnamed = f"{about.get('created', '')}/{about.get('process', '')}/{contents.file.name}".replace(" ", "_")
    end = begin + points if points is not None else archive.rows(stop - 1).stop if stop > first else 0
    paths = {name: values.copy() for name, values in archive.paths.block(slice(first, stop)).items()}
    share = Share(contents.layout, contents.event_names, paths, archive.points, slice(begin, end), first, contents)
    return sourced(share, about.get("identifier", unnamed), contents.file.name, about.get("homotopy", ""))


def share_of_path(
    path: Path, homotopy: Any = None, controller: Sequence[float] = (), member: int = 0, pieces: bool = False
) -> Share:
    """A finished path; `pieces` adds switches and rays."""
    first = path.steps[0] if path.steps else None
    tangents = first is not None and bool(np.isfinite(first.tangent).all())
    unknowns, observed = (1, ()) if first is None else (first.y.size, tuple(first.observed))
    layout = layout_of(homotopy, unknowns, observed, controller, tangents, pieces)
    names = list(dict.fromkeys(event.name for event in path.events))
    rows = rows_of(path, layout)
    points = to_columns(rows, 0, layout, names.index) if rows else filled({}, layout, "point", 0)
    row = {**record_of(path, homotopy, tuple(controller)), "path": 0, "member": member, "n_points": len(rows)}
    table = Table.of(layout, "point", points)
    return Share(layout, names, row_columns(row, layout), table, slice(0, len(rows)))


def sourced(share: Share, identifier: str, file: str, homotopy: str = "", first: int | None = None) -> Share:
    """The share with missing homotopies and sources."""
    count, begin = len(share.paths["path"]), share.first if first is None else first
    said = {"homotopy": [homotopy] * count, "source": [f"{identifier} {begin + k} {file}" for k in range(count)]}
    paths = dict(share.paths)
    for column in ORIGIN_COLUMNS:
        own = paths.get(column.name, np.zeros(count, dtype=column.storage))
        here = np.array([text(value.strip(), column.length) for value in said[column.name]], dtype=column.storage)
        paths[column.name] = np.where(own == b"", here, own)
    return evolve(share, paths=paths)


def leading(shares: Sequence[Share]) -> Contents:
    """The archive of the first point."""
    found = next((share for share in shares if share.size), shares[0]).origin
    assert found is not None
    return found


def append(store: Store, share: Share, file: str) -> int:
    """Append a finished path of `file` in one commit; returns its number."""
    number = store.committed.paths
    own = sourced(share, store.identifier, file, first=number)
    store.commit(_numbered(own, store, own.rows, number) if own.size else None, _rows(own, store, number))
    return number


def write_copy(
    shares: Sequence[Share],
    file: File,
    *,
    what: str,
    more: Mapping[str, Any] | None = None,
    checkpoints: Mapping[int, bytes] | None = None,
    compression: int = 0,
) -> Store:
    """Concatenate shares into a new file, which stays open.

    It keeps the attributes of the first point's archive; `what` extends the history.
    """
    head = leading(shares)
    for share in shares:
        if share.layout.unknowns != head.layout.unknowns and share.size and share.origin is not None:
            raise ArchiveError(
                f"{share.origin.file}: holds paths of {share.layout.unknowns} unknowns, {head.file} of "
                f"{head.layout.unknowns}; one file holds one number"
            )
    layouts = [share.layout for share in shares]
    width, names = max(layout.controller for layout in layouts), ORIGINS.union(*(layout.more for layout in layouts))
    about = {**head.attributes, **history(head.attributes, what), **(more or {}), "schema": SCHEMA}
    store = Store(file, Layout(head.layout.unknowns, width, names), about, head.problem(), compression=compression)
    try:
        for block in _blocks(shares, store):
            store.commit(block)
        counts = np.cumsum([0, *(len(share.paths["path"]) for share in shares)]).tolist()
        rows = [_rows(share, store, number) for share, number in zip(shares, counts)]
        store.commit(paths=joined(rows) if counts[-1] else None, checkpoints=checkpoints)
    except BaseException:
        store.close()
        raise
    return store


def _blocks(shares: Sequence[Share], store: Store) -> Iterator[Block]:
    waiting: list[Block] = []
    held = path = 0
    for share in shares:
        size = share.points.at_once
        for start in range(share.rows.start, share.rows.stop, size):
            rows = slice(start, min(start + size, share.rows.stop))
            waiting.append(_numbered(share, store, rows, path))
            held += rows.stop - rows.start
            if held >= size:
                yield joined(waiting)
                waiting, held = [], 0
        path += len(share.paths["path"])
    if waiting:
        yield joined(waiting)


def _numbered(share: Share, store: Store, rows: slice, path: int) -> Block:
    numbers = np.array([store.name_event(name) for name in share.names] + [-1], dtype="i2")
    block = share.points.block(rows)
    block["path_index"] = (block["path_index"] + (path - share.first)).astype("i4")
    events = block["event_index"]
    if share.origin and (np.any(events >= len(share.names)) or np.any(events < -1)):
        raise share.origin.damaged(ValueError("its points refer to events that it does not name"))
    # Index -1 (no event) selects the last entry, -1.
    block["event_index"] = numbers[events]
    return filled(block, store.layout, "point", rows.stop - rows.start)


def _rows(share: Share, store: Store, path: int) -> Block:
    count = len(share.paths["path"])
    return filled({**share.paths, "path": np.arange(path, path + count)}, store.layout, "path", count)


def filled(block: Mapping[str, Any], layout: Layout, table: str, rows: int) -> Block:
    """All columns of the layout; missing ones are filled."""
    whole = {}
    for column in layout.columns(table):
        values, shape = block.get(column.name), (rows, *layout.width(column))
        if values is None or values.shape != shape:
            missing = np.full(shape, column.missing, dtype=column.storage)
            if values is not None:
                missing[:, : values.shape[1]] = values
            values = missing
        whole[column.name] = np.ascontiguousarray(values)
    return whole
