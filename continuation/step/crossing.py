"""Eigenvalues of H' along an arc, and the branch point where one changes sign.

Let z(t) be an eigenvalue of M_a^-1 M(t), with the bordered matrices at the beginning of an arc and at parameter t. The
arc is *regular*, crossed by no branch, if no real z changes by more than SPAN between samples, and no outer of three
samples add up to more than SPAN times the middle one. It *crosses* a branch if one z vanishes like 1 - t / s at a
branch point s and no other z is near zero. Other arcs are too long, off the path, or have a `degenerate` point.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from attrs import Factory, define, evolve, field, frozen

from continuation.arrays import SIX_DIGITS, Array, dot, generic_vector, largest
from continuation.correctors.base import far_from_round_off
from continuation.evaluation.errors import EvaluationError
from continuation.events.eigenvalues import EIGENVALUE_ACCURACY, changes, multiplicity
from continuation.events.singularity import branch_point_near, scales
from continuation.metric import norm
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.point.segment import CUBIC
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection
from continuation.step.degenerate import FARTHEST, SIMPLE_ORDER, Z_ROUND_OFF, BranchPointOnArc, degenerate_point
from continuation.step.stepper import Arrival

SPAN = 3.0
"""Largest ratio of a real eigenvalue at two samples. If a parabola touches zero, the outer of three samples add up to
four times the middle one or more."""

LOWEST, MOST = 1.0 - SPAN, 1.0 - 1.0 / SPAN
"""These limits for I - M_a^-1 M(t)."""

TOLD = 0.25
"""Least reported change of an eigenvalue."""

ONWARD = 0.1
"""Extra sample beyond an arc that approaches a singular matrix, in arc lengths: if H' recovers there, a singular point
lies on the arc."""

HALF, EIGHTHS = (0.5, 1.0), tuple(k / 8 for k in range(1, 9))
"""Sample parameters on a cubic, and on a longer series."""

NEAR_ARC = 2e-2
"""Largest distance of a branch point from its arc, in arc lengths: five arc errors."""

ON_PATH = 8 * float(np.finfo(float).eps)
"""Largest round-off residual relative to the rows of H'. True crossings had at most 3e-16; 1e-13 joined curves 2e-6
apart."""

NEAR_CROSSING = 0.1
"""Least distance of an arc's end from a crossing, in arc lengths: nearer, factors are nearly singular."""

STEP_BACK = 0.7
"""Factor of a step that ended near a crossing; limit for one that shall end behind it."""

BEST = 4.0 / 3.0
"""Best step over a crossing, relative to its distance: balances the cubic's error x^4 and the branches' distance x -
1."""

SMALLEST = 2.0**-6
"""Least part of an arc searched for pairs of crossings, and least factor of a step: nearer ones may be round-off."""


@frozen(eq=False)
class Crossed:
    """A branch point on an arc. `rays`, shape (4, N + 1): unit vectors back, onward, and along the other branch; None
    if H' loses several ranks.
    """

    point: Linearization
    rays: Array | None


def on_arc(
    solver: PathSolver, arc: Arc, attempt: Arrival, prediction: Prediction, flipped: bool, ends: bool, index: int
) -> Crossed | Rejected | None:
    """Return the branch point on an arc, None without one, or a rejection.

    `attempt`: the step; the arc may be only its first part. `flipped`: the determinant changes sign. `ends`: the path
    ends with the arc. `index`: the step's; varies start vectors.
    """
    looks = _Looks(solver, arc, attempt, prediction, flipped, ends, index)
    seen = looks.first()
    if isinstance(seen, Rejected) and not flipped and looks.blurred():
        return None
    if seen is None and flipped and _differential(solver, arc.b.u) is None:
        # The sign alone shows a branch point, or an arc off the path.
        seen = looks.simple(arc.segment.at(0.5))
        looks.told.clear()
    if isinstance(seen, BranchPointOnArc):
        return looks.over(seen)
    return looks.rejected(Rejection.ORIENTATION, 0.5) if seen is None and flipped else seen


def between(solver: PathSolver, point: Linearization, u: Array) -> bool:
    """Whether an eigenvalue of H' has another sign at u."""
    apply, start = _differential(solver, u), generic_vector(u.size)
    if apply is None:
        return False
    values, _ = changes(point, apply, point.border, 1.0 + EIGENVALUE_ACCURACY, -np.inf, start)
    return bool(values)


def _differential(solver: PathSolver, u: Array) -> Callable[[Array], Array] | None:
    try:
        return solver.evaluator.differential(u)
    except EvaluationError:
        return None


