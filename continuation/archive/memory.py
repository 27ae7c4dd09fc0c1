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
from continuation.archive.rows import Row, to_columns
from continuation.archive.schema import CONTROLLER_STATE, Layout
from continuation.archive.store import Store
from continuation.archive.tables import Table
from continuation.path import LocatedEvent, Path


def rows_of(path: Path) -> list[Row]:
    """Steps and located events in the order of the path.

    Parameters
    ----------
    path : Path
    """
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
        rows.append(Row(step, last))
    return rows


def _tables(path: Path, title: str) -> tuple[Layout, dict[str, Any], dict[str, Any], list[str], dict[str, Any]]:
    rows, names = rows_of(path), list(dict.fromkeys(event.name for event in path.events))
    observed = tuple(path.steps[0].observed) if path.steps else ()
    tangents = bool(path.steps) and bool(np.isfinite(path.steps[0].tangent).all())
    unknowns = path.steps[0].y.size if path.steps else 1
    layout = Layout(unknowns, CONTROLLER_STATE, observed, (), tangents)
    attributes = root_attributes(None, title or "A path", {})
    attributes |= {**path.labels.attributes(), "references": "\n\n".join(path.references)}
    row = {**record.of_path(path, None, ()), "path": 0, "member": 0, "n_points": len(rows)}
    row["source"] = f"{attributes['identifier']} 0"
    points = to_columns(rows, 0, layout, names.index) if rows else {}
    return layout, points, record.to_columns(row, layout), names, attributes


def dataset_of(path: Path) -> Any:
    """The path as an `xarray.Dataset`.

    Parameters
    ----------
    path : Path
    """
    layout, points, paths, names, attributes = _tables(path, "")
    return frames.dataset(
        Table(layout.point_columns, len(rows_of(path)), lambda name, rows: points[name][rows]),
        Table(layout.path_columns, 1, lambda name, rows: paths[name][rows]),
        names,
        layout.unknowns,
        attributes,
    )


def dataframe_of(path: Path) -> Any:
    """The path as a `pandas.DataFrame`, with the homotopy's names where it has any, and the events' names.

    Parameters
    ----------
    path : Path
    """
    layout, points, _, names, _ = _tables(path, "")
    frame = frames.dataframe(Table(layout.point_columns, len(rows_of(path)), lambda name, rows: points[name][rows]))
    frame["event"] = [names[k] if k >= 0 else "" for k in points.get("event_index", ())]
    called = {f"y_{i}": name for i, name in enumerate(path.labels.names)}
    if path.labels.parameter_name:
        called["parameter"] = path.labels.parameter_name
    return frame.rename(columns=called)


def save(path: Path, file: str | PathLike[str], title: str = "") -> None:
    """Write a path to a new archive.

    Parameters
    ----------
    path : Path
    file : path
    title : str

    Raises
    ------
    ArchiveError
        If it exists, or cannot be written.
    """
    save_all([path], file, title)


def save_all(many: Sequence[Path], file: str | PathLike[str], title: str = "") -> None:
    """Write paths of one homotopy to a new archive.

    Parameters
    ----------
    many : sequence of Path
        At least one; all of one number of unknowns, with the same scalars observed.
    file : path
    title : str

    Raises
    ------
    ArchiveError
        If it exists, or cannot be written.
    """
    target = as_file("file", file)
    check_new(target)
    layout, _, _, _, attributes = _tables(many[0], title)

    def write(part: Any) -> Store:
        store = Store(part, layout, attributes)
        begin = 0
        for number, path in enumerate(many):
            rows, row = rows_of(path), {**record.of_path(path, None, ()), "path": number, "member": number}
            row |= {"n_points": len(rows), "source": f"{attributes['identifier']} {number} {target.name}"}
            points = to_columns(rows, number, layout, store.name_event) if rows else None
            store.commit(points, begin, record.to_columns(row, layout), number)
            begin += len(rows)
        return store

    put(target, write)
