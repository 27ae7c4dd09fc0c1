"""A walk written down as a `Path`: its corners as steps and kinks, and how it ended."""

from __future__ import annotations

import math
import time

import numpy as np
from attrs import define, field

from continuation.arrays import Array, largest
from continuation.budget import Budget
from continuation.path import LocatedEvent, Path, Step
from continuation.status import Kind, Status
from problems.lcp.data.problem import State
from problems.lcp.parametric.basis import SingularBasisError
from problems.lcp.parametric.walk import Corner, Left, Walk

SAME = 1e-9
"""Two unit directions, or two points relative to their size, that differ by less are the same."""

ARRIVED = 1e-13
"""A corner as near as this to the t where the path ends, relative to both and to the step, is on it."""


@define(eq=False)
class Trail:
    """A path while it is made.

    Attributes
    ----------
    path : Path
    rows, columns : Array of shape (n,)
        The units of a row's residual, and of x.
    """

    path: Path
    rows: Array
    columns: Array
    _corner: Corner | None = field(default=None, init=False)
    _unit: Array | None = field(default=None, init=False)
    _sign: float = field(default=0.0, init=False)

    def follow(self, walk: Walk, last: float, budget: Budget) -> tuple[Status, str]:
        """Follow a walk to its end; what that was, and a sentence.

        Parameters
        ----------
        walk : Walk
        last : float
            The t at which it ends.
        budget : Budget
        """
        began = time.perf_counter()
        walk.row_units = self.rows
        while True:
            if not _located(walk):
                return (
                    Status.UNRESOLVED_KINK,
                    "Rounding has led off the path: its last piece does not hold its last point.",
                )
            if self._corner is not None and len(self._corner.switches) > 1:
                walk.snap(self._corner.switches)
            direction = np.append(self.columns * walk.dx, 0.0 if walk.still else walk.dt)
            length = math.sqrt(float(direction @ direction))
            unit = direction / length
            self._add(np.append(self.columns * walk.x, walk.t), unit, walk.off)
            left, step = walk.next_corner()
            moving = not walk.still
            to_last = (last - walk.t) / walk.dt if moving else math.nan
            if moving and _arrives(walk, last, to_last, step):
                self._end(unit, to_last * length, last)
                return Status.REACHED_TARGET, str(Status.REACHED_TARGET)
            if len(self.path) > 1 and self._closes(unit, step * length):
                return Status.CLOSED, str(Status.CLOSED)
            if left is Left.RAY:
                far = 2.0 * (abs(walk.t) + 1.0) / abs(walk.dt) if moving else 1.0 + largest(walk.x)
                self._end(unit, far * length, walk.t + (far * walk.dt if moving else 0.0))
                if math.isinf(last) and moving and walk.dt * last > 0.0:
                    return Status.REACHED_TARGET, "The path goes along a ray to its end at infinity."
                where = "stands still" if not moving else f"goes to {math.copysign(math.inf, walk.dt)}"
                return Status.DIVERGED, f"The path ends on a ray on which x grows without bound and t {where}."
            self.path.counts.accepted = len(self.path)
            spent = budget.spent(self.path.counts, time.perf_counter() - began)
            if spent:
                return Status.BUDGET_EXHAUSTED, f"The budget is used up ({spent}) at t = {walk.t:g}."
            try:
                corner = walk.turn()
            except SingularBasisError:
                corner = None
            if corner is None:
                return (
                    Status.UNRESOLVED_KINK,
                    f"No way on was found from the corner at t = {walk.t + step * walk.dt:g}.",
                )
            self._corner = corner
            if corner.dead:
                self._end(unit, step * length, walk.t + step * (0.0 if walk.still else walk.dt), Kind.KINK)
                self._kink("dead end", corner, -unit[None])
                return Status.DEAD_END, str(Status.DEAD_END)

    def _add(self, u: Array, unit: Array, residual: float) -> None:
        steps, corner = self.path.steps, self._corner
        kind = Kind.START if corner is None else Kind.KINK
        before = steps[-1] if steps else None
        gap = 0.0 if before is None else u - before.u
        length = math.sqrt(float(np.dot(gap, gap)))
        arclength = length if before is None else before.arclength + length
        # At a kink the tangent is that of the arrival, as the engine's is; the first ray leads back, the second on.
        arrival = unit if self._unit is None else self._unit
        steps.append(Step(len(steps), u, arrival, arclength, length, residual_norm=residual, kind=kind))
        if corner is not None:
            found = [_unit(np.append(self.columns * one[:-1], one[-1])) for one in corner.directions]
            others = [one for one in found if not (_same(one, -arrival) or _same(one, unit))]
            turned = unit[-1] * self._sign < 0.0
            name = "branching kink" if others else "turning kink" if turned else "kink"
            self._kink(name, corner, np.array([-arrival, unit, *others]))
        self._unit = unit
        if unit[-1] != 0.0:
            self._sign = float(np.sign(unit[-1]))

    def _kink(self, name: str, corner: Corner, rays: Array) -> None:
        at = self.path.endpoint
        self.path.events.append(
            LocatedEvent(
                name, Kind.KINK, at.arclength, at.u, at.tangent, at.residual_norm, 0.0, 0, at.index, True,
                corner.switches, rays,
            )
        )  # fmt: skip

    def _end(self, unit: Array, length: float, t: float, kind: Kind = Kind.TARGET) -> None:
        last = self.path.steps[-1]
        u = last.u + length * unit
        u[-1] = t
        self.path.steps.append(
            Step(
                len(self.path),
                u,
                unit,
                last.arclength + length,
                length,
                residual_norm=last.residual_norm,
                kind=kind,
            )
        )

    def _closes(self, unit: Array, length: float) -> bool:
        """Whether the path comes back to its first point before the next corner; it ends there then."""
        first, last = self.path.steps[0], self.path.steps[-1]
        # Mostly t alone tells that it is not there.
        if unit[-1] != 0.0 and not 0.0 < (first.u[-1] - last.u[-1]) / unit[-1] <= 2.0 * length:
            return False
        gap = first.u - last.u
        ahead = float(gap @ unit)
        size = 1.0 + largest(first.u)
        if not 0.0 < ahead <= length * (1.0 + SAME) or largest(gap - ahead * unit) > SAME * size:
            return False
        if not _same(unit, first.tangent):
            return False
        self.path.steps.append(
            Step(len(self.path), first.u, unit, last.arclength + ahead, ahead, residual_norm=first.residual_norm)
        )
        return True


