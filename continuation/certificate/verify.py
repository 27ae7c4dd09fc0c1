"""What has to hold of cells so that a path is proved: tubes, links, order, turning points, events and the end."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import OVERHANG, Cells, Slabs, expansion
from continuation.certificate.folds import Turn, pieces, turns
from continuation.certificate.links import Nodes, linked, nodes, reach
from continuation.certificate.proof import Gap, Proof
from continuation.certificate.test import ByIntervals, Engine
from continuation.certificate.tubes import along, check
from continuation.intervals.ends import Ends, thin
from continuation.path import LocatedEvent, Path
from continuation.status import Kind, Status

WIDER = 1.5
"""A tube that does not hold its neighbour's node is tried once with radii that do, and so much more."""


def verified(
    engine: Engine,
    plain: ByIntervals,
    cells: Cells,
    path: Path,
    homotopy: Any,
    gaps: list[Gap],
    proved: bool = False,
) -> Proof:
    """The proof that these cells make.

    Parameters
    ----------
    engine : Engine
    plain : ByIntervals
    cells : Cells
        In order.
    path : Path
        What they are to prove.
    homotopy : Homotopy
    gaps : list of Gap
        Known already.
    proved : bool
        Whether the tubes have been tested.
    """
    gaps = list(gaps)
    if not proved and len(cells):
        good = check(engine, cells)
        gaps += [Gap(*cells.place[k].tolist(), "the tube does not hold") for k in np.flatnonzero(~good)]
        cells = cells.take(good)
    if not len(cells):
        begin, end = float(path.arclength[0]), float(path.arclength[-1])
        return Proof(cells, cells.radius, tuple(gaps) or (Gap(begin, end, "there are no tubes"),), (), "")
    cells, at, joints = _joined_up(engine, cells)
    gaps += [
        Gap(float(cells.place[k, 1]), float(cells.place[k + 1, 0]), "two tubes are not linked")
        for k in np.flatnonzero(~joints)
        if cells.place[k, 1] == cells.place[k + 1, 0]
    ]
    gaps += _order(cells, path, nodes(engine, cells.take(np.array([0])), 0.0))
    turning, more = _turning(engine, plain, cells, path)
    gaps += more + _events(cells, path)
    end, radius, missing = _end(engine, cells, at, path, homotopy)
    gaps += missing
    gaps.sort(key=lambda gap: (gap.begin, gap.end))
    return Proof(cells, at.radius, tuple(gaps), turning, end, radius)


def _joined_up(engine: Engine, cells: Cells) -> tuple[Cells, Nodes, Array]:
    """The cells with links between them, some of them widened for that."""
    for again in (True, False):
        at = nodes(engine, cells, 1.0)
        left, right = cells.take(slice(None, -1)), cells.take(slice(1, None))
        joints = linked(left, Nodes(at.radius[:-1], Ends(at.tangent.lo[:-1], at.tangent.hi[:-1])), right)
        if joints.all() or not again:
            break
        wanted = np.maximum(cells.radius, np.where(np.isfinite(at.radius), WIDER * at.radius, 0.0))
        needed = reach(right, 0.0, at.radius[:-1])
        wanted[1:] = np.maximum(wanted[1:], np.where(np.isfinite(needed), WIDER * needed, 0.0))
        changed = np.flatnonzero((wanted > cells.radius).any(axis=1))
        tried = cells.take(changed).with_tubes(wanted[changed], cells.slabs[changed])
        good = check(engine, tried)
        radius = cells.radius.copy()
        radius[changed[good]] = wanted[changed[good]]
        cells = cells.with_tubes(radius, cells.slabs)
    return cells, at, joints


def _order(cells: Cells, path: Path, first: Nodes) -> list[Gap]:
    """That the points of the path are nodes, in order, and that nothing is between cells; and the start."""
    gaps = []
    arclength, points = path.arclength, path.u
    k = 0
    for j, (s, u) in enumerate(zip(arclength.tolist(), points)):
        while k < len(cells) and not (cells.place[k, 0] == s and (cells.begin[k] == u).all()):
            if cells.place[k, 1] == s and (cells.end[k] == u).all():
                break
            k += 1
        if k == len(cells):
            gaps.append(Gap(float(arclength[max(j - 1, 0)]), float(s), "a point of the path is no node of the proof"))
            break
    for (_, before), (after, _) in pairwise(cells.place.tolist()):
        if before != after:
            gaps.append(Gap(before, after, "no tube was found"))
    for here, there, at in ((arclength[0], cells.place[0, 0], "start"), (arclength[-1], cells.place[-1, 1], "end")):
        if here != there:
            gaps.append(Gap(*sorted((float(here), float(there))), f"no tube was found at the {at}"))
    if not first.proved.all() or not (first.radius <= cells.radius[:1]).all():
        gaps.append(Gap(float(arclength[0]), float(arclength[0]), "no point of the curve was found at the start"))
    return gaps


# --- turning points and events ----------------------------------------------------------------------------


