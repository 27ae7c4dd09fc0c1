"""What lies on an arc before it counts: the eigenvalues of H' along it, and the branch point where one changes sign.

Let M_a be the bordered matrix factored at the beginning of an arc, M(t) the one at its point t, and z(t) the eigenvalues
of M_a^-1 M(t). M(t) is singular where one of them is zero, and real ones alone can pass zero one at a time. An arc is
*regular* if every real z(t) lies between 1/RANGE and RANGE: then no branch crosses it, and both ends lie on one branch.
An arc *crosses* a branch if one real eigenvalue goes through zero where a simple branch point is found, s, as
1 - t / s does, and all others are as on a regular arc. Any other arc is too long, or no part of the path.
"""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array, largest
from continuation.correctors.base import far_from_round_off
from continuation.evaluation.evaluator import EvaluationError
from continuation.events.crossing import EIGENVALUE_ACCURACY, changes, multiplicity
from continuation.events.singularity import SimpleBranchPoint, branch_point_near, row_sizes
from continuation.metric import norm
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.point.segment import CUBIC
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection
from continuation.step.stepper import Arrival

RANGE = 2.5
"""How far a real eigenvalue of M_a^-1 M(t) may change on an arc that counts as regular, either way. Two crossings that
are passed at once leave no sign; if the eigenvalue is a parabola in t, their middle m leaves it in this range half way
for m = .19 to .31 only, and at the end for m = .39 to .61 only: one of the two always shows them (any RANGE up to 4)."""

HALF, EIGHTHS = (0.5, 1.0), tuple(k / 8 for k in range(1, 9))
"""Where on an arc the eigenvalues are told: on a cubic, and on a series, whose steps reach over more."""

NEAR_ARC = 2e-2
"""How far from the arc a branch point on it may lie, in its lengths: five times what an arc may be off the path."""

ON_PATH = 8 * float(np.finfo(float).eps)
"""Of the rows of H' over the arc: so little of H is round-off, also where all that H is made of vanishes at the point.
At true crossings at most 3e-16 was seen; with 1e-13 curves 2e-6 apart were said to cross."""

AHEAD = 3.0
"""So far ahead, in arcs, a branch point that is found is believed: the next arc has it on its first two thirds."""

NEAR_CROSSING = 0.1
"""An arc does not end so near to a crossing, in its lengths: the factors there have a part ten times too small, and the
next arc would begin with that."""

STEP_BACK = 0.7
"""The factor of a step that arrived so near to a crossing."""

AT_END = 1e-6
"""Of an arc: so near to its end a crossing is at the end, which is known there to half of the digits only."""

PASSES, PLACE_ON_ARC = 60, 1e-12
"""A point where H' loses several ranks is no regular zero of a system of ours: its place on the arc is iterated, to the
second of an arc, each time by a part of what was off."""

SHORTEST = 0.1
"""The least factor of a step: a place next to the arc's beginning may be round-off, and would end the path at once."""


@frozen(eq=False)
class Crossed:
    """A branch point on an arc.

    Attributes
    ----------
    point : Linearization
        Of the path; the factorisation is that of the arc's beginning.
    rays : ndarray, shape (4, N + 1), or None
        The directions of the branches that meet there, of unit length in the metric, each pointing away from it: back,
        onward, and both of the other branch. None where H' loses several ranks at once: they are not known then.
    """

    point: Linearization
    rays: Array | None


