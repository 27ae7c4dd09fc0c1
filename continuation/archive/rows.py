"""The two tables of an archive with columns read on demand, and paths converted to rows and back."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import groupby, zip_longest
from operator import attrgetter
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.archive.atomic import ArchiveError
from continuation.archive.codec import class_path
from continuation.archive.provenance import scalars
from continuation.archive.schema import (
    ACCEPTED,
    COMPONENT,
    COUNT_NAMES,
    EVENT_NAME,
    KINK_PART,
    LATER,
    LOCATED,
    OBSERVED,
    PARAMETER,
    Column,
    Layout,
    text,
)
from continuation.arguments.checks import expect
from continuation.arrays import Array
from continuation.path import LocatedEvent, Path, Step
from continuation.point.segment import hermite

_FLOATS = ("arclength", "step_length", "residual_norm", "contraction", "distance", "angle")
_INTEGERS = {"orientation": "i1", "kind": "i1", "corrector_iterations": "i2", "rejections": "i2"}
_SHARE, _NAN = "parameter_share", math.nan

Record = dict[str, Any]
"""Cells of a path's row, by column."""


@frozen
class Row:
    """A row to write: a step, perhaps with an event; an event between steps; or a switch or ray of the kink before."""

    point: Step | LocatedEvent
    event: LocatedEvent | None
    role: int
    tangent: Array
    switch: int = -1


def rows_at(step: Step, events: Sequence[LocatedEvent]) -> list[Row]:
    """Rows of a step and its events. An event at the step shares its row; a kink adds switches and rays."""
    if not events:
        return [Row(step, None, ACCEPTED, step.tangent)]
    last = events[-1] if events[-1].ends_step and events[-1].kind == step.kind else None
    rows = [Row(event, event, LOCATED, event.tangent) for event in (events if last is None else events[:-1])]
    rows.append(Row(step, last, ACCEPTED, step.tangent))
    if last is not None and last.switches:
        nothing, rays = np.full_like(last.u, _NAN), () if last.rays is None else last.rays
        for switch, ray in zip_longest(last.switches, rays):
            tangent = nothing if ray is None else ray
            rows.append(Row(last, None, KINK_PART, tangent, -1 if switch is None else switch))
    return rows


def rows_of(path: Path) -> list[Row]:
    """Steps and events in path order."""
    events = {step: [*found] for step, found in groupby(path.events, attrgetter("step"))}
    return [row for step in path.steps for row in rows_at(step, events.get(step.index, ()))]


def layout_of(
    homotopy: Any, unknowns: int, observed: Iterable[str], controller: Sequence[float], early: Iterable[Record] = ()
) -> Layout:
    """The layout of a new file; `early`: rows of paths that ended without points."""
    said = {PARAMETER + name for name in scalars(homotopy)}
    said |= {name for row in early for name in row if name.startswith(PARAMETER)}
    layout = Layout(unknowns, more=LATER | said | {OBSERVED + name for name in observed})
    return evolve(layout, controller=max(len(controller), layout.controller))


def to_columns(rows: Sequence[Row], path: int, layout: Layout, number: Callable[[str], int]) -> dict[str, Any]:
    """Rows of one path as columns."""
    points, events = [row.point for row in rows], [row.event for row in rows]
    block: dict[str, Any] = {
        "path_index": np.full(len(rows), path, dtype="i4"),
        "role": np.array([row.role for row in rows], dtype="i1"),
        "event_index": np.array([-1 if e is None else number(e.name) for e in events], dtype="i2"),
        "switch": np.array([row.switch for row in rows], dtype="i4"),
        "event_monitor": np.array([_NAN if e is None else e.monitor for e in events]),
        _SHARE: np.array([getattr(point, "share", _NAN) for point in points]),
        **_split("parameter", "y", [point.u for point in points]),
        **_split("tangent_parameter", "tangent_y", [row.tangent for row in rows]),
    }
    block |= {name: np.array([getattr(point, name, _NAN) for point in points], dtype="f8") for name in _FLOATS}
    block |= {name: np.array([getattr(p, name, -1) for p in points], dtype=kind) for name, kind in _INTEGERS.items()}
    block["orientation"][block["role"] == KINK_PART] = 0
    for name in layout.own(OBSERVED):
        block[OBSERVED + name] = np.array([float(row.point.observed.get(name, _NAN)) for row in rows])
    return block


