"""Whole blocks of rows, read here and appended there: all that copies, merges, sweeps, saves or goes on does this.

A `Share` is some paths and their points, in memory or in an open file. A store grows by shares.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from copy import deepcopy
from functools import partial
from os import PathLike
from pathlib import Path as File
from types import TracebackType
from typing import Any

import numpy as np
from attrs import define, evolve, frozen

from continuation.archive.atomic import ArchiveError, new_file, own
from continuation.archive.contents import Contents
from continuation.archive.provenance import history, process, root_attributes
from continuation.archive.reader import Archive, StoredSteps, open_archive
from continuation.archive.rows import layout_of, record_of, row_columns, rows_of, to_columns
from continuation.archive.schema import ORIGIN_COLUMNS, ORIGINS, SCHEMA, Layout, text
from continuation.archive.store import Store, put
from continuation.archive.tables import Block, Table, dataframe, dataset, joined
from continuation.arrays import Array
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
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
    end = begin + points if points is not None else archive.rows(stop - 1).stop if stop > first else 0
    paths = {name: values.copy() for name, values in archive.paths.block(slice(first, stop)).items()}
    share = Share(contents.layout, contents.event_names, paths, archive.points, slice(begin, end), first, contents)
    return sourced(share, about.get("identifier", ""), contents.file.name, about.get("homotopy", ""))


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
    points = to_columns(rows, 0, layout, names.index) if rows else layout.filled({}, "point", 0)
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
        here = np.array([text(value, column.length) for value in said[column.name]], dtype=column.storage)
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


def copy(
    shares: Sequence[Share],
    target: File,
    *,
    what: str,
    more: Mapping[str, Any] | None = None,
    checkpoints: Mapping[int, bytes] | None = None,
    compression: int = 0,
    replace: bool = False,
    grows: bool = False,
) -> Store:
    """Concatenate shares into a new file, which `grows` leaves open.

    It keeps the attributes of the first point's archive; `what` extends the history.
    """
    head, layouts = leading(shares), [share.layout for share in shares]
    for share in shares:
        if share.layout.unknowns != head.layout.unknowns and share.size and share.origin is not None:
            raise ArchiveError(
                f"{share.origin.file}: holds paths of {share.layout.unknowns} unknowns, {head.file} of "
                f"{head.layout.unknowns}; one file holds one number"
            )
    width, names = max(layout.controller for layout in layouts), ORIGINS.union(*(layout.more for layout in layouts))
    layout = Layout(head.layout.unknowns, width, names)
    about = {**head.attributes, **history(head.attributes, what), **(more or {}), "schema": SCHEMA}

    def fill(store: Store) -> None:
        for block in _blocks(shares, store):
            store.commit(block)
        counts = np.cumsum([0, *(len(share.paths["path"]) for share in shares)]).tolist()
        rows = [_rows(share, store, number) for share, number in zip(shares, counts)]
        store.commit(paths=joined(rows) if counts[-1] else None, checkpoints=checkpoints)

    make = partial(Store, layout=layout, attributes=about, problem=head.problem(), compression=compression)
    return put(target, make, fill, replace=replace, grows=grows)


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
    return store.layout.filled(block, "point", rows.stop - rows.start)


def _rows(share: Share, store: Store, path: int) -> Block:
    count = len(share.paths["path"])
    return store.layout.filled({**share.paths, "path": np.arange(path, path + count)}, "path", count)


def _attributes(path: Path, title: str = "A path") -> dict[str, Any]:
    about = root_attributes(None, title, {})
    return {**about, **path.labels.attributes(), "references": "\n\n".join(path.references)}


def dataset_of(path: Path) -> Any:
    """The path as an `xarray.Dataset`."""
    attributes = _attributes(path)
    share = sourced(share_of_path(path), attributes["identifier"], "")
    paths = Table.of(share.layout, "path", share.paths)
    return dataset(share.points, paths, share.names, share.layout.unknowns, attributes)


def dataframe_of(path: Path) -> Any:
    """The path as a `pandas.DataFrame` with names."""
    share = share_of_path(path)
    frame = dataframe(share.points)
    frame["event"] = [share.names[k] if k >= 0 else "" for k in share.points["event_index"]]
    called = {f"y_{i}": name for i, name in enumerate(path.labels.names)}
    if path.labels.parameter_name:
        called["parameter"] = path.labels.parameter_name
    return frame.rename(columns=called)


def save_all(many: Sequence[Path], file: str | PathLike[str], title: str = "") -> None:
    """Write paths of one homotopy to a new archive."""
    target = new_file("file", file)
    pieces = any(event.switches for path in many for event in path.events)
    shares = [share_of_path(path, member=k, pieces=pieces) for k, path in enumerate(many)]

    def fill(store: Store) -> None:
        for share in shares:
            append(store, share, target.name)

    put(target, partial(Store, layout=shares[0].layout, attributes=_attributes(many[0], title or "A path")), fill)


def check_homotopy(homotopy: Any, u: Array, stored: float) -> None:
    """Raise `ValueError` unless the homotopy's largest residual at u is the stored one."""
    unknowns = Evaluator(homotopy, Counts()).start().size - 1
    if unknowns != u.size - 1:
        raise ValueError(f"homotopy: expected {u.size - 1} unknowns, as in the archive, found {unknowns}")
    found = float(np.abs(homotopy.residual(u[:-1].copy(), float(u[-1]))).max())
    if not found <= 100.0 * stored + 1e-12 * (1.0 + float(np.abs(u).max())):
        raise ValueError(f"homotopy: expected the archive's residual {stored:.2g} at its last point, found {found:.2g}")


@define(eq=False)
class Growing:
    """An archive of finished paths, safe from kills.

    `pieces`: store switches and rays of kinks. `keep`: steps in memory, "all" or "ends".
    """

    file: File
    title: str
    pieces: bool
    keep: str = "all"
    _store: Store | None = None

    def held(self, homotopy: Any) -> Iterator[tuple[Path, Path]]:
        """The paths of an existing file, whole and as kept; a growing copy then replaces it."""
        if not self.file.exists():
            return
        target = File(os.path.realpath(self.file))
        with (
            open_archive(target) as source,
            closing(own(target, source.contents.descriptor, source.attributes.get("process"))),
        ):
            if len(source):
                last = source[-1].endpoint
                check_homotopy(homotopy, last.u, last.residual_norm)
            for number, path in enumerate(source):
                # A view would keep the whole array in memory.
                yield path, path if self.keep == "all" else deepcopy(self._kept(path, number))
            self._store = copy([share_of(source)], target, what="went on", more=process(), replace=True, grows=True)

    def add(self, path: Path) -> Path:
        """Append a path and return it as kept."""
        share = share_of_path(path, member=self._store.committed.paths if self._store else 0, pieces=self.pieces)
        if self._store is None:
            about = _attributes(path, self.title)
            self._store = put(self.file, partial(Store, layout=share.layout, attributes=about), grows=True)
        return self._kept(path, append(self._store, share, self.file.name))

    def _kept(self, path: Path, number: int) -> Path:
        if self.keep == "all":
            return path
        steps: Any = StoredSteps(self.file, number, [path.steps[0], path.steps[-1]], len(path.steps))
        return evolve(path, steps=steps)

    def __enter__(self) -> Growing:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._store is not None:
            self._store.close()
