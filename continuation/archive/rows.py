"""Steps and events as rows of the point table, a path as a row of the path table, and the way back."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise, zip_longest
from operator import attrgetter
from typing import Any

import numpy as np
from attrs import define, evolve, field, frozen

from continuation.archive.provenance import class_path, scalars
from continuation.archive.schema import (
    ACCEPTED,
    CONTROLLER_STATE,
    COUNT_NAMES,
    KINK_PART,
    LOCATED,
    NO_EVENT,
    Layout,
    text,
)
from continuation.arguments.checks import integer, number
from continuation.arrays import Array
from continuation.homotopy import SupportsPieces
from continuation.path import LocatedEvent, Path, Step
from continuation.point.segment import hermite
from continuation.step.state import State
from continuation.step.tracer import Tracer

_FLOATS = (
    "arclength", "step_length", "residual_norm", "event_monitor", "contraction", "distance", "angle", "parameter_share",
)  # fmt: skip
_INTEGERS = {
    "orientation": "i1", "kind": "i1", "role": "i1",
    "event_index": "i2", "corrector_iterations": "i2", "rejections": "i2",
}  # fmt: skip
_NAN = math.nan

Record = dict[str, Any]
"""The cells of a row of the path table, by column name."""


@frozen
class Row:
    """A row to be: an accepted step, with the event that it ends on if it does; an event between two steps; or a part
    of the kink before it, of which `switch` is a switching function, and `tangent` a ray.
    """

    point: Step | LocatedEvent
    event: LocatedEvent | None
    role: int
    tangent: Array
    switch: int = -1


def parts_of(event: LocatedEvent | None) -> list[Row]:
    """The rows of a kink's switches and rays, which follow its own; none for other events."""
    if event is None:
        return []
    nothing = np.full_like(event.u, _NAN)
    pairs = zip_longest(event.switches, () if event.rays is None else event.rays)
    return [
        Row(event, None, KINK_PART, nothing if ray is None else ray, -1 if switch is None else switch)
        for switch, ray in pairs
    ]


def rows_at(step: Step, events: Sequence[LocatedEvent], pieces: bool) -> list[Row]:
    """A step and the events that have come since the one before; the last one shares its row if the step ends there."""
    if not events:
        return [Row(step, None, ACCEPTED, step.tangent)]
    last = events[-1] if events[-1].ends_step and events[-1].kind == step.kind else None
    before = [Row(event, event, LOCATED, event.tangent) for event in (events if last is None else events[:-1])]
    return [*before, Row(step, last, ACCEPTED, step.tangent), *(parts_of(last) if pieces else ())]


def rows_of(path: Path, pieces: bool = False) -> list[Row]:
    """Steps and located events in the order of the path; with the switches and the rays of its kinks if `pieces`."""
    rows, begin = list[Row](), 0
    for step in path.steps:
        end = bisect_right(path.events, step.index, begin, key=lambda event: event.step)
        rows += rows_at(step, path.events[begin:end], pieces)
        begin = end
    return rows


def layout_of(
    homotopy: Any,
    unknowns: int,
    observed: Sequence[str],
    controller: Sequence[float],
    tangents: bool,
    early: Iterable[Record] = (),
) -> Layout:
    """The layout of a file that begins with a path of a homotopy, behind rows of paths that were over `early`."""
    prefix, pieces = "homotopy_", isinstance(homotopy, SupportsPieces)
    names = {name.removeprefix(prefix) for row in early for name in row if name.startswith(prefix)}
    names |= set(scalars(homotopy))
    width = max(len(controller), CONTROLLER_STATE)
    return Layout(unknowns, width, tuple(observed), tuple(sorted(names)), tangents or pieces, pieces)