def _split(last: str, first: str, vectors: Sequence[Array]) -> dict[str, Any]:
    whole = np.array(vectors)
    return {last: whole[:, -1].copy(), first: whole[:, :-1].copy()}


def from_columns(
    block: Mapping[str, Any], names: Sequence[str], observed: Sequence[str], first: int = 0
) -> tuple[list[Step], list[LocatedEvent]]:
    """Steps, numbered from `first`, and events of one path."""
    points = np.column_stack((block["y"], block["parameter"]))
    tangents = np.full_like(points, _NAN)
    if "tangent_y" in block:
        tangents = np.column_stack((block["tangent_y"], block["tangent_parameter"]))
    held = not np.isnan(tangents[block["role"] == ACCEPTED]).any()
    steps: list[Step] = []
    events: list[LocatedEvent] = []
    parts: dict[int, list[int]] = {}
    fields = (*_FLOATS, *_INTEGERS, "event_index", "role", "event_monitor", _SHARE)
    columns = [block[name].tolist() for name in fields]
    extras = [block[OBSERVED + name].tolist() for name in observed]
    for i, (u, v) in enumerate(zip(points, tangents)):
        at = dict(zip(fields, [column[i] for column in columns]))
        seen, index = {name: column[i] for name, column in zip(observed, extras)}, first + len(steps)
        number, role, monitor, share = (at.pop(name) for name in ("event_index", "role", "event_monitor", _SHARE))
        if number >= 0:
            shared = {name: at[name] for name in ("kind", "arclength", "residual_norm", "orientation")}
            events.append(
                LocatedEvent(names[number], u=u, tangent=v, monitor=monitor, step=index, observed=seen, **shared)
            )
        if role == ACCEPTED:
            steps.append(Step(index=index, u=u, tangent=v, share=share, observed=seen, **at))
        if role == KINK_PART and events and "switch" in block:
            parts.setdefault(len(events) - 1, []).append(i)
    for k, rows in parts.items():
        # The shorter of the two lists ends in -1 or NaN.
        switches, rays = block["switch"][rows], tangents[rows]
        rays = rays[~np.isnan(rays).any(axis=1)]
        named = tuple(switches[switches >= 0].tolist())
        events[k] = evolve(events[k], switches=named, rays=rays if len(rays) else None)
    accepted = {step.index: step.u for step in steps}
    events = [evolve(e, ends_step=e.step in accepted and np.array_equal(e.u, accepted[e.step])) for e in events]
    return (_joined(steps, events) if held else steps), events


def _joined(steps: Sequence[Step], events: Sequence[LocatedEvent]) -> list[Step]:
    onward = {e.step: e.rays[1] for e in events if e.rays is not None and len(e.rays) > 1}
    begins = [onward.get(step.index, step.tangent) for step in steps]
    return list(steps[:1]) + [
        evolve(after, segment=hermite(before.u, v, after.u, after.tangent, v))
        for before, v, after in zip(steps, begins, steps[1:])
    ]


counted = attrgetter(*COUNT_NAMES)


def record_of(path: Path, homotopy: Any, controller: tuple[float, ...]) -> Record:
    """The path's own cells."""
    seed = getattr(homotopy, "seed", None)
    return {
        **{COUNT_NAMES[name]: value for name, value in zip(COUNT_NAMES, counted(path.counts))},
        "status": int(path.status),
        "message": path.message,
        "seed": int(seed) if isinstance(seed, (int, np.integer)) and abs(int(seed)) < 2**63 else -1,
        "wall_time": path.seconds,
        "end_error": _NAN if path.end_error is None else path.end_error,
        "winding_number": path.winding_number or 0,
        "controller_state": controller,
        **{PARAMETER + name: value for name, value in scalars(homotopy).items()},
        "homotopy": "" if homotopy is None else class_path(type(homotopy)),
        "source": "",
    }


def row_columns(record: Mapping[str, Any], layout: Layout) -> dict[str, Any]:
    """The path's row as a block."""
    cells = {**record, "controller_state": record["controller_state"][: layout.controller]}
    known = [column for column in layout.columns("path") if column.name in cells]
    own = {c.name: text(cells[c.name], c.length) if c.length else cells[c.name] for c in known}
    return layout.filled({c.name: np.array([own[c.name]], dtype=c.storage) for c in known}, "path", 1)


