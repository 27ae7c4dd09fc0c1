"""Conversion between paths and rows of the two tables."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import zip_longest
from operator import attrgetter
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.archive.provenance import class_path, scalars
from continuation.archive.schema import (
    ACCEPTED,
    COUNT_NAMES,
    KINK_PART,
    LATER,
    LOCATED,
    OBSERVED,
    PARAMETER,
    Layout,
    text,
)
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
    """A row to write: a step, perhaps with its event; an event between steps; a switch or ray of the kink before."""

    point: Step | LocatedEvent
    event: LocatedEvent | None
    role: int
    tangent: Array
    switch: int = -1


def rows_at(step: Step, events: Sequence[LocatedEvent]) -> list[Row]:
    """Rows of a step and its events; an event at the step shares its row, a kink adds switches and rays."""
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
    rows, begin = list[Row](), 0
    for step in path.steps:
        end = bisect_right(path.events, step.index, begin, key=lambda event: event.step)
        rows += rows_at(step, path.events[begin:end])
        begin = end
    return rows


def layout_of(
    homotopy: Any, unknowns: int, observed: Iterable[str], controller: Sequence[float], early: Iterable[Record] = ()
) -> Layout:
    """The layout of a new file; `early` are rows without points."""
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
"""The counters in the order of `COUNT_NAMES`."""


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
        "homotopy": "" if homotopy is None else class_path(homotopy),
        "source": "",
    }


def row_columns(record: Mapping[str, Any], layout: Layout) -> dict[str, Any]:
    """The path's row as a block."""
    cells = {**record, "controller_state": record["controller_state"][: layout.controller]}
    known = [column for column in layout.columns("path") if column.name in cells]
    own = {c.name: text(cells[c.name], c.length) if c.length else cells[c.name] for c in known}
    return layout.filled({c.name: np.array([own[c.name]], dtype=c.storage) for c in known}, "path", 1)
