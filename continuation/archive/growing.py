"""Finished paths as the tables of an archive: for xarray, for pandas, for a file that they are added to."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import closing
from copy import deepcopy
from os import PathLike
from pathlib import Path as File
from types import TracebackType
from typing import Any

import numpy as np
from attrs import define, evolve

from continuation.archive import record
from continuation.archive.atomic import as_file, beside, check_new
from continuation.archive.copies import share_of, write_copy
from continuation.archive.provenance import history, process, root_attributes
from continuation.archive.reader import open_archive
from continuation.archive.recover import own
from continuation.archive.resume import check_homotopy
from continuation.archive.rows import Row, parts_of, to_columns
from continuation.archive.schema import CONTROLLER_STATE, Layout
from continuation.archive.store import Store, create, put
from continuation.archive.stored import StoredSteps
from continuation.archive.tables import Table, dataframe, dataset
from continuation.path import LocatedEvent, Path


def rows_of(path: Path, pieces: bool = False) -> list[Row]:
    """Steps and located events in the order of the path; with the switches and the rays of its kinks if `pieces`."""
    waiting: list[LocatedEvent] = list(path.events)
    rows = []
    for step in path.steps:
        last = None
        while waiting and waiting[0].step <= step.index:
            event = waiting.pop(0)
            if event.ends_step and event.kind == step.kind:
                last = event
            else:
                rows.append(Row(None, event))
        rows += [Row(step, last), *(parts_of(last) if pieces else ())]
    return rows


def layout_of(path: Path, title: str, pieces: bool = False) -> tuple[Layout, dict[str, Any]]:
    """What a file has columns for that begins with a path, and its attributes; with those of kinks if `pieces`."""
    observed = tuple(path.steps[0].observed) if path.steps else ()
    tangents = bool(path.steps) and bool(np.isfinite(path.steps[0].tangent).all())
    unknowns = path.steps[0].y.size if path.steps else 1
    layout = Layout(unknowns, CONTROLLER_STATE, observed, (), tangents or pieces, pieces)
    attributes = root_attributes(None, title or "A path", {})
    return layout, attributes | {**path.labels.attributes(), "references": "\n\n".join(path.references)}


def _tables(path: Path) -> tuple[Layout, dict[str, Any], dict[str, Any], list[str], dict[str, Any]]:
    rows, names = rows_of(path), list(dict.fromkeys(event.name for event in path.events))
    layout, attributes = layout_of(path, "")
    row = {**record.of_path(path, None, ()), "path": 0, "member": 0, "n_points": len(rows)}
    row["source"] = f"{attributes['identifier']} 0"
    points = to_columns(rows, 0, layout, names.index) if rows else {}
    return layout, points, record.to_columns(row, layout), names, attributes


def dataset_of(path: Path) -> Any:
    """The path as an `xarray.Dataset`."""
    layout, points, paths, names, attributes = _tables(path)
    return dataset(
        Table(layout.point_columns, len(rows_of(path)), lambda name, rows: points[name][rows]),
        Table(layout.path_columns, 1, lambda name, rows: paths[name][rows]),
        names,
        layout.unknowns,
        attributes,
    )


def dataframe_of(path: Path) -> Any:
    """The path as a `pandas.DataFrame`, with the homotopy's names where it has any, and the events' names."""
    layout, points, _, names, _ = _tables(path)
    frame = dataframe(Table(layout.point_columns, len(rows_of(path)), lambda name, rows: points[name][rows]))
    frame["event"] = [names[k] if k >= 0 else "" for k in points.get("event_index", ())]
    called = {f"y_{i}": name for i, name in enumerate(path.labels.names)}
    if path.labels.parameter_name:
        called["parameter"] = path.labels.parameter_name
    return frame.rename(columns=called)


def save(path: Path, file: str | PathLike[str], title: str = "") -> None:
    """Write a path to a new archive.

    Raises `ArchiveError` if it exists, or cannot be written.
    """
    save_all([path], file, title)


def save_all(many: Sequence[Path], file: str | PathLike[str], title: str = "") -> None:
    """Write paths of one homotopy to a new archive.

    `many`: At least one; all of one number of unknowns, with the same scalars observed. Raises `ArchiveError` if it
    exists, or cannot be written.
    """
    target = as_file("file", file)
    check_new(target)
    layout, attributes = layout_of(many[0], title, any(event.switches for path in many for event in path.events))

    def write(part: Any) -> Store:
        store = Store(part, layout, attributes)
        for path in many:
            append(store, path, f"{attributes['identifier']} {store.committed.paths} {target.name}")
        return store

    put(target, write)


def append(store: Store, path: Path, source: str) -> Any:
    """Write a path behind those that a file holds, in one commit; the roles of its rows.

    `source` is where it was written first.
    """
    held, rows = store.committed, rows_of(path, store.layout.pieces)
    row = {**record.of_path(path, None, ()), "path": held.paths, "member": held.paths, "n_points": len(rows)}
    points = to_columns(rows, held.paths, store.layout, store.name_event) if rows else {}
    store.commit(points, held.points, record.to_columns({**row, "source": source}, store.layout), held.paths)
    return points.get("role", ())


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
    _identifier: str = ""

    def held(self, homotopy: Any) -> Iterator[tuple[Path, Path]]:
        """The paths of the file, if there is one, each whole and as it is kept; the file goes on from then on.

        It goes on as a copy that takes its place when all paths have been read, in one go.
        """
        if not self.file.exists():
            return
        target = File(os.path.realpath(self.file))
        with open_archive(target) as source, closing(own(source.contents, target)), beside(target) as part:
            if len(source):
                last = source[-1].endpoint
                check_homotopy(homotopy, last.u, last.residual_norm)
            for number, path in enumerate(source):
                # A point that was read is part of an array, which would stay in memory with it.
                ends = path if self.keep == "all" else deepcopy(evolve(path, steps=[path.steps[0], path.steps[-1]]))
                yield path, self._kept(ends, number, source.points.some("role", source.rows(number)))
            attributes = {**source.attributes, **process(), **history(source.attributes, "went on")}
            store = write_copy([share_of(source)], part, attributes=attributes)
            store.publish(target, replace=True)
            self._store, self._identifier = store, attributes["identifier"]

    def add(self, path: Path) -> Path:
        """One more path, which comes back as it is kept; the first makes the file."""
        if self._store is None:
            layout, attributes = layout_of(path, self.title, self.pieces)
            self._store, self._identifier = create(self.file, layout, attributes), attributes["identifier"]
        number = self._store.committed.paths
        roles = append(self._store, path, f"{self._identifier} {number} {self.file.name}")
        return self._kept(path, number, roles)

    def _kept(self, path: Path, number: int, roles: Any) -> Path:
        if self.keep == "all":
            return path
        steps: Any = StoredSteps(open_archive, self.file, number, 0)
        steps.known(roles, (path.steps[0], path.steps[-1]))
        return evolve(path, steps=steps)

    def __enter__(self) -> Growing:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._store is not None:
            self._store.close()
