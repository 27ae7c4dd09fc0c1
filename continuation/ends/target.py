"""Where a path may end on an arc or ahead of it: the target, ends that are singular, the start. What that makes of the
path is decided in `continuation.step.verdict`.
"""

from __future__ import annotations

from enum import Enum

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array, generic_vector, largest
from continuation.ends.closed_curve import passes_start
from continuation.ends.endgame import Endgame, SingularLimit
from continuation.ends.landing import SINGULAR_SHARE, crossing
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.noise import allowed_along
from continuation.metric import norm, share
from continuation.point.arc import Arc, cut
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.status import Kind
from continuation.step.state import State

ENDGAME = 1e-2
"""How near to the target, as a fraction of the whole way, a singular end is looked for."""

RETRY_ENDGAME = 0.05
"""What must be left of the way, since the endgame was last tried in vain, for it to be tried again: two samples."""

CONDITIONED = 0.1
"""An end that round-off may move by so much of the path is none: an asymptote satisfies any equation, in the end."""

NEAR_ENOUGH = 30.0
"""A bound of so many tolerances is no reason to look for a limit: noise decides what components are measured by."""

VANISHING_SHARE = 1e-18
"""Share of the parameter in the tangent that the square of round-off may leave of none."""

END_CORRECTIONS = 4
"""Increments of Newton's method at the target: what was located there is within the reach of quadratic convergence."""


class EndsAt(Enum):
    """What a path may end on."""

    NOTHING = "it goes on"
    TARGET = "the target"
    EVENT = "a terminal event"
    START = "its own start, in the same direction"
    KINK = "a kink, and goes on behind it if a branch leaves there"
    START_PARAMETER = "the start's parameter value, at another point"


@frozen(eq=False)
class ArcEnd:
    """An accepted arc, cut where the path ends on it if it does.

    `kind`: Of the arc's last point, one of `Kind`. `whole`: Whether the arc's last point is the one at which the
    attempt arrived. `limit`: Set where the end is singular. `error`: A bound of what the target's components are off.
    """

    arc: Arc
    at: EndsAt = EndsAt.NOTHING
    kind: int = Kind.REGULAR
    whole: bool = True
    limit: SingularLimit | None = None
    error: float | None = None


