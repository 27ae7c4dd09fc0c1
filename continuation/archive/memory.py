"""Paths in memory as the tables of an archive: for xarray, for pandas, and for a file of their own."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Any

import numpy as np

from continuation.archive import frames, record
from continuation.archive.atomic import as_file, check_new
from continuation.archive.copies import put
from continuation.archive.provenance import root_attributes
from continuation.archive.rows import Row, parts_of, to_columns
from continuation.archive.schema import CONTROLLER_STATE, Layout
from continuation.archive.store import Store
from continuation.archive.tables import Table
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
    return frames.dataset(
        Table(layout.point_columns, len(rows_of(path)), lambda name, rows: points[name][rows]),
        Table(layout.path_columns, 1, lambda name, rows: paths[name][rows]),
        names,
        layout.unknowns,
        attributes,
    )


def dataframe_of(path: Path) -> Any:
    """The path as a `pandas.DataFrame`, with the homotopy's names where it has any, and the events' names."""
    layout, points, _, names, _ = _tables(path)
    frame = frames.dataframe(Table(layout.point_columns, len(rows_of(path)), lambda name, rows: points[name][rows]))
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
