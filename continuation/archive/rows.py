"""Steps and events as columns of the point table."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.archive.schema import ACCEPTED, KINK_PART, LOCATED, NO_EVENT, Layout
from continuation.arrays import Array
from continuation.path import LocatedEvent, Step
from continuation.point.segment import hermite

_FLOATS = (
    "arclength", "step_length", "residual_norm", "event_monitor", "contraction", "distance", "angle", "parameter_share",
)  # fmt: skip
_INTEGERS = {
    "orientation": "i1", "kind": "i1", "role": "i1",
    "event_index": "i2", "corrector_iterations": "i2", "rejections": "i2",
}  # fmt: skip
_NAN = math.nan


@frozen
class Row:
    """A row to be: an accepted step, the event that it ends on if it does, or an event between two steps.

    Or a `part` of the kink `event`: its switch and its ray of that number, as far as it has so many.
    """

    step: Step | None
    event: LocatedEvent | None = None
    part: int | None = None

    @property
    def point(self) -> Step | LocatedEvent:
        """The step, or else the event."""
        point = self.step if self.step is not None else self.event
        assert point is not None
        return point

    @property
    def tangent(self) -> Array:
        """The point's tangent, or the ray that a part is."""
        if self.part is None:
            return self.point.tangent
        rays = None if self.event is None else self.event.rays
        return np.full_like(self.point.u, _NAN) if rays is None or self.part >= len(rays) else rays[self.part]

    @property
    def switch(self) -> int:
        """The number of the switch that a part is."""
        switches = () if self.event is None or self.part is None else self.event.switches
        return switches[self.part] if self.part is not None and self.part < len(switches) else -1


def parts_of(event: LocatedEvent | None) -> list[Row]:
    """The rows of a kink's switches and rays, which follow its own; none for other events."""
    rays = 0 if event is None or event.rays is None else len(event.rays)
    switches = 0 if event is None else len(event.switches)
    return [Row(None, event, part) for part in range(max(rays, switches))]


def to_columns(rows: Sequence[Row], path: int, layout: Layout, number: Callable[[str], int]) -> dict[str, Any]:
    """The block of columns for some rows of one path; `number` numbers an event's name."""
    m = len(rows)
    floats, integers = np.empty((len(_FLOATS), m)), np.empty((len(_INTEGERS), m), dtype="i2")
    values = [_values(row, number) for row in rows]
    floats[:] = np.array([pair[0] for pair in values]).T
    integers[:] = np.array([pair[1] for pair in values]).T
    y, parameter = np.empty((m, layout.unknowns)), np.empty(m)
    for i, row in enumerate(rows):
        u = row.point.u
        y[i] = u[:-1]
        parameter[i] = u[-1]
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
        block[f"observed_{name}"] = np.array([_observed(row, name) for row in rows])
    return block


def _values(row: Row, number: Callable[[str], int]) -> tuple[tuple[float, ...], tuple[int, ...]]:
    step, event = row.step, row.event
    if row.part is not None:
        at = row.point
        return (
            (at.arclength, _NAN, at.residual_norm, _NAN, _NAN, _NAN, _NAN, _NAN),
            (0, at.kind, KINK_PART, NO_EVENT, -1, -1),
        )
    index, monitor = (NO_EVENT, _NAN) if event is None else (number(event.name), event.monitor)
    if step is None:
        assert event is not None
        return (
            (event.arclength, _NAN, event.residual_norm, monitor, _NAN, _NAN, _NAN, _NAN),
            (event.orientation, event.kind, LOCATED, index, -1, -1),
        )
    return (
        (step.arclength, step.step_length, step.residual_norm, monitor, step.contraction, step.distance, step.angle,
         step.share),
        (step.orientation, step.kind, ACCEPTED, index, step.corrector_iterations, step.rejections),
    )  # fmt: skip


def _observed(row: Row, name: str) -> float:
    return float(row.point.observed.get(name, _NAN))


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
        if cells["event_index"][i] != NO_EVENT:
            seen = {name: column[i] for name, column in extras.items()}
            events.append(_event(cells, i, points[i], tangents[i], names, seen, first + len(steps)))
        if cells["role"][i] == ACCEPTED:
            seen = {name: column[i] for name, column in extras.items()}
            steps.append(_step(cells, i, points[i], tangents[i], seen, first + len(steps)))
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
