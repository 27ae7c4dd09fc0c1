"""A walk recorded as a `Path`."""

from __future__ import annotations

import math
import time

import numpy as np
from attrs import define, field

from continuation.arrays import Array, largest
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.kinks.pivots import ZERO_COMPONENT
from continuation.path import LocatedEvent, Step
from continuation.status import Kind, Status
from problems.lcp.parametric.basis import SingularBasisError
from problems.lcp.parametric.ties import Corner, turn
from problems.lcp.parametric.walk import FLAT, Walk


@define(eq=False)
class Trail:
    """A path in the making.

    `units` are scales of x and t, `ways` the directions in which points are left; `kinks` maps a point's number to
    name, pairs and rays, of which the second is its way.
    """

    units: Array
    points: list[Array] = field(factory=list)
    ways: list[Array] = field(factory=list)
    kinks: dict[int, tuple[str, tuple[int, ...], Array]] = field(factory=dict)

    def follow(self, walk: Walk, last: float, budget: Budget) -> tuple[Status, str]:
        """Follow a walk to t = `last`; return its status and a sentence."""
        began = time.perf_counter()
        corner: Corner | None = None
        t = walk.t
        while True:
            try:
                inside = walk.locate()
            except SingularBasisError:
                return _no_way(t)
            if not inside:
                return Status.UNRESOLVED_KINK, "Rounding has led off the path: its last piece does not hold its end."
            if corner is not None and len(corner.switches) > 1:
                walk.snap(corner.switches)
            u, direction = walk.u * self.units
            if walk.still:
                direction[-1] = 0.0
            length = math.sqrt(float(direction @ direction))
            unit = direction / length
            self._add(u, unit, corner)
            if corner is not None and len(corner.switches) > 1 and self._goes_round(u, unit):
                return Status.UNRESOLVED_KINK, (
                    f"The path is back at a kink, t = {walk.t:g}, and goes round from here: other rays leave its kinks."
                )
            step = walk.next_corner()
            to_last = math.nan if walk.still else (last - walk.t) / walk.dt
            if not walk.still and _arrives(walk, last, to_last, step):
                self._end(to_last * length, last)
                return Status.REACHED_TARGET, str(Status.REACHED_TARGET)
            if len(self.points) > 1 and self._closes(step * length):
                return Status.CLOSED, str(Status.CLOSED)
            if math.isinf(step):
                return self._leave(walk, length, last)
            spent = budget.spent(Counts(accepted=len(self.points)), time.perf_counter() - began)
            if spent:
                return Status.BUDGET_EXHAUSTED, f"The budget is used up ({spent}) at t = {walk.t:g}."
            t = walk.t if walk.still else walk.t + step * walk.dt
            corner = turn(walk, step)
            if corner is None:
                return _no_way(t)
            if corner.dead:
                self._end(step * length, t)
                self.kinks[len(self.points) - 1] = "dead end", corner.switches, -unit[None]
                return Status.DEAD_END, str(Status.DEAD_END)

    def steps(self, residuals: Array) -> tuple[list[Step], list[LocatedEvent]]:
        """The points as steps, with `residuals`, and the kinks."""
        gaps = [0.0, *(math.sqrt(float(gap @ gap)) for gap in np.diff(self.points, axis=0))]
        tangents = [self.ways[0], *self.ways]
        arcs, last = np.cumsum(gaps).tolist(), len(self.points) - 1
        kinds = [Kind.KINK if k in self.kinks else Kind.TARGET if k == last else Kind.REGULAR for k in range(last + 1)]
        kinds[0] = Kind.START
        steps = [
            Step(k, u, tangent, arcs[k], gaps[k], residual_norm=residual, kind=kinds[k])
            for k, (u, tangent, residual) in enumerate(zip(self.points, tangents, residuals.tolist()))
        ]
        events = [
            LocatedEvent(
                name, Kind.KINK, arcs[k], steps[k].u, steps[k].tangent, steps[k].residual_norm, 0.0, 0, k, True,
                switches, rays,
            )
            for k, (name, switches, rays) in self.kinks.items()
        ]  # fmt: skip
        return steps, events

    def _add(self, u: Array, unit: Array, corner: Corner | None) -> None:
        # A kink's first ray leads back, its second on.
        if corner is not None:
            back = -self.ways[-1]
            found = [_unit(one * self.units) for one in corner.directions]
            others = [one for one in found if not (_same(one, back) or _same(one, unit))]
            turned = unit[-1] * next((way[-1] for way in reversed(self.ways) if way[-1] != 0.0), 0.0) < 0.0
            name = "branching kink" if others else "turning kink" if turned else "kink"
            self.kinks[len(self.points)] = name, corner.switches, np.array([back, unit, *others])
        self.points.append(u)
        self.ways.append(unit)

    def _end(self, length: float, t: float) -> None:
        u = self.points[-1] + length * self.ways[-1]
        u[-1] = t
        self.points.append(u)

    def _leave(self, walk: Walk, length: float, last: float) -> tuple[Status, str]:
        far = 1.0 + largest(walk.u[0]) if walk.still else 2.0 * (abs(walk.t) + 1.0) / abs(walk.dt)
        self._end(far * length, walk.t if walk.still else walk.t + far * walk.dt)
        if math.isinf(last) and not walk.still and walk.dt * last > 0.0:
            return Status.REACHED_TARGET, "The path goes along a ray to its end at infinity."
        where = "stands still" if walk.still else f"goes to {math.copysign(math.inf, walk.dt)}"
        return Status.DIVERGED, f"The path ends on a ray on which x grows without bound and t {where}."

    def _goes_round(self, u: Array, unit: Array) -> bool:
        """Whether the path left this kink of several pairs in this direction before."""
        size = ZERO_COMPONENT * (1.0 + largest(u))
        last = len(self.points) - 1
        several = (k for k, (_, pairs, _) in self.kinks.items() if len(pairs) > 1 and k < last)
        return any(largest(u - self.points[k]) <= size and _same(unit, self.ways[k]) for k in several)

    def _closes(self, length: float) -> bool:
        """Whether the path returns to its first point before the next corner."""
        first, last, unit = self.points[0], self.points[-1], self.ways[-1]
        # Mostly t alone rules this out.
        if unit[-1] != 0.0 and not 0.0 < (first[-1] - last[-1]) / unit[-1] <= 2.0 * length:
            return False
        gap = first - last
        ahead = float(gap @ unit)
        if not 0.0 < ahead <= length * (1.0 + ZERO_COMPONENT) or not _same(unit, self.ways[0]):
            return False
        if largest(gap - ahead * unit) > ZERO_COMPONENT * (1.0 + largest(first)):
            return False
        self.points.append(first)
        return True


def _arrives(walk: Walk, last: float, to_last: float, step: float) -> bool:
    if math.isinf(last) or math.isinf(step):
        return 0.0 <= to_last < math.inf
    off = abs(walk.t + step * walk.dt - last)
    return 0.0 <= to_last <= step or off <= FLAT * max(abs(walk.t), abs(last), abs(step * walk.dt))


def _no_way(t: float) -> tuple[Status, str]:
    return Status.UNRESOLVED_KINK, f"No way on was found from the corner at t = {t:g}."


def _unit(a: Array) -> Array:
    unit: Array = a / np.linalg.norm(a)
    return unit


def _same(a: Array, b: Array) -> bool:
    return largest(a - b) <= ZERO_COMPONENT