@frozen(eq=False)
class Target:
    """The target of a trace and the ways to end on it, or on the start, other than by a step of its own."""

    solver: PathSolver
    target: float | None

    # A homotopy with `max_step` has a domain, and its target mostly lies on the boundary. Three decisions follow, each
    # for a reason of its own: these two, and `Landing.lands_from_afar`.

    @property
    def expects_singular_end(self) -> bool:
        """Whether the endgame is tried before any landing has failed: on the boundary H' may lose its rank."""
        return self.solver.max_step is not None

    @property
    def may_turn_back(self) -> bool:
        """Whether the start's parameter value is an end: beyond it such a homotopy has no meaning."""
        return self.solver.max_step is not None

    # -- before a step ----------------------------------------------------------------------------------------

    def endgame_is_due(self, point: Linearization, state: State) -> bool:
        """Whether the path is so near the target that a singular end is to be looked for.

        An interior path creeps towards a singular end on its boundary; any path may have failed to land. Asked for
        again only when the parameter has come nearer by a good factor.
        """
        if self.target is None or state.index == 0:
            return False
        gap, whole = point.lam - self.target, float(state.origin.u[-1]) - self.target
        near = abs(gap) <= ENDGAME * abs(whole) and gap * point.tangent[-1] < 0.0
        failed = state.last_failed_landing == point.lam or self.expects_singular_end
        return near and failed and abs(gap) <= RETRY_ENDGAME * abs(state.last_failed_endgame - self.target)

    def endgame(self, point: Linearization) -> SingularLimit | None:
        """The limit at the target by the endgame."""
        assert self.target is not None
        try:
            return self._placed(Endgame(self.solver, self.target).limit(point), point)
        except EvaluationError:
            return None

    # -- after a step -----------------------------------------------------------------------------------------

    def ending_of_arc(self, arc: Arc, state: State, landed: bool = False) -> ArcEnd:
        """Where the path ends on an accepted arc: at the target, at its own start, or beyond the start's parameter.

        `landed`: Whether the arc was made to end on the target.
        """
        ends = []
        if self.target is not None:
            ends.append((self.target, Kind.TARGET, EndsAt.TARGET))
            if self.may_turn_back:
                ends.append((float(state.origin.u[-1]), Kind.REGULAR, EndsAt.START_PARAMETER))
        for value, kind, at in ends:
            point = arc.b if landed else crossing(self.solver, arc, value)
            if point is None:
                continue
            if at is EndsAt.START_PARAMETER:
                end = evolve(point, u=np.append(point.y, value))
                return ArcEnd(cut(arc, end), at, kind, False)
            u, error, limit = self._limit(arc, point, value)
            whole = landed and np.array_equal(u, point.u)
            return ArcEnd(arc if whole else cut(arc, evolve(point, u=u)), at, kind, whole, limit, error)
        origin = state.origin
        if passes_start(self.solver, origin, arc):
            return ArcEnd(cut(arc, evolve(arc.b, u=origin.u, tangent=origin.tangent)), EndsAt.START, whole=False)
        return ArcEnd(arc)

    def _limit(self, arc: Arc, end: Linearization, value: float) -> tuple[Array, float, SingularLimit | None]:
        """The end of the arc at a parameter value, a bound of its error, and the limit if it is singular.

        Newton's method at the value brings a point near a fold to round-off; how far it may be moved there without
        leaving round-off is the bound. An end that is not known to the tolerance by that may be a limit that is: a
        fold, or what the endgame finds. Raises `EvaluationError` where neither is known beside the path.
        """
        evaluator, weights = self.solver.evaluator, end.weights
        vanishing = share(weights, end.tangent)
        u = self._at_value(end, value) if vanishing <= SINGULAR_SHARE else np.append(end.y, value)
        off = off_by(evaluator, end, u)
        known, enough = norm(weights, off), NEAR_ENOUGH * self.solver.tolerance.relative
        if known <= enough and vanishing > VANISHING_SHARE:
            return u, largest(off), None
        limit = self._placed(Endgame(self.solver, value).limit(arc.a), arc.a)
        if limit is not None and limit.length <= max(known, enough):
            return limit.u, limit.error, limit
        if not known <= CONDITIONED:
            raise EvaluationError("round-off may move the end by as much as the path, and no limit was found there")
        return u, largest(off), None

    def _at_value(self, end: Linearization, value: float) -> Array:
        """The point at the value, with Newton's increments there for as long as they reduce the residual."""
        evaluator = self.solver.evaluator
        unit = np.zeros_like(end.u)
        unit[-1] = 1.0
        u = np.append(end.y, value)
        r = evaluator.residual(u)
        try:
            for _ in range(END_CORRECTIONS):
                there = linearize(evaluator, u, end.weights, end.border)
                nearer = u + there.solve(-r, 0.0, unit)
                nearer[-1] = value
                left = evaluator.residual(nearer)
                if not largest(left) < largest(r):
                    break
                u, r = nearer, left
        except EvaluationError:
            pass
        return u

    def _placed(self, limit: SingularLimit | None, point: Linearization) -> SingularLimit | None:
        """A limit with what it errs by because the singular point may lie beside the target, as far as H can tell.

        `point`: On the path before it. There y has come by c |lam - target|^(1/w).
        """
        if limit is None or limit.winding_number == 1:
            return limit
        evaluator, target = self.solver.evaluator, float(limit.u[-1])
        r = evaluator.residual(limit.u)
        beside = abs(float(point.solve(np.abs(r) + evaluator.round_off(limit.u, r))[-1])) + float(
            np.spacing(abs(target))
        )
        left, way = (beside / abs(point.lam - target)) ** (1.0 / limit.winding_number), point.u - limit.u
        way[-1] = 0.0
        error, length = limit.error + left * largest(way), limit.length + left * norm(point.weights, way)
        return evolve(limit, error=error, length=length)


def off_by(evaluator: Evaluator, near: Linearization, u: Array) -> Array:
    """How far each component of an end may be off at its parameter: how far H stays round-off of its own terms.

    Along what the factorisation of `near` makes of that round-off in two samples of its signs, and along the tangent:
    as far as H, evaluated there, is no more than twice what it may be. That holds near folds and where more ranks are
    lost, too; more than any path where nothing ends it.
    """
    r = evaluator.residual(u)
    allowed = np.abs(r) + evaluator.round_off(u, r)
    v = near.tangent.copy()
    v[-1] = 0.0
    ways = [v]
    if near.tangent[-1] != 0.0:
        for signs in (np.sign(generic_vector(r.size)), 1.0):
            z = near.solve(signs * allowed)
            ways.append(z - z[-1] / near.tangent[-1] * near.tangent)
            ways[-1][-1] = 0.0

    off = np.spacing(np.abs(u))
    off[-1] = 0.0
    for way in ways:
        reach = 1.0
        for side in (way, -way) if way.any() else ():
            reach = allowed_along(evaluator.residual, u, side, 2.0 * allowed, reach or 1.0)
            off = np.maximum(off, reach * np.abs(side))
    return off