def to_columns(rows: Sequence[Row], path: int, layout: Layout, number: Callable[[str], int]) -> dict[str, Any]:
    """The block of columns for some rows of one path; `number` numbers an event's name."""
    m = len(rows)
    floats, integers = np.empty((len(_FLOATS), m)), np.empty((len(_INTEGERS), m), dtype="i2")
    values = [_values(row, number) for row in rows]
    floats[:] = np.array([pair[0] for pair in values]).T
    integers[:] = np.array([pair[1] for pair in values]).T
    y, parameter = np.empty((m, layout.unknowns)), np.empty(m)
    for i, row in enumerate(rows):
        y[i], parameter[i] = row.point.u[:-1], row.point.u[-1]
    block: dict[str, Any] = {"path_index": np.full(m, path, dtype="i4"), "parameter": parameter, "y": y}
    block |= dict(zip(_FLOATS, floats))
    block |= {name: column.astype(dtype) for (name, dtype), column in zip(_INTEGERS.items(), integers)}
    if layout.tangents:
        tangents = np.array([row.tangent for row in rows])
        block["tangent_y"] = np.ascontiguousarray(tangents[:, :-1])
        block["tangent_parameter"] = np.ascontiguousarray(tangents[:, -1])
    if layout.pieces:
        block["switch"] = np.array([row.switch for row in rows], dtype="i4")
    for name in layout.observed:
        block[f"observed_{name}"] = np.array([float(row.point.observed.get(name, _NAN)) for row in rows])
    return block


def _values(row: Row, number: Callable[[str], int]) -> tuple[tuple[float, ...], tuple[int, ...]]:
    at = row.point
    index, monitor = (NO_EVENT, _NAN) if row.event is None else (number(row.event.name), row.event.monitor)
    if isinstance(at, Step):
        return (
            (at.arclength, at.step_length, at.residual_norm, monitor, at.contraction, at.distance, at.angle, at.share),
            (at.orientation, at.kind, row.role, index, at.corrector_iterations, at.rejections),
        )
    return (
        (at.arclength, _NAN, at.residual_norm, monitor, _NAN, _NAN, _NAN, _NAN),
        (at.orientation if row.role == LOCATED else 0, at.kind, row.role, index, -1, -1),
    )


def from_columns(
    block: Mapping[str, Any], names: Sequence[str], observed: Sequence[str], first: int = 0
) -> tuple[list[Step], list[LocatedEvent]]:
    """Steps and events of one path again, the first step with the index `first`.

    Tangents are NaN where the archive does not hold them.
    """
    points = np.column_stack((block["y"], block["parameter"]))
    tangents = np.full_like(points, _NAN)
    if "tangent_y" in block:
        tangents = np.column_stack((block["tangent_y"], block["tangent_parameter"]))
    cells = {name: block[name].tolist() for name in (*_FLOATS, *_INTEGERS)}
    extras = {name: block[f"observed_{name}"].tolist() for name in observed}
    steps: list[Step] = []
    events: list[LocatedEvent] = []
    parts: dict[int, list[int]] = {}
    for i in range(len(points)):
        seen, index = {name: column[i] for name, column in extras.items()}, first + len(steps)
        if cells["event_index"][i] != NO_EVENT:
            events.append(_event(cells, i, points[i], tangents[i], names, seen, index))
        if cells["role"][i] == ACCEPTED:
            steps.append(_step(cells, i, points[i], tangents[i], seen, index))
        if cells["role"][i] == KINK_PART and events and "switch" in block:
            parts.setdefault(len(events) - 1, []).append(i)
    for k, at in parts.items():
        # Of both lists the longer decides how many parts there are; the other ends in -1, or in NaN.
        switches, rays = block["switch"][at], tangents[at]
        rays = rays[~np.isnan(rays).any(axis=1)]
        named = tuple(switches[switches >= 0].tolist())
        events[k] = evolve(events[k], switches=named, rays=rays if len(rays) else None)
    accepted = {step.index: step.u for step in steps}
    events = [evolve(e, ends_step=e.step in accepted and np.array_equal(e.u, accepted[e.step])) for e in events]
    return (_joined(steps, events) if "tangent_y" in block else steps), events