Fetch = Callable[[Column, slice], np.ndarray[Any, Any]]
Block = dict[str, Any]
"""Rows of a table, by column."""

ROWS_AT_ONCE, BYTES_AT_ONCE = 4096, 1 << 22
"""Rows and bytes of one read: shorter ones cost more; 260 rows of 1000 unknowns with tangents take 4 MiB."""


class Table(Mapping[str, "np.ndarray[Any, Any]"]):
    """Columns by name, read on demand and cached.

    Attributes
    ----------
    columns : dict of str to Column
    size : int
        Number of rows.
    at_once : int
        Least number of rows in one read.
    """

    def __init__(self, layout: Layout, table: str, rows: int, fetch: Fetch) -> None:
        self.columns = {column.name: column for column in layout.columns(table)}
        self.size, self._fetch = rows, fetch
        self.at_once = min(max(BYTES_AT_ONCE // layout.row_bytes[table], 1), ROWS_AT_ONCE)
        self._read: dict[str, tuple[int, np.ndarray[Any, Any]]] = {}

    @classmethod
    def of(cls, layout: Layout, table: str, columns: Mapping[str, Any]) -> Table:
        """A table in memory.

        Parameters
        ----------
        layout : Layout
        table : str
            "point" or "path".
        columns : mapping of str to ndarray
        """
        return cls(layout, table, len(next(iter(columns.values()))), partial(_part, columns))

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        if name not in self.columns:
            raise KeyError(f"column: expected one of {', '.join(self.columns)}, found {name!r}")
        return self.some(name, slice(0, self.size))

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def block(self, rows: slice) -> dict[str, np.ndarray[Any, Any]]:
        """All columns of some rows.

        Parameters
        ----------
        rows : slice
        """
        return {name: self.some(name, rows) for name in self.columns}

    def some(self, name: str, rows: slice) -> np.ndarray[Any, Any]:
        """Rows of one column, with further rows read ahead.

        Parameters
        ----------
        name : str
        rows : slice
        """
        start, held = self._read.get(name, (0, None))
        if held is None or not start <= rows.start <= rows.stop <= start + len(held):
            start, stop = rows.start, max(rows.stop, min(rows.start + self.at_once, self.size))
            try:
                held = self._fetch(self.columns[name], slice(start, stop))
            except ArchiveError:
                # Rows beyond the request may be damaged.
                held = self._fetch(self.columns[name], rows)
            self._read[name] = start, held
        return held[rows.start - start : rows.stop - start]


def kept_whole(keep: str) -> bool:
    """Whether `keep` is ``"all"``, not ``"ends"``."""
    expect(keep in ("all", "ends"), "keep", '"all" or "ends"', keep)
    return keep == "all"


def joined(blocks: Sequence[Block]) -> Block:
    """Blocks of rows as one block."""
    return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}


def _part(columns: Mapping[str, Any], column: Column, rows: slice) -> Any:
    """Picklable, for shares that workers send."""
    return columns[column.name][rows]


def dataset(points: Table, paths: Table, events: Sequence[str], unknowns: int, attributes: Mapping[str, Any]) -> Any:
    """An `xarray.Dataset` like the file."""
    import xarray

    variables: dict[str, Any] = {
        name: (column.dimensions, _text(table[name]), column.attributes)
        for table in (points, paths)
        for name, column in table.columns.items()
    }
    variables["event_name"] = (EVENT_NAME.dimensions, np.array(events), EVENT_NAME.attributes)
    component = np.arange(unknowns, dtype=COMPONENT.storage)
    coordinates = {"path": variables.pop("path"), "component": (COMPONENT.dimensions, component, COMPONENT.attributes)}
    return xarray.Dataset(variables, coordinates, attributes)


def flat(block: Mapping[str, Any]) -> dict[str, Any]:
    """The columns; a matrix becomes one for each component."""
    columns = {}
    for name, values in block.items():
        parts = {name: _text(values)} if values.ndim == 1 else {f"{name}_{i}": v for i, v in enumerate(values.T)}
        columns.update(parts)
    return columns


def _text(values: Any) -> Any:
    return np.char.decode(values, "utf-8", "replace") if values.dtype.kind == "S" else values
