"""Possible ends of a path."""

from __future__ import annotations

from enum import Enum

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array, generic_vector, largest
from continuation.ends.closed_curve import passes_start
from continuation.ends.divergence import QUADRATIC_STEPS
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
"""Relative distance to the target at which a singular end is sought."""

RETRY_ENDGAME = 0.05
"""Share of the distance of the last failed endgame at which another is tried: two samples."""

CONDITIONED = 0.1
"""Share of the path by which round-off may move an end: near an asymptote any point satisfies H."""

NEAR_ENOUGH = 30.0
"""Error bound, in tolerances, up to which no limit is needed."""

VANISHING_SHARE = 1e-18
"""Parameter's share of the tangent that is zero, the square of round-off."""


class EndsAt(Enum):
    """Ways to end."""

    NOTHING = "it goes on"
    TARGET = "the target"
    EVENT = "a terminal event"
    START = "its own start, in the same direction"
    KINK = "a kink, and goes on behind it if a branch leaves there"
    START_PARAMETER = "the start's parameter value, at another point"


@frozen(eq=False)
class ArcEnd:
    """An accepted arc, cut where the path ends.

    `kind`: of the end. `whole`: not cut. `limit`: a singular end. `error`: bound of its components.
    """

    arc: Arc
    at: EndsAt = EndsAt.NOTHING
    kind: int = Kind.REGULAR
    whole: bool = True
    limit: SingularLimit | None = None
    error: float | None = None


@frozen(eq=False)
class Target:
    """The target of a trace, and its other ends."""

    solver: PathSolver
    target: float | None

    @property
    def interior(self) -> bool:
        """Whether the path stays inside a domain.

        H' may lose rank on its boundary, where the target mostly lies; beyond the start's parameter H has no meaning.
        """
        return self.solver.max_step is not None

    def endgame_is_due(self, point: Linearization, state: State) -> bool:
        """Whether to seek a singular end: the target is near (much nearer after a failure), and a landing failed or the
        path is interior.
        """
        if self.target is None or state.index == 0:
            return False
        gap, whole = point.lam - self.target, float(state.origin.u[-1]) - self.target
        near = abs(gap) <= ENDGAME * abs(whole) and gap * point.tangent[-1] < 0.0
        failed = state.last_failed_landing == point.lam or self.interior
        return near and failed and abs(gap) <= RETRY_ENDGAME * abs(state.last_failed_endgame - self.target)

    def endgame(self, point: Linearization) -> SingularLimit | None:
        """The limit at the target."""
        assert self.target is not None
        try:
            return self._placed(Endgame(self.solver, self.target).limit(point), point)
        except EvaluationError:
            return None

    def ending_of_arc(self, arc: Arc, state: State, landed: bool = False) -> ArcEnd:
        """The arc, cut at the path's end; `landed`: the arc was made to end on the target."""
        ends = []
        if self.target is not None:
            ends.append((self.target, Kind.TARGET, EndsAt.TARGET))
            if self.interior:
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
        """The end at a parameter value, an error bound, and the limit if singular.

        If round-off (`off_by`) exceeds the tolerance, the endgame is tried. `EvaluationError` if both fail.
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
        evaluator = self.solver.evaluator
        unit = np.append(np.zeros_like(end.y), 1.0)
        u = np.append(end.y, value)
        r = evaluator.residual(u)
        try:
            for _ in range(QUADRATIC_STEPS):
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
        """Add to a limit's error how far, as H can tell, the singular point may be from the target.

        Between `point` and the limit y changes like c |lam - target|^(1/w).
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
    """How far each component of an end can move before H exceeds round-off, shape (N + 1,).

    The end moves along the tangent, and along solutions of `near` for two samples of round-off with random signs, until
    H is twice its allowed size.
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