def _joined(steps: Sequence[Step], events: Sequence[LocatedEvent]) -> list[Step]:
    """The steps joined by cubics through points and tangents, for dense output."""
    joined = list(steps[:1])
    onward = {e.step: e.rays[1] for e in events if e.rays is not None and len(e.rays) > 1}
    for before, after in pairwise(steps):
        v = onward.get(before.index, before.tangent)
        joined.append(evolve(after, segment=hermite(before.u, v, after.u, after.tangent, v)))
    return joined


def _event(
    cells: Mapping[str, Any], i: int, u: Any, v: Any, names: Sequence[str], observed: Mapping[str, float], step: int
) -> LocatedEvent:
    return LocatedEvent(
        name=names[cells["event_index"][i]], kind=cells["kind"][i], arclength=cells["arclength"][i], u=u, tangent=v,
        residual_norm=cells["residual_norm"][i], monitor=cells["event_monitor"][i], orientation=cells["orientation"][i],
        step=step, observed=observed,
    )  # fmt: skip


def _step(cells: Mapping[str, Any], i: int, u: Any, v: Any, observed: Mapping[str, float], index: int) -> Step:
    return Step(
        index=index, u=u, tangent=v, arclength=cells["arclength"][i], step_length=cells["step_length"][i],
        residual_norm=cells["residual_norm"][i], orientation=cells["orientation"][i], kind=cells["kind"][i],
        corrector_iterations=cells["corrector_iterations"][i], rejections=cells["rejections"][i],
        contraction=cells["contraction"][i], distance=cells["distance"][i], angle=cells["angle"][i],
        share=cells["parameter_share"][i], observed=observed,
    )  # fmt: skip


# -- rows of the path table, and what a log holds of a path ----------------------------------------------------


@frozen(eq=False)
class Mark:
    """A point to resume from: the state, the counters there, and how many rows of the path come before it."""

    state: State
    counts: tuple[int, ...]
    rows: int


@define(eq=False)
class Buffer:
    """Rows not yet committed, and the number of the first: one object, so that a commit is one assignment."""

    start: int
    rows: list[Row] = field(factory=list)
    nbytes: int = 0


@define(eq=False)
class OpenPath:
    """The path being written."""

    tracer: Tracer
    number: int
    rows: int = 0
    seconds: float = 0.0
    run: bytes | None = None
    last: Mark | None = None
    resume: Mark | None = None
    skipped: Step | None = None


@frozen
class Limits:
    """When buffered rows are committed: at so many rows, bytes of points, or seconds since the last commit."""

    rows: int = field(default=256, validator=integer(1))
    nbytes: int = field(default=4 << 20, validator=integer(1))
    seconds: float = field(default=1.0, validator=number("at least 0", lambda x: x >= 0.0))


counted = attrgetter(*COUNT_NAMES)
"""The counters of `Counts` as a tuple, in the order of `COUNT_NAMES`."""


def record_of(path: Path, homotopy: Any, controller: tuple[float, ...]) -> Record:
    """What the path itself says."""
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
        **{f"homotopy_{name}": value for name, value in scalars(homotopy).items()},
        "homotopy": "" if homotopy is None else class_path(homotopy),
        "source": "",
    }


def row_columns(record: Mapping[str, Any], layout: Layout) -> dict[str, Any]:
    """The row of the path table as a block: each column an array of length 1."""
    block: dict[str, Any] = {}
    for column in layout.path_columns:
        cell = record.get(column.name, column.missing)
        if column.length and isinstance(cell, str):
            cell = text(cell, column.length)
        block[column.name] = np.array([cell], dtype=column.storage)
    state = record["controller_state"][: layout.controller]
    block["controller_state"] = np.array([[*state, *[_NAN] * (layout.controller - len(state))]])
    return block
