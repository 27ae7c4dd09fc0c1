"""What lies on an arc before it counts: the eigenvalues of H' along it, and the branch point where one changes sign.

Let M_a be the bordered matrix factored at the beginning of an arc, M(t) that at its point t, and z(t) the eigenvalues
of M_a^-1 M(t). M(t) is singular where one of them is zero. An arc is *regular* if no real z falls to less than 1/SPAN
from one look to the next, none grows by more than SPAN, and of three looks in a row z at the first and the last add up
to at most SPAN times that between them, where of a parabola that touches zero it is four times: no branch crosses it,
and both its ends lie on one branch. An arc *crosses* a branch if one real z(t) goes through zero at a simple branch
point s about as 1 - t / s does, or at a degenerate one as a power of that (`degenerate_point`), and no other comes to
zero. Any other arc is too long, or no part of the path.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from attrs import define, evolve, field, frozen

from continuation.arrays import Array, dot, generic_vector, largest
from continuation.correctors.base import far_from_round_off
from continuation.evaluation.errors import EvaluationError
from continuation.events.crossing import EIGENVALUE_ACCURACY, SAME, changes, multiplicity
from continuation.events.singularity import branch_point_near, row_sizes
from continuation.metric import norm
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.point.segment import CUBIC
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection
from continuation.step.degenerate import SIMPLE_ORDER, Z_ROUND_OFF, BranchPointOnArc, degenerate_point
from continuation.step.stepper import Arrival

SPAN = 3.0
"""How far a real eigenvalue of M_a^-1 M(t) may change from one look to the next on an arc that counts as regular. Two
crossings that are passed at once leave no sign; but of a parabola that touches zero between three looks the values at
the first and the last add up to four times the one between them, or more."""

LOWEST, MOST = 1.0 - SPAN, 1.0 - 1.0 / SPAN
"""The same for eigenvalues of I - M_a^-1 M(t)."""

TOLD = 0.25
"""The least change that is told."""

ONWARD = 0.1
"""A look so far behind the end of an arc, in its lengths, along which H' comes nearer to singular. If it becomes more
regular there by more than that part, it was singular on the arc, as the branch sees it on which the arc ends."""

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
"""The factor of a step that arrived so near to a crossing, and the largest of one that is to end behind it."""

BEST = 4.0 / 3.0
"""A step over a crossing at s that ends at x s is off by x^4 there, as a cubic is, and the branches are x - 1 apart:
here the first is least beside the second."""

SMALLEST = 2.0**-6
"""Of an arc: nearer to its beginning no pair of crossings is looked for, of which it would be the second in a row; and
the least factor of a step, since a place next to the beginning may be round-off, and would end the path at once."""

AT_END = 1e-6
"""Of an arc: so near to its end a crossing is at the end, which is known there to half of the digits only."""


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


def on_arc(
    solver: PathSolver, arc: Arc, attempt: Arrival, prediction: Prediction, flipped: bool, ends: bool, index: int
) -> Crossed | Rejected | None:
    """The branch point on an arc; None where none is; or why the arc does not count, and which step to try.

    Parameters
    ----------
    solver : PathSolver
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
    looks = _Looks(solver, arc, attempt, prediction, flipped, ends, index)
    seen = looks.first()
    if isinstance(seen, Rejected) and not flipped and looks.blurred():
        return None
    if seen is None and flipped and _differential(solver, arc.b.u) is None:
        # Of factorisations alone the sign is all that is known: it changes at a branch point, or the arc is none.
        seen = looks.simple(arc.segment.at(0.5))
        looks.told.clear()
    if isinstance(seen, BranchPointOnArc):
        return looks.over(seen)
    return looks.rejected(Rejection.ORIENTATION, 0.5) if seen is None and flipped else seen


def between(solver: PathSolver, point: Linearization, u: Array) -> bool:
    """Whether H' has an eigenvalue of another sign at u than at a point."""
    apply, start = _differential(solver, u), generic_vector(u.size)
    if apply is None:
        return False
    values, _ = changes(point, apply, point.border, 1.0 + EIGENVALUE_ACCURACY, -np.inf, start)
    return bool(values)


def _differential(solver: PathSolver, u: Array) -> Callable[[Array], Array] | None:
    """The map v -> H' v at a point; None where there is none, as beyond the edge of a domain."""
    try:
        return solver.evaluator.differential(u)
    except EvaluationError:
        return None