def _turning(
    engine: Engine, plain: ByIntervals, cells: Cells, path: Path
) -> tuple[tuple[tuple[float, float], ...], list[Gap]]:
    """Ranges of arclength with one turning point each, and where they are not those of the path."""
    found, unknown = turns(pieces(engine, plain, cells))
    gaps = [Gap(*_range(cells, *place), "turning points could not be counted") for place in unknown]
    listed = [(_place(cells, event), event.arclength) for event in path.turning_points]
    used: set[int] = set()
    for turn in found:
        slack = 2.0 * OVERHANG
        inside = [
            k
            for k, (place, _) in enumerate(listed)
            if place is not None and k not in used and turn.lo - slack <= place <= turn.hi + slack
        ]
        if len(inside) != 1 and (turn.certain or inside):
            reason = "a turning point that the path does not list" if not inside else "more turning points are listed"
            gaps.append(Gap(*_range(cells, turn.lo, turn.hi), reason))
        used.update(inside)
    gaps += [
        Gap(s, s, "a turning point is listed where there is none") for k, (_, s) in enumerate(listed) if k not in used
    ]
    return tuple(_range(cells, turn.lo, turn.hi) for turn in found if _counts(turn, listed)), gaps


def _counts(turn: Turn, listed: list[tuple[float | None, float]]) -> bool:
    slack = 2.0 * OVERHANG
    return turn.certain or any(p is not None and turn.lo - slack <= p <= turn.hi + slack for p, _ in listed)


def _range(cells: Cells, lo: float, hi: float) -> tuple[float, float]:
    """Places in cells as arclengths."""
    out = []
    for place in (lo, hi):
        k = min(max(int(place), 0), len(cells) - 1)
        begin, end = cells.place[k].tolist()
        out.append(begin + min(max(place - k, 0.0), 1.0) * (end - begin))
    return out[0], out[1]


def _place(cells: Cells, event: LocatedEvent) -> float | None:
    """Cell and parameter of a point that lies in the tube; None where it lies in none.

    With c . (u - p(s - e)) > 0 > c . (u - p(s + e)) it belongs to a parameter in between, and is to be within the
    radius of all that the cubic is there.
    """
    s = event.arclength
    near = (cells.place[:, 0] <= s * (1.0 + 1e-9) + 1e-300) & (s * (1.0 - 1e-9) <= cells.place[:, 1])
    span = cells.place[:, 1] - cells.place[:, 0]
    near |= (cells.place[:, 0] - span <= s) & (s <= cells.place[:, 1] + span)
    for k in np.flatnonzero(near).tolist():
        cell = cells.take(np.array([k]))
        t = _parameter(cell, event.u)
        for width in (1e-9, 1e-6, 0.5 * OVERHANG):
            if -OVERHANG + width <= t <= 1.0 + OVERHANG - width and _inside(cell, t, width, event.u):
                return float(k + t)
    return None


def _parameter(cell: Cells, u: Array) -> float:
    """Newton's method for c . (p(t) - u) = 0, in floats."""
    t = 0.5
    for _ in range(30):
        q = expansion(Slabs(np.zeros(1, int), np.array([t]), np.zeros(1), cell)).q
        slope = float(cell.chart[0] @ q[1].lo[0])
        if not slope > 0.0:
            return np.nan
        t = min(max(t + float(cell.chart[0] @ (u - q[0].lo[0])) / slope, -OVERHANG), 1.0 + OVERHANG)
    return t


def _inside(cell: Cells, t: float, width: float, u: Array) -> bool:
    signs = []
    for s, side in ((t - width, 1.0), (t + width, -1.0)):
        q0 = expansion(Slabs(np.zeros(1, int), np.array([s]), np.zeros(1), cell)).q[0]
        lo, hi = along(cell.chart, thin(u[None]) - q0)
        signs.append(lo[0] > 0.0 if side > 0.0 else hi[0] < 0.0)
    room = Slabs(np.zeros(1, int), np.array([t]), np.array([width]), cell)
    x = room.offset[:, None]
    off = thin(u[None]) - expansion(room).over(Ends(-x, x))[0]
    return bool(all(signs) and (off.magnitude() <= cell.radius).all())


def _events(cells: Cells, path: Path) -> list[Gap]:
    """That every listed event lies in the tube, in order, and that none is a branch point."""
    gaps, last = [], -np.inf
    for event in path.events:
        place = _place(cells, event)
        s = event.arclength
        if place is None:
            gaps.append(Gap(s, s, f"the event {event.name!r} does not lie on the curve"))
        elif event.kind is Kind.BRANCH_POINT:
            gaps.append(Gap(s, s, "a branch point is listed where the curve is smooth"))
        elif place < last - 2.0 * OVERHANG:
            gaps.append(Gap(s, s, f"the event {event.name!r} is out of order"))
        last = last if place is None else max(last, place)
    return gaps


# --- the end ----------------------------------------------------------------------------------------------


def _end(
    engine: Engine, cells: Cells, at: Nodes, path: Path, homotopy: Any
) -> tuple[str, Array | None, list[Gap]]:
    """What is proved of the end: where the path reached its target, a point of the curve exactly there."""
    last = cells.take(slice(-1, None))
    s = float(path.arclength[-1])
    whole = last.place[0, 1] == s and (last.end[0] == path.steps[-1].u).all()
    if path.status is not Status.REACHED_TARGET or not whole:
        if not at.proved[-1]:
            return "", None, [Gap(s, s, "no point of the curve was found at the end")]
        return "The end is a point of the curve.", None, []
    chart = np.zeros_like(last.chart)
    chart[0, -1] = 1.0
    there = nodes(engine, last, 1.0, chart)
    if there.proved.all() and (reach(last, 1.0, there.radius) <= last.radius).all():
        lam = float(last.end[0, -1])
        return f"The end lies on it, exactly at lam = {lam:g}.", there.radius[0], []
    return "", None, [Gap(s, s, "no point of the curve was found at the target")]