@define(eq=False)
class _Looks:
    """Samples of the eigenvalues of H' along one arc.

    `told`: large changes 1 - z, by parameter. `along`: sum of the last eigenvectors, added to start vectors.
    """

    solver: PathSolver
    arc: Arc
    attempt: Arrival
    prediction: Prediction
    flipped: bool
    ends: bool
    index: int
    told: dict[float, list[float]] = field(factory=dict, init=False)
    along: Array = field(default=Factory(lambda looks: np.zeros_like(looks.arc.a.u), takes_self=True), init=False)

    def look(self, u: Array, t: float, accuracy: float = EIGENVALUE_ACCURACY) -> list[float]:
        """Eigenvalues of I - M_a^-1 M(t) above TOLD or below LOWEST, ascending; `u`: the point near parameter t."""
        apply, size = _differential(self.solver, u), u.size
        if apply is None:
            return []
        whole, first = generic_vector(size), (self.index + len(self.told)) % size
        # A start vector may have no part along an eigenvector.
        start = np.concatenate((whole[first:], whole[:first]))
        start = start / math.sqrt(dot(start, start)) + self.along
        values, vectors = changes(self.arc.a, apply, self._border(t), TOLD, LOWEST, start, accuracy)
        if values:
            self.along = vectors.sum(axis=1)
        return values

    def _border(self, t: float) -> Array:
        tangent, weights = self.arc.segment.derivative(t), self.arc.a.weights
        border: Array = weights * tangent / norm(weights, tangent)
        return border

    def _point(self, t: float) -> Array:
        return self.prediction(t * self.arc.length)

    def first(self) -> BranchPointOnArc | Rejected | None:
        """The first branch point; None on a regular arc."""
        arc, told = self.arc, self.told
        found, before, left = None, 0.0, [1.0]
        cubic = len(arc.segment.inside) <= CUBIC
        for t in HALF if cubic else EIGHTHS:
            told[t] = there = self.look(self._point(t) if t < 1.0 else arc.b.u, t)
            left.append(1.0 - max([0.0, *there]))
            least = 0.0 if self.ends and t == 1.0 else left[-2] / SPAN
            if left[-1] < least and found is None:
                if len(there) > 1 and 1.0 < there[0] < (1.0 - NEAR_CROSSING) * there[-1]:
                    # Several vanish: no arc so long counts.
                    return self._too_long(t / there[-1], before)
                found = self._branch_point(t, t / there[-1])
                # At the arc's end z may vanish beyond.
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
                onward = self.look(arc.segment.at(1.0 + ONWARD), 1.0)
                if 1.0 - max([TOLD, *onward]) > (1.0 + ONWARD) * left[-1]:
                    return self.rejected(Rejection.ORIENTATION, 0.5)
            threes = zip(told, left, left[1:], left[2:])
            for t in [t for t, first, between, last in threes if first + last > SPAN * between][:1]:
                found = self._branch_point(t, t)
        return found

    def _nearer(self) -> list[float]:
        """Sample toward the beginning as long as an eigenvalue grows, as before a pair of crossings."""
        told, places = self.told, list[float]()
        t = min((place for place, there in told.items() if there and there[0] < LOWEST), default=0.0)
        while t > SMALLEST and told[t] and told[t][0] < LOWEST:
            t *= 0.5
            for place in (t, 0.5 * t):
                if place not in told:
                    told[place] = self.look(self._point(place), place)
                places.append(place)
        return places

    def over(self, seen: BranchPointOnArc) -> Crossed | Rejected | None:
        """The branch point, if the arc follows its branch over it; None if the arc ends before."""
        arc, told = self.arc, self.told
        s = position(arc, seen.u) / arc.length
        # A branch point at the end is known to half of the digits.
        if self.ends and abs(s - 1.0) <= SIX_DIGITS:
            return None
        if not self.ends and abs(s - 1.0) < NEAR_CROSSING:
            return self.rejected(Rejection.AT_CROSSING, STEP_BACK)
        if self.flipped != (s < 1.0 and seen.odd):
            over = BEST * s
            return self.rejected(Rejection.OTHER_BRANCH, over if over < STEP_BACK else STEP_BACK * min(s, 1.0))
        if not all(_as_expected(mu, seen.expected(t, s), seen.lost) for t, mu in told.items()):
            return self._too_long(s)
        if s > 1.0:
            return None
        tangent = arc.segment.derivative(s)
        rays = None if seen.simple is None else seen.simple.rays(tangent, arc.a.weights)
        onward = tangent / norm(arc.a.weights, tangent) if rays is None else rays[1]
        return Crossed(evolve(arc.a, u=seen.u, tangent=onward), rays)

    def _too_long(self, s: float, least: float = 0.0) -> Rejected:
        """An arc on which others vanish behind s must end before them."""
        others = [t / mu for t, there in self.told.items() for mu in there if t > (s + NEAR_CROSSING) * mu > 0.0]
        behind = (1.0 - NEAR_CROSSING) ** 2 * min(others, default=0.0)
        step = min(BEST * s, behind) if behind * (1.0 - NEAR_CROSSING) > s else STEP_BACK * s
        return self.rejected(Rejection.CROSSINGS, min(max(step, least), STEP_BACK))

    def rejected(self, reason: Rejection, factor: float) -> Rejected:
        attempt = self.attempt
        factor = max(factor * self.arc.length / attempt.h, SMALLEST)
        return Rejected(attempt.h, reason, contraction=attempt.correction.contraction, factor=factor)

    def blurred(self) -> bool:
        """Whether round-off changes z even at the beginning, as near poles."""
        a = self.arc.a
        blur = self.solver.noise_by_component(a) * np.sign(generic_vector(a.u.size))
        # The factorisation may be of a point nearby: eigenvalues differ from one already.
        seen = [(min([LOWEST, *told]), max([TOLD, *told])) for told in (self.look(u, 0.0) for u in (a.u, a.u + blur))]
        return any(abs(p - q) > TOLD for p, q in zip(*seen))

    def _branch_point(self, t: float, place: float) -> BranchPointOnArc | None:
        """The branch point indicated at t: simple, near `place`, or degenerate."""
        solver, arc = self.solver, self.arc
        lost = self._lost(self._point(t), t)
        found = self.simple(self._point(place)) if lost == 1 else None
        if found is None:

            def z_at(there: float, v: Array) -> float:
                seen = self.look(v, min(there, 1.0), Z_ROUND_OFF)
                return 1.0 - min(seen, key=lambda mu: abs(mu - 1.0), default=np.nan)

            at = degenerate_point(solver, arc, self.prediction, t, z_at, lost)
            if at is None or not self._vanishes(at[0], self._units()[1]):
                return None
            u, order = at
            t = min(position(arc, u) / arc.length, 1.0)
            if lost == 1 and order <= SIMPLE_ORDER and (lost := self._lost(u, t)) == 1:
                return None
            found = BranchPointOnArc(u, order=order, lost=lost)
        return found

    def _lost(self, u: Array, t: float) -> int:
        apply, told = _differential(self.solver, u), self.look(u, t, Z_ROUND_OFF)
        if apply is None or not told or told[-1] <= 0.0:
            return 1
        return max(multiplicity(self.arc.a, apply, self._border(t), 1.0 / told[-1]), 1)

    def _units(self) -> tuple[Array, Array]:
        a, b = self.arc.a, self.arc.b
        return scales(self.solver.evaluator, 1.0 / np.sqrt(a.weights), (a.u, b.u))

    def _vanishes(self, u: Array, rows: Array) -> bool:
        evaluator = self.solver.evaluator
        return largest(evaluator.residual(u) / rows) <= ON_PATH or not far_from_round_off(evaluator, u)

    def simple(self, guess: Array) -> BranchPointOnArc | None:
        """Simple branch point near the arc, by Newton's method."""
        arc, a = self.arc, self.arc.a
        try:
            units = self._units()
            found = branch_point_near(self.solver.evaluator, guess, arc.b.u - a.u, a.weights, units)
            if found is None or not self._vanishes(found.u, units[1]):
                return None
        except EvaluationError:
            return None
        length = norm(a.weights, arc.b.u - a.u)
        at = position(arc, found.u) / arc.length
        off = norm(a.weights, found.u - arc.segment.at(at))
        return (
            BranchPointOnArc(found.u, found)
            if 0.0 < at < FARTHEST and off <= NEAR_ARC * max(at**4, 1.0) * length
            else None
        )


def _as_expected(told: list[float], expected: float, lost: int) -> bool:
    """Whether `lost` eigenvalues vanish as expected, and no other is near zero."""
    first, *others = sorted(told, key=lambda mu: abs(mu - expected)) or [min(expected, TOLD)]
    others = [mu for k, mu in enumerate(others, 1) if k >= lost or abs(mu - first) > NEAR_CROSSING * abs(first)]
    near = abs(first - expected) <= MOST * abs(1.0 - expected) + EIGENVALUE_ACCURACY * expected
    return near and all(mu < 1.0 - NEAR_CROSSING for mu in others)