def state_at(walk: Walk, last: float, most: int) -> State | None:
    """The pieces of the point where t is `last`, by a walk of so many corners at most; None where it leads elsewhere.

    Parameters
    ----------
    walk : Walk
    last : float
    most : int
    """
    for _ in range(most):
        if not _located(walk):
            return None
        left, step = walk.next_corner()
        if not walk.still and _arrives(walk, last, (last - walk.t) / walk.dt, step):
            return walk.state
        if left is Left.RAY:
            return None
        try:
            if walk.turn() is None:
                return None
        except SingularBasisError:
            return None
    return None


def _arrives(walk: Walk, last: float, to_last: float, step: float) -> bool:
    """Whether t is where the path ends before the next corner, or on it."""
    if math.isinf(last) or math.isinf(step):
        return 0.0 <= to_last < math.inf
    off = abs(walk.t + step * walk.dt - last)
    return 0.0 <= to_last <= step or off <= ARRIVED * max(abs(walk.t), abs(last), abs(step * walk.dt))


def _unit(a: Array) -> Array:
    unit: Array = a / np.linalg.norm(a)
    return unit


def _same(a: Array, b: Array) -> bool:
    return largest(a - b) <= SAME


def _located(walk: Walk) -> bool:
    """Solve for the corner; once more with the inverse afresh where it is not within its limits."""
    walk.locate()
    if walk.inside():
        return True
    try:
        walk.basis.invert()
    except SingularBasisError:
        return False
    walk.locate()
    return walk.inside()
