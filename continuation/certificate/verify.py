"""Conditions under which cells prove a path."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve
from scipy.optimize import brentq

from continuation.arrays import EPS, Array, Mask
from continuation.certificate.cells import OVERHANG, Cells, at_node, cell_sizes, joined
from continuation.certificate.closing import LIMIT, ending
from continuation.certificate.engine import Engine
from continuation.certificate.folds import RANGE, Piece, located, signs, turns
from continuation.certificate.links import NODE_ULPS, Nodes, linked, nodes, reach
from continuation.certificate.proof import Gap, Proof, merged
from continuation.numbers.ends import thin
from continuation.path import LocatedEvent, Path
from continuation.status import Kind, Status

NOT_A_NODE = "a point of the path is no node of the proof"
OFF_CURVE = "a point of the path does not lie on the curve"
NO_END = "no tube was found at the end"
NOWHERE = "where the parameter turns is not known"

POINT_DISTANCE = 1e-4
"""Allowed distance of points and events from the curve, in steps; events are located to 1e-6."""


def verified(engine: Engine, cells: Cells, path: Path, homotopy: Any, gaps: list[Gap], found: list[Piece]) -> Proof:
    """The proof by tested cells, in order; `gaps` so far, `found`: pieces of the parameter's rate."""
    if not len(cells):
        whole = Gap(float(path.arclength[0]), float(path.arclength[-1]), "there are no tubes")
        return Proof(cells, cells.radius, tuple(gaps) or (whole,), (), "")
    at, joints, ends = _joined_up(engine, cells)
    gaps = [
        *gaps,
        *(
            Gap(float(cells.place[k, 1]), float(cells.place[k + 1, 0]), "two tubes are not linked")
            for k in np.flatnonzero(~joints)
            if cells.place[k, 1] == cells.place[k + 1, 0]
        ),
        *_order(cells, path, ends.take(slice(0, 1))),
        *_beside(cells, at, ends.take(slice(0, 1)), path),
    ]
    end, radius, missing = ending(cells, at, ends, path, homotopy)
    before, last = float(cells.place[-1, 1]), float(path.arclength[-1])
    if end and radius is None and path.status is Status.REACHED_TARGET:
        # The proof of the end covers the rest.
        gaps = [gap for gap in gaps if gap.begin < before or gap.reason not in (NOT_A_NODE, NO_END)]
    places = _places(engine, cells, path)
    ranges, more = _turning(engine, cells, _between_nodes(found, cells, ends, at), path, places)
    gaps += more + _events(path, places)
    if missing:
        gaps.append(Gap(before if missing == LIMIT else last, last, missing))
    return Proof(cells, at.radius, merged(gaps), ranges, end, radius)


def _joined_up(engine: Engine, cells: Cells) -> tuple[Nodes, Mask, Nodes]:
    """Nodes at the cells' ends, links to the next cells, and nodes at start and end, whose chart is the parameter."""
    level = np.zeros_like(cells.chart[-1:])
    level[0, -1] = 1.0
    first, last = cells.take(slice(0, 1)), evolve(cells.take(slice(-1, None)), chart=level)
    s = np.ones(len(cells) + 2)
    s[-2] = 0.0
    every = nodes(engine, joined([cells, first, last]), s)
    at, ends = every.take(slice(0, -2)), every.take(slice(-2, None))
    joints = linked(cells.take(slice(None, -1)), at.take(slice(0, -1)), cells.take(slice(1, None)))
    return at, joints, ends


def _order(cells: Cells, path: Path, first: Nodes) -> list[Gap]:
    gaps = []
    arclength, points = path.arclength, path.u
    places = cells.place.ravel().tolist()
    corners = np.stack([cells.begin, cells.end], axis=1).reshape(-1, points.shape[1])
    k = 0
    for j, (s, u) in enumerate(zip(arclength.tolist(), points)):
        while k < len(places) and not (places[k] == s and (corners[k] == u).all()):
            k += 1
        if k == len(places):
            before = float(arclength[max(j - 1, 0)])
            at_end = j == len(points) - 1 and before < places[-1]
            gaps.append(Gap(places[-1] if at_end else before, s, NOT_A_NODE))
            break
    for (_, before), (after, _) in pairwise(cells.place.tolist()):
        if before != after:
            gaps.append(Gap(before, after, "no tube was found"))
    if arclength[0] != cells.place[0, 0]:
        gaps.append(Gap(float(arclength[0]), float(cells.place[0, 0]), "no tube was found at the start"))
    if arclength[-1] != cells.place[-1, 1]:
        gaps.append(Gap(float(cells.place[-1, 1]), float(arclength[-1]), NO_END))
    if not first.proved.all() or not (first.radius <= cells.radius[:1]).all():
        gaps.append(Gap(float(arclength[0]), float(arclength[0]), "no point of the curve was found at the start"))
    return gaps


def _beside(cells: Cells, at: Nodes, first: Nodes, path: Path) -> list[Gap]:
    """Check that the curve is near each node: wide tubes would hold a moved start too.

    Nodes of sound paths are within 2e-8 of their steps (twelve acceptance problems, two presets, ten examples).
    """
    own, u = cells.take(np.append(0, np.arange(len(cells)))), np.vstack([cells.begin[:1], cells.end])
    place = np.append(cells.place[0, 0], cells.place[:, 1])
    far = ~(np.vstack([first.radius, at.radius]) <= _allowed(own, u, place, path)).all(axis=1)
    return [Gap(s, s, OFF_CURVE) for s in place[far].tolist()]


