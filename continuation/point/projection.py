"""Points brought onto the path, to round-off, with whichever factorisation will do."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from attrs import frozen

from continuation.arrays import Array
from continuation.contraction import Contraction, Iteration
from continuation.evaluation.evaluator import CountedSystem, EvaluationError, Evaluator
from continuation.metric import norm
from continuation.point.arc import Arc
from continuation.point.linearization import Anchor, Linearization, relinearize
from continuation.tolerance import Tolerance

MaxStep = Callable[[Array, Array], float]

SLACK = 0.02
"""How far off the path the middle of an arc may be, in lengths of the arc: on an arc that turns by less than a right
angle a cubic misses its middle by less than half of that."""

NOISE = 1e2
"""The same in tolerances: on a step as short as the noise of the residual the middle cannot do better than that."""

CHORD_STEPS = Contraction(iterations=20)

NO_CHANGE = 1e-6
"""The last increment, in tolerances: the next one, half of it or less, changes nothing that anybody sees."""

AT_ROUND_OFF, WITHIN_TOLERANCE = 1e-4, 1.0
"""The increment, in tolerances, that will do where round-off keeps the next from halving: first a small one is asked
for; where three factorisations do not give it, the tolerance itself is enough."""


@frozen(eq=False)
class PathSolver:
    """What puts points on the path of one homotopy to one tolerance; made once for a trace.

    Attributes
    ----------
    evaluator : Evaluator
    tolerance : Tolerance
    max_step : callable or None
        How far an interior path may go from a point in a direction (`continuation.homotopy.SupportsMaxStep`).
    """

    evaluator: Evaluator
    tolerance: Tolerance
    max_step: MaxStep | None = None

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
        settled = self._chord_steps(guess, lambda r: near.solve(r, 0.0, border), AT_ROUND_OFF)
        if settled is not None:
            return settled, near.anchor
        u = guess
        for enough in (AT_ROUND_OFF, AT_ROUND_OFF, AT_ROUND_OFF, *3 * (WITHIN_TOLERANCE,)):
            system = evaluator.factor(u, border)
            settled = self._chord_steps(u, partial(_approximate, system), enough)
            if settled is not None:
                return settled, Anchor(u, border, system)
            u = u + system.solve(-evaluator.residual(u), 0.0)
        raise EvaluationError("a point of the path could not be settled")

    def _chord_steps(self, guess: Array, solve: Callable[[Array], Array], enough: float) -> Array | None:
        """Chord steps until increments stop halving; the point if they are then within `enough` of the tolerance."""
        chord, residual = Iteration(guess, CHORD_STEPS), self.evaluator.residual
        done = chord.run(lambda: solve(-residual(chord.x)), self.tolerance.measure, lambda size: size <= NO_CHANGE)
        return chord.x if done or chord.size <= enough else None

    def project_and_linearize(self, near: Linearization, guess: Array, border: Array) -> Linearization:
        """The path's point on the hyperplane through `guess`, linearized, oriented by angle with the border."""
        u, anchor = self.project(near, guess, border)
        return relinearize(self.evaluator, u, near.weights, anchor, border)


def _approximate(system: CountedSystem, r: Array) -> Array:
    return system.approximate(r, 0.0)


def midpoint_on_path(solver: PathSolver, arc: Arc) -> bool:
    """Whether the middle of the segment lies near the path: two points of different branches are joined by no arc.

    One residual and one solve with the factorisation at hand estimate how far the middle is off.
    """
    middle, _ = arc.samples[len(arc.samples) // 2]
    off = arc.a.solve(-solver.evaluator.residual(middle))
    if norm(arc.a.weights, off) <= SLACK * norm(arc.a.weights, arc.b.u - arc.a.u):
        return True
    return solver.tolerance.measure(off, middle) <= NOISE
