"""Where a path may end on an arc or ahead of it: the target, ends that are singular, the start. What that makes of the
path is decided in `continuation.step.verdict`.
"""

from __future__ import annotations

from enum import Enum

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import dot, largest
from continuation.correctors.base import far_from_round_off
from continuation.ends.closed_curve import passes_start
from continuation.ends.endgame import RELATIVE_FLOOR, Endgame, SingularLimit, touching
from continuation.ends.landing import SINGULAR_SHARE, crossing, regular
from continuation.evaluation.evaluator import EvaluationError
from continuation.metric import norm, share
from continuation.point.arc import Arc, cut
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction, SupportsSegment
from continuation.rejection import Rejected
from continuation.status import Kind
from continuation.step.state import State
from continuation.step.stepper import Stepper

ENDGAME = 1e-2
"""How near to the target, as a fraction of the whole way, a singular end is looked for."""

RETRY_ENDGAME = 0.05
"""What must be left of the way, since the endgame was last tried in vain, for it to be tried again: two samples."""

FOLD = 0.4, 0.8
"""Where lam - value ~ sigma^w, the ratio of lam's way to the tangent's is 1/w: between these it is a simple fold."""


END_KNOWN_TO = 1e-5
"""An end known to less than this, in the metric of the path, is none: an exponential decay looks like a fold, too. The
cube root of round-off is what is left of an end where three sheets meet."""


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
    attempt arrived. `limit`: Set where the end is singular.
    """

    arc: Arc
    at: EndsAt = EndsAt.NOTHING
    kind: int = Kind.REGULAR
    whole: bool = True
    limit: SingularLimit | None = None


@frozen(eq=False)
class Target:
    """The target of a trace and the ways to end on it, or on the start, other than by a step of its own."""

    stepper: Stepper
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

    @property
    def solver(self) -> PathSolver:
        """That of the trace."""
        return self.stepper.solver

    # -- before a step ----------------------------------------------------------------------------------------

    def fold_at_target(self, point: Linearization, prediction: Prediction) -> SingularLimit | None:
        """The end where a series sees the parameter touch its target in a fold: a half-power end, found as a fold.

        The far side of the fold lies outside the domain of an interior homotopy, but the formulas mostly do not mind;
        where they do, the endgame is still there.
        """
        if self.target is None or not hasattr(prediction, "segment"):
            return None
        assert isinstance(prediction, SupportsSegment)
        fold = touching(prediction, point, self.target)
        if fold is None:
            return None
        far = min(2.0 * fold, prediction.reach)
        beyond = evolve(self.stepper, solver=evolve(self.solver, max_step=None)).attempt(point, prediction, far)
        if isinstance(beyond, Rejected):
            return None
        arc = Arc(point, beyond.point, point.border, prediction.segment(far, beyond.point.u))
        try:
            end = crossing(self.solver, arc, self.target)
            return None if end is None else self._limit(arc, end, self.target)
        except EvaluationError:
            return None

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
            return Endgame(self.solver, self.target).limit(point)
        except EvaluationError:
            return None

    # -- after a step -----------------------------------------------------------------------------------------

    def ending_of_arc(self, arc: Arc, state: State) -> ArcEnd:
        """Where the path ends on an accepted arc: at the target, at its own start, or beyond the start's parameter."""
        ends = []
        if self.target is not None:
            ends.append((self.target, Kind.TARGET, EndsAt.TARGET))
            if self.may_turn_back:
                ends.append((float(state.origin.u[-1]), Kind.REGULAR, EndsAt.START_PARAMETER))
        for value, kind, at in ends:
            point = crossing(self.solver, arc, value)
            if point is not None:
                limit = self._limit(arc, point, value) if at is EndsAt.TARGET else None
                u = np.append(point.u[:-1], value) if limit is None else limit.u
                if limit is None and at is EndsAt.TARGET and far_from_round_off(self.solver.evaluator, u):
                    raise EvaluationError("the equations do not hold where the path would take the target's value")
                return ArcEnd(cut(arc, evolve(point, u=u)), at, kind, False, limit)
        origin = state.origin
        if passes_start(self.solver, origin, arc):
            return ArcEnd(cut(arc, evolve(arc.b, u=origin.u, tangent=origin.tangent)), EndsAt.START, whole=False)
        return ArcEnd(arc)

    def _limit(self, arc: Arc, end: Linearization, value: float) -> SingularLimit | None:
        """The end of the arc where it is singular; None where it is regular, or a fold about which no more can be said.

        In a simple fold the end is known to round-off. Where the parameter stands still to a higher order it is known
        to a root of round-off only, and the endgame says more. Which it is, is seen from the beginning of the arc.
        """
        endgame = Endgame(self.solver, value)
        if share(end.weights, end.tangent) > SINGULAR_SHARE:
            if regular(self.solver, end, arc.a):
                return None
            limit = endgame.limit(arc.a)
            if limit is None:
                raise EvaluationError("the end is singular, and its limit was not found")
            return limit
        sigma = dot(arc.border, end.u - arc.a.u)
        gap, expected = abs(arc.a.lam - value), abs(sigma * arc.a.tangent[-1])
        fold = None
        if (arc.a.lam - value) * (arc.b.lam - value) >= 0.0 and FOLD[0] * expected < gap < FOLD[1] * expected:
            # y ~ y* + c sqrt(lam - value), with c as at the beginning of the arc.
            left, way = (abs(end.lam - value) / gap) ** 0.5, np.append(arc.a.y - end.y, 0.0)
            u = np.append(end.u[:-1], value)
            fold = SingularLimit(u, left * largest(way), 2, left * norm(end.weights, way))
            if fold.length <= RELATIVE_FLOOR:
                return fold
        limit = endgame.limit(arc.a)
        found = fold if limit is None or (fold is not None and fold.length <= limit.length) else limit
        if found is not None and found.length > END_KNOWN_TO:
            raise EvaluationError("the parameter stands still near the target, and no limit was found there")
        return found
