"""Whole blocks of rows, read from one store and appended to another: copies, merges, sweeps and resuming do only this.

A `Share` is some paths and their points, in memory or in an open file.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from copy import deepcopy
from functools import partial
from os import PathLike
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import define, evolve, frozen

from continuation.archive.atomic import ArchiveError, new_file, own
from continuation.archive.contents import Contents
from continuation.archive.provenance import history, process, root_attributes
from continuation.archive.reader import Archive, StoredSteps, open_archive
from continuation.archive.rows import (
    Block,
    Table,
    dataset,
    flat,
    joined,
    layout_of,
    record_of,
    row_columns,
    rows_of,
    to_columns,
)
from continuation.archive.schema import LATER, SCHEMA, SOURCE, Layout, text
from continuation.archive.store import Store, put
from continuation.arrays import Array
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.path import Path
from continuation.status import Status


@frozen(eq=False)
class Share:
    """Some paths and their points.

    `points`, `rows`: a point table and their rows in it. `names`: of events. `first`: first number in `path_index`.
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
        """Number of points."""
        return int(self.rows.stop - self.rows.start)

    @property
    def status(self) -> Status:
        """The first path's status."""
        return Status(int(self.paths["status"][0]))


def share_of(archive: Archive, first: int = 0, last: int | None = None, points: int | None = None) -> Share:
    """Paths `first` to `last` - 1 of an archive with their first `points` points; by default all."""
    stop, contents = len(archive) if last is None else last, archive.contents
    begin = archive.rows(first).start if stop > first else 0
    end = begin + points if points is not None else archive.rows(stop - 1).stop if stop > first else 0
    paths = {name: values.copy() for name, values in archive.paths.block(slice(first, stop)).items()}
    return Share(contents.layout, contents.event_names, paths, archive.points, slice(begin, end), first, contents)


def share_of_path(path: Path, homotopy: Any = None, controller: Sequence[float] = (), member: int = 0) -> Share:
    """A finished path."""
    first = path.steps[0] if path.steps else None
    unknowns, observed = (1, ()) if first is None else (first.y.size, tuple(first.observed))
    layout = layout_of(homotopy, unknowns, observed, controller)
    names = list(dict.fromkeys(event.name for event in path.events))
    rows = rows_of(path)
    points = to_columns(rows, 0, layout, names.index) if rows else layout.filled({}, "point", 0)
    row = {**record_of(path, homotopy, tuple(controller)), "path": 0, "member": member, "n_points": len(rows)}
    table = Table.of(layout, "point", points)
    return Share(layout, names, row_columns(row, layout), table, slice(0, len(rows)))


def leading(shares: Sequence[Share]) -> Contents:
    """The first point's archive."""
    found = next((share for share in shares if share.size), shares[0]).origin
    assert found is not None
    return found


def grow(store: Store, shares: Sequence[Share], *, file: str = "", checkpoint: bytes | None = None) -> int:
    """Append shares; returns the number of the first path. The last commit adds the paths and the checkpoint.

    New paths belong to `file` and are one commit, whole or absent after a kill; copied ones keep their source.
    """
    first = path = store.committed.paths
    points, rows, held = list[Block](), list[Block](), 0
    for share in shares:
        size = share.points.at_once
        for start in range(share.rows.start, share.rows.stop, size):
            if not file and held >= size:
                store.commit(joined(points))
                points, held = [], 0
            stop = min(start + size, share.rows.stop)
            points.append(_numbered(share, store, slice(start, stop), path))
            held += stop - start
        count = len(share.paths["path"])
        numbers = np.arange(path, path + count)
        found = {**share.paths, "path": numbers}
        if file:
            sources = [text(f"{store.identifier} {number} {file}", SOURCE.length) for number in numbers]
            found["source"] = np.array(sources, dtype=SOURCE.storage)
        rows.append(store.layout.filled(found, "path", count))
        path += count
    store.commit(joined(points) if points else None, joined(rows) if path > first else None, checkpoint)
    return first