@define(eq=False)
class _Looks:
    """Looks at H' along one arc.

    `told`: By place, the real 1 - z that are not as on a regular arc, in order. `along`: The sum of the eigenvectors of
    the last look that told any: the next one begins with these, and cannot overlook where their eigenvalues have gone.
    """

    solver: PathSolver
    arc: Arc
    attempt: Arrival
    prediction: Prediction
    flipped: bool
    ends: bool
    index: int
    told: dict[float, list[float]] = field(factory=dict, init=False)
    along: Array = field(init=False)

    @along.default
    def _none(self) -> Array:
        return np.zeros(self.arc.a.u.size)

    def look(self, u: Array, t: float, accuracy: float = EIGENVALUE_ACCURACY) -> list[float]:
        """What is told at a point, which lies about at t; nothing where H' is not to be had."""
        apply, size = _differential(self.solver, u), u.size
        if apply is None:
            return []
        whole, first = generic_vector(size), (self.index + len(self.told)) % size
        # Each look with another first vector: one in a thousand has next to no part along an eigenvector.
        start = np.concatenate((whole[first:], whole[:first]))
        start = start / math.sqrt(dot(start, start)) + self.along
        values, vectors = changes(self.arc.a, apply, self._border(t), TOLD, LOWEST, start, accuracy)
        if values:
            self.along = vectors.sum(axis=1)
        return values

    def _border(self, t: float) -> Array:
        """The arc's tangent at t, in the dual metric."""
        tangent, weights = self.arc.segment.derivative(t), self.arc.a.weights
        border: Array = weights * tangent / norm(weights, tangent)
        return border

    def _point(self, t: float) -> Array:
        return self.prediction(t * self.arc.length)

    def first(self) -> BranchPointOnArc | Rejected | None:
        """The first branch point that the eigenvalues along the arc lead to; None on a regular arc."""
        arc, told = self.arc, self.told
        found, before, left = None, 0.0, [1.0]
        cubic = len(arc.segment.inside) <= CUBIC
        for t in HALF if cubic else EIGHTHS:
            told[t] = there = self.look(self._point(t) if t < 1.0 else arc.b.u, t)
            left.append(1.0 - max([0.0, *there]))
            # Where the path ends with the arc, only what lies on it counts.
            least = 0.0 if self.ends and t == 1.0 else left[-2] / SPAN
            if left[-1] < least and found is None:
                found = self._branch_point(t, t / there[-1])
                # What comes near to singular at the end, and goes straight, may do so behind it.
                if found is None and (t < 1.0 or there[-1] >= 1.0 - EIGENVALUE_ACCURACY):
                    shorter = min(0.8 * t * MOST / there[-1], STEP_BACK)
                    return self.rejected(Rejection.ORIENTATION, max(before, shorter))
            before = t
        nearer = self._nearer()
        if found is None and any(told.values()):
            if near := [place for place in nearer if told[place] and told[place][-1] > MOST]:
                t = near[0]
                return self._branch_point(t, t / told[t][-1]) or self.rejected(Rejection.CROSSINGS, t)
            if cubic and left[-1] < 1.0 - TOLD:
                # What a series is made of is seen on it already.
                onward = self.look(arc.segment.at(1.0 + ONWARD), 1.0)
                if 1.0 - max([TOLD, *onward]) > (1.0 + ONWARD) * left[-1]:
                    return self.rejected(Rejection.ORIENTATION, 0.5)
            threes = zip(told, left, left[1:], left[2:])
            for t in [t for t, first, between, last in threes if first + last > SPAN * between][:1]:
                found = self._branch_point(t, t)
        return found

    def _nearer(self) -> list[float]:
        """Looks nearer to the beginning of an arc along which H' becomes more regular; their places.

        A pair of crossings there leaves the eigenvalue larger than SPAN farther on: each half of the arc is looked at
        as a whole one would be, until it is not larger any more.
        """
        t, places, told = 1.0, list[float](), self.told
        while told[t] and told[t][0] < LOWEST and t > SMALLEST:
            t *= 0.5
            for place in (t, 0.5 * t):
                if place not in told:
                    told[place] = self.look(self._point(place), place)
                places.append(place)
        return places

    def over(self, seen: BranchPointOnArc) -> Crossed | Rejected | None:
        """The branch point that was found, if the arc goes over it on its own branch; None if it ends before it."""
        arc, told = self.arc, self.told
        s = position(arc, seen.u) / arc.length
        if self.ends and 1.0 < s <= 1.0 + AT_END:
            return None
        if not self.ends and abs(s - 1.0) < NEAR_CROSSING:
            return self.rejected(Rejection.AT_CROSSING, STEP_BACK)
        if self.flipped != (s < 1.0 and seen.odd):
            # Over a crossing the arc's end is on the other branch, or before it beyond another one.
            over = BEST * s
            return self.rejected(Rejection.OTHER_BRANCH, over if over < STEP_BACK else STEP_BACK * min(s, 1.0))
        if not (seen.alone and all(_as_expected(mu, seen.expected(t, s), seen.lost) for t, mu in told.items())):
            others = [t / mu for t, there in told.items() for mu in there if t > (s + NEAR_CROSSING) * mu > 0.0]
            # Another eigenvalue may fall so far, and no farther, where the arc is to end behind this crossing.
            behind = (1.0 - NEAR_CROSSING) ** 2 * min(others, default=0.0)
            step = min(BEST * s, behind) if behind * (1.0 - NEAR_CROSSING) > s else STEP_BACK * s
            return self.rejected(Rejection.CROSSINGS, min(step, STEP_BACK))
        if s > 1.0:
            return None
        tangent = arc.segment.derivative(s)
        rays = None if seen.simple is None else seen.simple.rays(tangent, arc.a.weights)
        onward = tangent / norm(arc.a.weights, tangent) if rays is None else rays[1]
        return Crossed(evolve(arc.a, u=seen.u, tangent=onward), rays)

    def rejected(self, reason: Rejection, factor: float) -> Rejected:
        """An arc that does not count; the next attempt goes a factor of its length, which may be part of a step."""
        attempt = self.attempt
        factor = max(factor * self.arc.length / attempt.h, SMALLEST)
        return Rejected(attempt.h, reason, contraction=attempt.correction.contraction, factor=factor)

    def blurred(self) -> bool:
        """Whether no z can be told: within the tolerance of the arc's beginning, where all are one, some are not.

        So it is on the way to a pole, where components vanish beside the others.
        """
        a = self.arc.a
        blur = self.solver.tolerance.relative / np.sqrt(a.weights)
        return bool(self.look(a.u + blur * generic_vector(a.u.size), 0.0))

    def _branch_point(self, t: float, place: float) -> BranchPointOnArc | None:
        """The branch point to which a look at t leads: a simple one about at a place, or a degenerate one."""
        solver, arc = self.solver, self.arc
        lost = self._lost(self._point(t), t)
        found = self.simple(self._point(place)) if lost == 1 else None
        if found is None:

            def z_at(there: float, v: Array) -> float:
                seen = self.look(v, min(there, 1.0), Z_ROUND_OFF)
                return 1.0 - min(seen, key=lambda mu: abs(mu - 1.0), default=np.nan)

            at = degenerate_point(solver, arc, self.prediction, t, z_at, lost)
            if at is None or not self._vanishes(at[0], self._rows()):
                return None
            u, order = at
            t = min(position(arc, u) / arc.length, 1.0)
            if lost == 1 and order <= SIMPLE_ORDER and (lost := self._lost(u, t)) == 1:
                return None
            others = [mu for mu in self.look(u, t, Z_ROUND_OFF) if abs(mu - 1.0) > SAME] if lost > 1 else []
            alone = not any(abs(mu - 1.0) <= NEAR_CROSSING for mu in others)
            found = BranchPointOnArc(u, order=order, lost=lost, alone=alone)
        return found

    def _lost(self, u: Array, t: float) -> int:
        """How many eigenvalues are as the smallest z that is told at a point about t."""
        apply, told = _differential(self.solver, u), self.look(u, t, Z_ROUND_OFF)
        if apply is None or not told:
            return 1
        return max(multiplicity(self.arc.a, apply, self._border(t), 1.0 / told[-1]), 1)

    def _rows(self) -> Array:
        """What the rows of H' are made of over the arc."""
        a, b = self.arc.a, self.arc.b
        return row_sizes(self.solver.evaluator, 1.0 / np.sqrt(a.weights), (a.u, b.u))

    def _vanishes(self, u: Array, rows: Array) -> bool:
        """Whether H at a point is no more than round-off."""
        evaluator = self.solver.evaluator
        return largest(evaluator.residual(u) / rows) <= ON_PATH or not far_from_round_off(evaluator, u)

    def simple(self, guess: Array) -> BranchPointOnArc | None:
        """The simple branch point on or ahead of the arc that Newton's method finds from a guess."""
        arc, a = self.arc, self.arc.a
        try:
            rows = self._rows()
            found = branch_point_near(self.solver.evaluator, guess, arc.b.u - a.u, a.weights, rows)
            if found is None or not self._vanishes(found.u, rows):
                return None
        except EvaluationError:
            return None
        length = norm(a.weights, arc.b.u - a.u)
        at = position(arc, found.u) / arc.length
        off = norm(a.weights, found.u - arc.segment.at(at))
        return (
            BranchPointOnArc(found.u, found)
            if 0.0 < at < AHEAD and off <= NEAR_ARC * max(at**4, 1.0) * length
            else None
        )


def _as_expected(told: list[float], expected: float, lost: int) -> bool:
    """Whether the changes told at a place are those of eigenvalues that vanish together as expected, and no other."""
    first, *others = sorted(told, key=lambda mu: abs(mu - expected)) or [min(expected, TOLD)]
    others = [mu for k, mu in enumerate(others, 1) if k >= lost or abs(mu - first) > NEAR_CROSSING * abs(first)]
    near = abs(first - expected) <= MOST * abs(1.0 - expected) + EIGENVALUE_ACCURACY * expected
    return near and all(mu < 1.0 - NEAR_CROSSING for mu in others)
