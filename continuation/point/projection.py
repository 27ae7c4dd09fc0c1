"""Correction of points onto the path, to round-off."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from attrs import Factory, define, evolve, field

from continuation.arrays import EPS, SIX_DIGITS, Array, dot, generic_vector
from continuation.contraction import Contraction, Iteration, updated
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import POINT_ULPS, Evaluator
from continuation.evaluation.noise import NOISE_LOOKS
from continuation.metric import norm
from continuation.point.arc import Arc
from continuation.point.linearization import REFINED, Anchor, Linearization, relinearize
from continuation.point.segment import PolynomialSegment
from continuation.tolerance import Tolerance

MaxStep = Callable[[Array, Array], float]

ARC_PLACES = 0.31, 0.77
"""Places where arc and path are compared; no symmetry of an S-bend or cubic relates them."""

LATE = 0.93
"""Another place for series: the end correction, a power of t, hides an S behind the others (2 of 1,500 S-bends)."""

SLACK = 0.004
"""Largest distance of arc and path, in arc lengths: that of a cubic that turns by one radian."""

MISSED, EVEN = 0.07, 1.5e-4
"""MISSED: a smooth arc errs by a small share of its prediction's error (1/64 for an extrapolated cubic), an arc over an
S by as much. EVEN: smaller errors, in arc lengths, are ignored; S-bends of a thousandth of the path still show in steps
of a third."""

ARC_NOISE = 1e2
"""Least allowed distance, in tolerances, as short arcs are noisy."""

CHORD_STEPS = Contraction()

SMALL_INCREMENT = 1e-4
"""Increment, in tolerances, accepted where round-off stops the iteration; 1 after a second factorisation: a third
helped 19 of 465 times."""


@define(eq=False)
class PathSolver:
    """Puts points of one homotopy on its path.

    `tolerance`: raised at the start for noise in H. `max_step`: how far an interior path may go in a direction. `room`:
    how far a straight path without a target goes to its end.
    """

    evaluator: Evaluator
    tolerance: Tolerance
    max_step: MaxStep | None = None
    room: MaxStep | None = None
    asked: float = field(default=Factory(lambda solver: solver.tolerance.relative, takes_self=True), init=False)

    def noisy(self, least: float) -> None:
        """Raise the tolerance to the `least` that noise allows."""
        self.tolerance = evolve(self.tolerance, relative=max(self.asked, least))

    @property
    def noted(self) -> str:
        """A sentence about noise."""
        least = self.tolerance.relative
        return f" The residual is noisy: the tolerance was raised to {least:.0e}." if least > self.asked else ""

    def project(self, near: Linearization, guess: Array, border: Array) -> tuple[Array, Anchor]:
        """Bring a guess onto the path in the hyperplane orthogonal to `border`; return the point and the factorisation
        used.

        The nearby factorisation serves while increments halve, then new ones. Raises `EvaluationError` if all fail.
        """
        evaluator = self.evaluator
        settled = self.settled(near, guess, border)
        if settled is not None:
            return settled, near.anchor
        u = guess
        for enough in (SMALL_INCREMENT, *5 * (1.0,)):
            system = evaluator.factor(u, border)
            settled = self._chord_steps(u, partial(system.approximate, rho=0.0), near, enough)
            if settled is not None:
                return settled, Anchor(u, border, system)
            u = u + system.solve(-evaluator.residual(u), 0.0)
        raise EvaluationError("a point of the path could not be settled")

    def settled(self, near: Linearization, guess: Array, border: Array) -> Array | None:
        """`project` by the nearby factorisation; None if it fails."""
        return self._chord_steps(guess, lambda r: near.approximate(r, 0.0, border), near, SMALL_INCREMENT)

    def _chord_steps(
        self, guess: Array, solve: Callable[[Array], Array], near: Linearization, enough: float
    ) -> Array | None:
        """Chord steps while increments halve; the point if the last is within `enough`, or round-off."""
        chord, residual, measure = Iteration(guess, CHORD_STEPS), self.evaluator.residual, self.tolerance.measure
        increments: list[tuple[Array, Array]] = []
        while chord.count < CHORD_STEPS.iterations:
            step = updated(increments, solve(-residual(chord.x)), near.weights)
            size = measure(step, near.weights)
            if not chord.add(step, size):
                break
            if chord.error <= SIX_DIGITS:
                return chord.x
        # A stalled increment is the difference of two round-offs.
        last = chord.size * min(chord.ratio, 1.0)
        if chord.size <= enough or (last <= 1.0 and last <= 2.0 * self.noise(near) / self.tolerance.relative):
            return chord.x
        return None

    def noise(self, near: Linearization) -> float:
        """Round-off of a correction, in the metric."""
        return norm(near.weights, self.noise_by_component(near))

    def noise_by_component(self, near: Linearization) -> Array:
        """Round-off of a correction by component, shape (N + 1,).

        A point a few ulps away is corrected; the difference is round-off.
        """
        evaluator, u = self.evaluator, near.u
        last_place = np.maximum(np.spacing(np.abs(u)), EPS / np.sqrt(near.weights * u.size))
        moved = POINT_ULPS * last_place * np.sign(generic_vector(u.size))
        try:
            back = near.solve(evaluator.residual(u + moved) - evaluator.residual(u))
        except EvaluationError:
            return last_place
        left = back - moved + near.tangent * dot(near.border, moved)
        noise: Array = NOISE_LOOKS * np.abs(left) + last_place
        return noise

    def tangent_noise(self, point: Linearization) -> Array:
        """Round-off of a tangent by component, shape (N + 1,): what its refinement and another correction leave."""
        noise: Array = REFINED / np.sqrt(point.weights)
        apply = self.evaluator.differential(point.u)
        if apply is not None:
            noise = noise + NOISE_LOOKS * np.abs(point.approximate(-apply(point.tangent)))
        return noise

    def project_and_linearize(
        self, near: Linearization, guess: Array, border: Array, along: Array | None = None
    ) -> Linearization:
        """Project `guess` and linearise; an approximate direction `along` saves solves."""
        u, anchor = self.project(near, guess, border)
        return relinearize(self.evaluator, u, near.weights, anchor, border, guess=along)


def arc_on_path(solver: PathSolver, arc: Arc, distance: float) -> Arc | None:
    """The arc if it is near the path; None if it joins branches or misses an S.

    A residual and a solve estimate the error at each place; a cubic with these errors becomes the guide. `distance`:
    the prediction's error, in the metric.
    """
    a, segment, weights = arc.a, arc.segment, arc.a.weights
    length = norm(weights, arc.b.u - a.u)
    noise = ARC_NOISE * solver.tolerance.relative
    allowed = max(min(SLACK * length, max(EVEN * length, MISSED * distance)), noise)
    is_cubic, off = isinstance(segment, PolynomialSegment), list[Array]()
    for t in ARC_PLACES if is_cubic else (*ARC_PLACES, LATE):
        off.append(a.approximate(-solver.evaluator.residual(segment.at(t))))
        if not norm(weights, off[-1]) <= allowed:
            return None
    if not isinstance(segment, PolynomialSegment):
        return arc
    # A cubic misses a smooth path by t^2 (1 - t)^2 (c + d t).
    p, q = ARC_PLACES
    first, second = off[0] / (p * (1.0 - p)) ** 2, off[1] / (q * (1.0 - q)) ** 2
    d = (second - first) / (q - p)
    c = first - p * d
    even = max(EVEN * length, noise)
    if max(distance, *(norm(weights, one) for one in off)) > even:
        # An S shows in the middle. There the cubic of the errors has the factorisation's error, too.
        middle = a.approximate(-solver.evaluator.residual(segment.at(0.5)))
        if not norm(weights, middle - (c + 0.5 * d) / 16.0) <= even:
            return None
    return Arc(a, arc.b, arc.border, segment, length=arc.length, guide=segment.bent(c, d))