def copy(
    shares: Sequence[Share],
    target: File,
    *,
    what: str,
    more: Mapping[str, Any] | None = None,
    checkpoint: bytes | None = None,
    compressed: bool = False,
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
    width, names = max(layout.controller for layout in layouts), LATER.union(*(layout.more for layout in layouts))
    layout = Layout(head.layout.unknowns, width, names)
    about = {**head.attributes, **history(head.attributes, what), **(more or {}), "schema": SCHEMA}

    fill = partial(grow, shares=shares, checkpoint=checkpoint)
    return put(target, layout, about, head.problem(), fill, compressed=compressed, replace=replace, grows=grows)


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


def _attributes(path: Path, title: str = "A path") -> dict[str, Any]:
    about = root_attributes(None, title, {})
    return {**about, **path.labels.attributes(), "references": "\n\n".join(path.references)}


def dataset_of(path: Path) -> Any:
    """The path as an `xarray.Dataset`."""
    attributes = _attributes(path)
    share = share_of_path(path)
    paths = Table.of(share.layout, "path", share.paths)
    return dataset(share.points, paths, share.names, share.layout.unknowns, attributes)


def dataframe_of(path: Path) -> Any:
    """The path as a `pandas.DataFrame` with names."""
    import pandas

    share = share_of_path(path)
    frame = pandas.DataFrame(flat(share.points))
    frame["event"] = [share.names[k] if k >= 0 else "" for k in share.points["event_index"]]
    called = {f"y_{i}": name for i, name in enumerate(path.labels.names)}
    if path.labels.parameter_name:
        called["parameter"] = path.labels.parameter_name
    return frame.rename(columns=called)


def save_all(many: Sequence[Path], file: str | PathLike[str], title: str = "") -> None:
    """Write paths of one homotopy to a new archive."""
    target, shares = new_file("file", file), [share_of_path(path, member=k) for k, path in enumerate(many)]

    def fill(store: Store) -> None:
        for share in shares:
            grow(store, [share], file=target.name)

    put(target, shares[0].layout, _attributes(many[0], title or "A path"), fill=fill)


def check_homotopy(homotopy: Any, u: Array, stored: float) -> None:
    """Raise `ValueError` unless the homotopy's residual norm at u is the stored one."""
    unknowns = Evaluator(homotopy, Counts()).start().size - 1
    if unknowns != u.size - 1:
        raise ValueError(f"homotopy: expected {u.size - 1} unknowns, as in the archive, found {unknowns}")
    found = float(np.abs(homotopy.residual(u[:-1].copy(), float(u[-1]))).max())
    if not found <= 100.0 * stored + 1e-12 * (1.0 + float(np.abs(u).max())):
        raise ValueError(f"homotopy: expected the archive's residual {stored:.2g} at its last point, found {found:.2g}")


@define(eq=False)
class Growing:
    """An archive that grows by finished paths, safe from kills.

    `keep`: steps of returned paths in memory, "all" or "ends".
    """

    file: File
    title: str
    keep: str = "all"
    _store: Store | None = None

    def held(self, homotopy: Any) -> Iterator[tuple[Path, Path]]:
        """Yield the paths of an existing file, whole and as kept; a growing copy then replaces the file."""
        if not self.file.exists():
            return
        target = File(os.path.realpath(self.file))
        with (
            open_archive(target) as source,
            closing(own(target, source.contents.descriptor)),
        ):
            if len(source):
                last = source[-1].endpoint
                check_homotopy(homotopy, last.u, last.residual_norm)
            for number, path in enumerate(source):
                # A view would keep the whole array.
                yield path, path if self.keep == "all" else deepcopy(self._kept(path, number))
            self._store = copy([share_of(source)], target, what="went on", more=process(), replace=True, grows=True)

    def add(self, path: Path) -> Path:
        """Append a path and return it as kept."""
        share = share_of_path(path, member=self._store.committed.paths if self._store else 0)
        self._store = self._store or put(self.file, share.layout, _attributes(path, self.title), grows=True)
        return self._kept(path, grow(self._store, [share], file=self.file.name))

    def _kept(self, path: Path, number: int) -> Path:
        if self.keep == "all":
            return path
        last = len(path.steps) - 1
        steps: Any = StoredSteps(self.file, number, {0: path.steps[0], last: path.steps[-1]}, last + 1)
        return evolve(path, steps=steps)

    def close(self) -> None:
        """Close the file."""
        if self._store is not None:
            self._store.close()
