"""Points brought onto the path, to round-off, with whichever factorisation will do."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from attrs import Factory, define, evolve, field

from continuation.arrays import Array, dot, generic_vector
from continuation.contraction import Contraction, Iteration
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import POINT_ULPS, CountedSystem, Evaluator
from continuation.metric import norm
from continuation.point.arc import Arc
from continuation.point.linearization import Anchor, Linearization, relinearize
from continuation.point.segment import PolynomialSegment
from continuation.tolerance import Tolerance

MaxStep = Callable[[Array, Array], float]

ARC_PLACES = 0.31, 0.77
"""Where on an arc the path is compared with it: no symmetry of an S-bend or of a cubic aligns these."""

LATE = 0.93
"""There a series is compared, too: what it was off at its end is made up for by a power of t, which is next to nothing
at the other places, wherever an S lies behind them (2 of 1,500 S-bends were overlooked by that)."""

SLACK = 0.004
"""How far off the path the arc may be there, in its lengths: a cubic misses an arc that turns by one radian by that."""

MISSED, EVEN = 0.07, 1.5e-4
"""On a smooth path the arc is off by a small part of what the prediction was off: for a cubic 1/64 where it is
extrapolated by its own length. An S inside the step puts both off alike. What is below the second, in lengths of the
arc, is not looked at: S-bends of a thousandth of the path are seen with it, of steps of a third (measured on 900)."""

ARC_NOISE = 1e2
"""The same in tolerances: on a step as short as the noise of the residual an arc cannot do better than that."""

EPS = float(np.finfo(float).eps)

NOISE_LOOKS = 4.0
"""One look at something random: the largest of many is more than that."""

CHORD_STEPS = Contraction(iterations=20)

NO_CHANGE = 1e-6
"""The last increment, in tolerances: the next one, half of it or less, changes nothing that anybody sees."""

SMALL_INCREMENT, WITHIN_TOLERANCE = 1e-4, 1.0
"""The increment, in tolerances, that will do where round-off keeps the next from halving: first a small one is asked
for; where three factorisations do not give it, the tolerance itself is enough."""


@define(eq=False)
class PathSolver:
    """What puts points on the path of one homotopy to one tolerance; made once for a trace.

    The start raises the tolerance where noise in H does not allow it (`continuation.step.start`).

    Attributes
    ----------
    evaluator : Evaluator
    tolerance : Tolerance
    max_step : callable or None
        How far an interior path may go from a point in a direction (`continuation.homotopy.SupportsMaxStep`).
    straight : callable or None
        How far a path of straight pieces goes before it bends, about; of use where nothing else gives it a scale.
    room : callable or None
        How far a path without a target goes until it is to end, if it is straight; the same holds of that.
    """

    evaluator: Evaluator
    tolerance: Tolerance
    max_step: MaxStep | None = None
    straight: MaxStep | None = None
    room: MaxStep | None = None
    asked: float = field(default=Factory(lambda solver: solver.tolerance.relative, takes_self=True), init=False)

    def noisy(self, least: float) -> None:
        """Raise the tolerance that was asked for to the `least` that noise in H allows."""
        self.tolerance = evolve(self.tolerance, relative=max(self.asked, least))

    @property
    def noted(self) -> str:
        """What is said of noise at the end of a path."""
        least = self.tolerance.relative
        return f" The residual is noisy: the tolerance was raised to {least:.0e}." if least > self.asked else ""

    def project(self, near: Linearization, guess: Array, border: Array) -> tuple[Array, Anchor]:
        """Bring a guess onto the path, to round-off, along the hyperplane orthogonal to `border`.

        Chord steps with a factorisation from nearby while they halve the increment or better; else with one made at
        the guess, which is made again where it was when that does not contract either.

        Returns
        -------
        u : ndarray, shape (N + 1,)
        anchor : Anchor
            The factorisation that served.

        Raises
        ------
        EvaluationError
            If nothing helps.
        """
        evaluator = self.evaluator
        settled = self.settled(near, guess, border)
        if settled is not None:
            return settled, near.anchor
        u = guess
        for enough in (SMALL_INCREMENT, SMALL_INCREMENT, SMALL_INCREMENT, *3 * (WITHIN_TOLERANCE,)):
            system = evaluator.factor(u, border)
            settled = self._chord_steps(u, partial(_approximate, system), near, enough)
            if settled is not None:
                return settled, Anchor(u, border, system)
            u = u + system.solve(-evaluator.residual(u), 0.0)
        raise EvaluationError("a point of the path could not be settled")

    def settled(self, near: Linearization, guess: Array, border: Array) -> Array | None:
        """The same with the factorisation from nearby alone; None where its chord steps do not settle."""
        return self._chord_steps(guess, lambda r: near.approximate(r, 0.0, border), near, SMALL_INCREMENT)

    def _chord_steps(
        self, guess: Array, solve: Callable[[Array], Array], near: Linearization, enough: float
    ) -> Array | None:
        """Chord steps until increments stop halving; the point if they are then within `enough` of the tolerance.

        Round-off may be more than that, where H or the units have few digits: it is measured where it matters.
        """
        chord, residual, measure = Iteration(guess, CHORD_STEPS), self.evaluator.residual, self.tolerance.measure
        while chord.count < CHORD_STEPS.iterations:
            step = solve(-residual(chord.x))
            size = measure(step, near.weights)
            if not chord.add(step, size):
                break
            if size <= NO_CHANGE:
                return chord.x
        # The increment at which they stalled leads from one point that is off by round-off to another.
        last = chord.size * min(chord.ratio, 1.0)
        if chord.size <= enough or (
            last <= WITHIN_TOLERANCE and last <= 2.0 * self.noise(near) / self.tolerance.relative
        ):
            return chord.x
        return None

    def noise(self, near: Linearization) -> float:
        """How far round-off in H and in the point moves a correction near a point, in the metric.

        The point is moved by a few units in its last places (of the path's, where a component is smaller than those);
        what the correction makes of that beyond moving it back is round-off. One residual and one solve beyond that
        at the point.
        """
        return norm(near.weights, self.noise_by_component(near))

    def noise_by_component(self, near: Linearization) -> Array:
        """The same for each component, shape (N + 1,)."""
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

    def project_and_linearize(
        self, near: Linearization, guess: Array, border: Array, along: Array | None = None
    ) -> Linearization:
        """The path's point on the hyperplane through `guess`, linearized, oriented by angle with the border.

        `along` is about the direction of the path there, if that is known, of any length: it saves solves.
        """
        u, anchor = self.project(near, guess, border)
        return relinearize(self.evaluator, u, near.weights, anchor, border, guess=along)


def _approximate(system: CountedSystem, r: Array) -> Array:
    return system.approximate(r, 0.0)


def arc_on_path(solver: PathSolver, arc: Arc, distance: float) -> Arc | None:
    """The arc if it lies near the path: two points of different branches, or of an S, are joined by none.

    One residual and one solve with the factorisation at hand estimate how far the segment is off at a place. What that
    tells of a cubic is its arc's guide. The distance is how far the prediction of the end was off, in the metric.
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
        # Of an S the middle is elsewhere. From the cubic, as the others: what a factorisation of another place makes
        # of them has one error.
        middle = a.approximate(-solver.evaluator.residual(segment.at(0.5)))
        if not norm(weights, middle - (c + 0.5 * d) / 16.0) <= even:
            return None
    return Arc(a, arc.b, arc.border, segment, length=arc.length, guide=segment.bent(c, d))
