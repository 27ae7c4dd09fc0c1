"""Finished paths as the tables of an archive: for xarray, for pandas, for a file that they are added to."""

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
from attrs import define, evolve

from continuation.archive.atomic import new_file, own
from continuation.archive.copies import Share, append, filled, share_of, sourced, write_copy
from continuation.archive.provenance import history, process, root_attributes
from continuation.archive.reader import open_archive
from continuation.archive.resume import check_homotopy
from continuation.archive.rows import layout_of, record_of, row_columns, rows_of, to_columns
from continuation.archive.store import Store, put
from continuation.archive.tables import StoredSteps, Table, dataframe, dataset
from continuation.path import Path


def share_of_path(
    path: Path, homotopy: Any = None, controller: Sequence[float] = (), member: int = 0, pieces: bool = False
) -> Share:
    """A finished path as a share; with the switches and rays of kinks if `pieces`."""
    first = path.steps[0] if path.steps else None
    tangents = first is not None and bool(np.isfinite(first.tangent).all())
    unknowns, observed = (1, ()) if first is None else (first.y.size, tuple(first.observed))
    layout = layout_of(homotopy, unknowns, observed, controller, tangents or pieces)
    layout = evolve(layout, pieces=pieces or layout.pieces)
    rows, names = rows_of(path, layout.pieces), list(dict.fromkeys(event.name for event in path.events))
    points = filled(to_columns(rows, 0, layout, names.index) if rows else {}, layout, layout.point_columns, len(rows))
    row = {**record_of(path, homotopy, tuple(controller)), "path": 0, "member": member, "n_points": len(rows)}
    paths = row_columns(row, layout)
    return Share(layout, names, paths, slice(0, len(rows)), partial(_part, points))


def _part(columns: Mapping[str, Any], name: str, rows: slice) -> Any:
    return columns[name][rows]


def attributes_of(path: Path, title: str = "") -> dict[str, Any]:
    """The root attributes of a file that begins with a path."""
    attributes = root_attributes(None, title or "A path", {})
    return {**attributes, **path.labels.attributes(), "references": "\n\n".join(path.references)}


def dataset_of(path: Path) -> Any:
    """The path as an `xarray.Dataset`."""
    share, attributes = share_of_path(path), attributes_of(path)
    share = sourced(share, attributes["identifier"], "", first=0)
    points = Table(share.layout.point_columns, share.size, share.fetch)
    paths = Table(share.layout.path_columns, 1, partial(_part, share.paths))
    return dataset(points, paths, share.names, share.layout.unknowns, attributes)


def dataframe_of(path: Path) -> Any:
    """The path as a `pandas.DataFrame`, with the homotopy's names where it has any, and the events' names."""
    share = share_of_path(path)
    frame = dataframe(Table(share.layout.point_columns, share.size, share.fetch))
    frame["event"] = [share.names[k] if k >= 0 else "" for k in share.fetch("event_index", share.points)]
    called = {f"y_{i}": name for i, name in enumerate(path.labels.names)}
    if path.labels.parameter_name:
        called["parameter"] = path.labels.parameter_name
    return frame.rename(columns=called)


def save_all(many: Sequence[Path], file: str | PathLike[str], title: str = "") -> None:
    """Write paths of one homotopy to a new archive.

    `many`: At least one; all of one number of unknowns, with the same scalars observed. Raises `ArchiveError` if it
    exists, or cannot be written.
    """
    target, attributes = new_file("file", file), attributes_of(many[0], title)
    pieces = any(event.switches for path in many for event in path.events)
    shares = [share_of_path(path, member=k, pieces=pieces) for k, path in enumerate(many)]

    def write(part: Any) -> Store:
        store = Store(part, shares[0].layout, attributes)
        for number, share in enumerate(shares):
            append(store, sourced(share, store.identifier, target.name, first=number))
        return store

    put(target, write)


@define(eq=False)
class Growing:
    """An archive of finished paths: a kill loses none that was added. As a context manager it is closed at the end.

    With `pieces` kinks are kept with their switches and rays. What of a path stays in memory is `keep`: "all" steps,
    or the "ends".
    """

    file: File
    title: str
    pieces: bool
    keep: str = "all"
    _store: Store | None = None

    def held(self, homotopy: Any) -> Iterator[tuple[Path, Path]]:
        """The paths of the file, if there is one, each whole and as it is kept; the file goes on from then on.

        It goes on as a copy that takes its place when all paths have been read, in one go.
        """
        if not self.file.exists():
            return
        target = File(os.path.realpath(self.file))
        with open_archive(target) as source:
            about = source.attributes
            with closing(own(target, source.contents.descriptor, about.get("process"))):
                if len(source):
                    last = source[-1].endpoint
                    check_homotopy(homotopy, last.u, last.residual_norm)
                for number, path in enumerate(source):
                    # A point that was read is part of an array, which would stay in memory with it.
                    yield path, path if self.keep == "all" else deepcopy(self._kept(path, number))
                attributes = {**about, **process(), **history(about, "went on")}
                copy = partial(write_copy, [share_of(source)], attributes=attributes)
                self._store = put(target, copy, replace=True, grows=True)

    def add(self, path: Path) -> Path:
        """One more path, which comes back as it is kept; the first makes the file."""
        number = 0 if self._store is None else self._store.committed.paths
        share = share_of_path(path, member=number, pieces=self.pieces)
        if self._store is None:
            attributes = attributes_of(path, self.title)
            self._store = put(self.file, partial(Store, layout=share.layout, attributes=attributes), grows=True)
        append(self._store, sourced(share, self._store.identifier, self.file.name, first=number))
        return self._kept(path, number)

    def _kept(self, path: Path, number: int) -> Path:
        if self.keep == "all":
            return path
        ends = [path.steps[0], path.steps[-1]]
        steps: Any = StoredSteps(open_archive, self.file, number, ends, len(path.steps))
        return evolve(path, steps=steps)

    def __enter__(self) -> Growing:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._store is not None:
            self._store.close()