@frozen(eq=False)
class Crossings:
    """Looks for them, with the parts it needs."""

    solver: PathSolver

    def on_arc(
        self, arc: Arc, attempt: Arrival, prediction: Prediction, flipped: bool, ends: bool, index: int
    ) -> Crossed | Rejected | None:
        """The branch point on an arc; None where none is; or why the arc does not count, and which step to try.

        Parameters
        ----------
        arc : Arc
        attempt : Arrival
            Where the arc, or the one of which it is a part, ends.
        prediction : Prediction
            Of the arc.
        flipped : bool
            Whether the determinant's sign changes from its beginning to its end.
        ends : bool
            Whether the path ends where the arc does: what lies beyond does not count.
        index : int
            Of the step: each looks at H' with another first vector.
        """
        told = self._told(arc, ends, index)
        places = sorted(t / mu for t, found in told.items() for mu in found if mu > 0.0)
        if not any(told.values()):
            return _rejected(attempt, Rejection.ORIENTATION, 0.5) if flipped else None
        found = None
        for place in places[:1]:
            found = self._found(arc, prediction(place * arc.length))
        if found is None:
            negative = sum(mu > 1.0 for mu in told.get(1.0, ()))
            if negative and flipped != bool(negative % 2):
                lost = self._multiple(arc, places[0])
                if lost > 1 and flipped == bool(lost % 2):
                    return self._together(arc, prediction, places[0])
            if ends and not flipped and (not places or places[0] > 1.0):
                return None
            worst = max(max(mu / (1.0 - 1.0 / RANGE), mu / (1.0 - RANGE)) for there in told.values() for mu in there)
            return _rejected(attempt, Rejection.ORIENTATION, 0.8 / worst)
        s = position(arc, found.u) / arc.length
        if ends and s > 1.0:
            return None if s <= 1.0 + AT_END or not flipped else _rejected(attempt, Rejection.ORIENTATION, 0.5)
        if not ends and abs(s - 1.0) < NEAR_CROSSING:
            return _rejected(attempt, Rejection.AT_CROSSING, STEP_BACK)
        if flipped != (s < 1.0):
            # Over a crossing the arc's end is on the other branch, or before it beyond another one.
            return _rejected(attempt, Rejection.OTHER_BRANCH, 2.0 * s if s < 0.4 else 0.5 * min(s, 1.0))
        if not all(_as_expected(t, there, s) for t, there in told.items()):
            others = [place for place in places if place > s + NEAR_CROSSING]
            return _rejected(attempt, Rejection.CROSSINGS, 0.5 * (s + min(others, default=1.0)) if s < 1.0 else 0.5)
        if s > 1.0:
            return None
        rays = found.rays(arc.segment.derivative(s), arc.a.weights)
        return Crossed(evolve(arc.a, u=found.u, tangent=rays[1]), rays)

    def _told(self, arc: Arc, ends: bool, index: int) -> dict[float, list[float]]:
        """At some points of the arc the real 1 - z that are not as on a regular one."""
        least, most = 1.0 - RANGE, 1.0 if ends else 1.0 - 1.0 / RANGE
        told: dict[float, list[float]] = {}
        for k, t in enumerate(HALF if len(arc.segment.inside) <= CUBIC else EIGHTHS):
            u, border = (arc.segment.at(t), arc.a.border) if t < 1.0 else (arc.b.u, arc.b.border)
            if (apply := self.solver.evaluator.differential(u)) is None:
                break
            told[t] = changes(arc.a, apply, border, most, least, turned=index + k)
        return told

    def _multiple(self, arc: Arc, place: float) -> int:
        """How many ranks H' loses where it does so first, as it is seen from the arc's beginning."""
        if (apply := self.solver.evaluator.differential(arc.b.u)) is None:
            return 1
        return multiplicity(arc.a, apply, arc.b.border, place)

    def _together(self, arc: Arc, prediction: Prediction, t: float) -> Crossed | Rejected:
        """Several crossings in one place: a point where H' loses several ranks.

        Which branch goes on is not asked there: the path passes if the determinant's sign agrees with their number, and
        the prediction was good, as it is along a branch that symmetry keeps.
        """
        moved, u = np.inf, arc.a.u
        for _ in range(PASSES):
            u, _ = self.solver.project(arc.a, prediction(t * arc.length), arc.a.border)
            if (apply := self.solver.evaluator.differential(u)) is None:
                break
            found = changes(arc.a, apply, arc.a.border, 0.5, -np.inf, accuracy=PLACE_ON_ARC)
            if not found:
                break
            before, t = t, t / min(found, key=lambda mu: abs(mu - 1.0))
            last, moved = moved, abs(t - before)
            # What no longer falls is round-off, which is more than that where zero is far away.
            if moved <= PLACE_ON_ARC or moved >= last:
                break
        tangent = arc.segment.derivative(t)
        return Crossed(evolve(arc.a, u=u, tangent=tangent / norm(arc.a.weights, tangent)), None)

    def _found(self, arc: Arc, guess: Array) -> SimpleBranchPoint | None:
        """The simple branch point on or ahead of the arc that Newton's method finds from a guess."""
        a, evaluator = arc.a, self.solver.evaluator
        try:
            rows = row_sizes(evaluator, 1.0 / np.sqrt(a.weights), (a.u, arc.b.u))
            found = branch_point_near(evaluator, guess, arc.b.u - a.u, a.weights, rows)
            if found is None or (
                largest(evaluator.residual(found.u) / rows) > ON_PATH and far_from_round_off(evaluator, found.u)
            ):
                return None
        except EvaluationError:
            return None
        length = norm(a.weights, arc.b.u - a.u)
        at = position(arc, found.u) / arc.length
        off = norm(a.weights, found.u - arc.segment.at(at))
        return found if 0.0 < at < AHEAD and off <= NEAR_ARC * max(at**4, 1.0) * length else None


def _as_expected(t: float, told: list[float], s: float) -> bool:
    """Whether the changes told at t are that of one eigenvalue which vanishes at s, and no other."""
    expected, least, most = t / s, 1.0 - RANGE, 1.0 - 1.0 / RANGE
    nearest = min(told, key=lambda mu: abs(mu - expected), default=min(max(expected, least), most))
    allowed = most * abs(1.0 - expected) + 2.0 * EIGENVALUE_ACCURACY * expected
    return len(told) <= 1 and abs(nearest - expected) <= allowed


def _rejected(attempt: Arrival, reason: Rejection, factor: float) -> Rejected:
    return Rejected(attempt.h, reason, contraction=attempt.correction.contraction, factor=max(factor, SHORTEST))