def _allowed(own: Cells, u: Array, arclength: Array, path: Path) -> Array:
    step = np.clip(np.searchsorted(path.arclength, arclength), 1, len(path) - 1)
    size = np.maximum(cell_sizes(own), np.abs(path.u[step] - path.u[step - 1]))
    # The tube is the only size of a component that stands still.
    return np.where(own.begin == own.end, own.radius, POINT_DISTANCE * size) + 8.0 * NODE_ULPS * EPS * np.abs(u)


def _between_nodes(found: list[Piece], cells: Cells, start: Nodes, at: Nodes) -> list[Piece]:
    ends = []
    for node, k, place in ((start, 0, 0.0), (at, -1, float(len(cells)))):
        rate = int(signs(node.tangent[k, -1]))
        known = rate and (node.radius[k] <= cells.radius[k]).all()
        ends.append([Piece(place, place, rate, 0)] if known else [])
    return [*ends[0], *found, *ends[1]]


def _turning(
    engine: Engine, cells: Cells, found: list[Piece], path: Path, places: list[float | None]
) -> tuple[tuple[tuple[float, float], ...], list[Gap]]:
    """Ranges of arclength with one turning point each, and disagreements with the path."""
    understood, unknown = turns(found)
    gaps = [Gap(*_range(cells, *place), "turning points could not be counted") for place in unknown]
    listed = [(p, e.arclength) for p, e in zip(places, path.events) if e.turns]
    ranges, taken, slack = [], set(), 2.0 * OVERHANG
    for turn in located(engine, cells, understood):
        inside = {
            k
            for k, (place, _) in enumerate(listed)
            if place is not None and k not in taken and turn.lo - slack <= place <= turn.hi + slack
        }
        if not turn.certain and not inside:
            continue  # beyond an end of the path
        where = _range(cells, turn.lo, turn.hi)
        ranges.append(where)
        taken |= inside
        if turn.hi - turn.lo > RANGE:
            gaps.append(Gap(*where, NOWHERE))
        if len(inside) != 1:
            more = "more turning points are listed" if inside else "a turning point that the path does not list"
            gaps.append(Gap(*where, more))
    gaps += [
        Gap(s, s, "a turning point is listed where there is none") for k, (_, s) in enumerate(listed) if k not in taken
    ]
    return tuple(ranges), gaps


def _range(cells: Cells, lo: float, hi: float) -> tuple[float, float]:
    k = np.clip(np.array([lo, hi]).astype(int), 0, len(cells) - 1)
    begin, end = cells.place[k].T
    first, last = (begin + np.clip([lo, hi] - k, 0.0, 1.0) * (end - begin)).tolist()
    return first, last


def _places(engine: Engine, cells: Cells, path: Path) -> list[float | None]:
    places = [_place(cells, event, path) for event in path.events]
    known = [k for k, place in enumerate(places) if place is not None]
    if known:
        own = cells.take([min(int(places[k] or 0.0), len(cells) - 1) for k in known])
        u, s = (np.array([getattr(path.events[k], name) for k in known]) for name in ("u", "arclength"))
        near = nodes(engine, evolve(own, begin=u), np.zeros(len(u))).radius <= _allowed(own, u, s, path)
        for k in np.flatnonzero(~near.all(axis=1)):
            places[known[k]] = None
    return places


def _place(cells: Cells, event: LocatedEvent, path: Path) -> float | None:
    """Cell index + parameter of an event; arclength tells only the step."""
    step = min(max(int(np.searchsorted(path.arclength, event.arclength)), 1), len(path) - 1)
    begin, end = path.arclength[step - 1 : step + 1]
    here = (begin <= cells.place[:, 1]) & (cells.place[:, 0] <= end) & np.isfinite(event.u).all()
    for k in np.flatnonzero(here).tolist():
        cell = cells.take(slice(k, k + 1))
        t = _parameter(cell, event.u)
        if (reach(cell, t, thin(event.u) - at_node(cell, t).over[0]) <= cell.radius).all():
            return float(k + t[0])
    return None


def _parameter(cell: Cells, u: Array) -> Array:
    """About the t with c . (p(t) - u) = 0: the cubic advances in a proved cell."""
    chord, first, last = cell.end - cell.begin, cell.slope_begin, cell.slope_end
    rows = first + last - 2.0 * chord, 3.0 * chord - 2.0 * first - last, first, cell.begin - u
    cubic = np.poly1d([float(cell.chart[0] @ row[0]) for row in rows])
    t = 0.0 if cubic(0.0) >= 0.0 else 1.0 if cubic(1.0) <= 0.0 else brentq(cubic, 0.0, 1.0, xtol=EPS)
    return np.array([t])


def _events(path: Path, places: list[float | None]) -> list[Gap]:
    gaps, last = [], -np.inf
    for event, place in zip(path.events, places):
        s = event.arclength
        if place is None:
            gaps.append(Gap(s, s, f"the event {event.name!r} does not lie on the curve"))
        elif event.kind is Kind.BRANCH_POINT:
            gaps.append(Gap(s, s, "a branch point is listed where the curve is smooth"))
        elif place < last - 2.0 * OVERHANG:
            gaps.append(Gap(s, s, f"the event {event.name!r} is out of order"))
        last = last if place is None else max(last, place)
    return gaps
