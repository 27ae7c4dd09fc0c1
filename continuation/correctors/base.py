"""What a corrector is, and the loop that all of them share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array, largest
from continuation.evaluation.evaluator import EvaluationError, Evaluator, NotFiniteError, SingularPointError
from continuation.metric import norm
from continuation.point.linearization import Anchor, Linearization
from continuation.tolerance import Tolerance


@frozen(eq=False)
class Correction:
    """The outcome of a correction.

    Attributes
    ----------
    u : ndarray, shape (N + 1,)
        The corrected point (the last iterate where it failed).
    converged : bool
    iterations : int
        Increments computed.
    residual_norm : float
        Largest component of the residual at u; nan where it failed before one was evaluated.
    contraction : float
        Largest ratio of successive increments seen; 0 with a single increment.
    distance : float
        Length of u minus the predicted point in the metric.
    reason : str
        Why it failed.
    finite : bool
        False where it failed because the homotopy has no finite value at an iterate.
    singular : bool
        True where it failed because the bordered matrix has no factorisation at an iterate.
    anchor : Anchor or None
        The last factorisation made on the way, which may serve the tangent too.
    """

    u: Array
    converged: bool
    iterations: int
    residual_norm: float
    contraction: float
    distance: float
    reason: str = ""
    finite: bool = True
    singular: bool = False
    anchor: Anchor | None = None


class Corrector(Protocol):
    """A way back to the path from a predicted point."""

    def correct(
        self, evaluator: Evaluator, point: Linearization, predicted: Array, border: Array, tolerance: Tolerance
    ) -> Correction:
        """Solve H(u) = 0 from `predicted`.

        Parameters
        ----------
        evaluator : Evaluator
        point : Linearization
            The last accepted point, whose factorisation may serve.
        predicted : ndarray, shape (N + 1,)
        border : ndarray, shape (N + 1,)
            The direction that correctors of Keller's kind keep fixed: border . (u - predicted) = 0.
        tolerance : Tolerance
        """
        ...


Direction = Callable[[int, Array, Array, float], Array]
"""(iteration, u, residual, contraction so far) -> increment."""


def iterate(
    evaluator: Evaluator,
    point: Linearization,
    predicted: Array,
    tolerance: Tolerance,
    direction: Direction,
    max_iterations: int,
    max_contraction: float,
    anchors: Sequence[Anchor] = (),
) -> Correction:
    """Add increments until one is small and the residual agrees, or until they stop shrinking.

    An increment that grows by more than `max_contraction` ends the iteration: a corrector that wanders finds another
    branch, and a shorter step is cheaper than a lucky one. Two exceptions: near the tolerance round-off makes ratios
    meaningless, so there only the iteration limit counts. `direction` may add the factorisations that it makes to
    `anchors`: the last goes with the outcome.
    """
    u = predicted.copy()
    contraction, size, before = 0.0, np.inf, np.nan
    residual_norm = np.nan

    def outcome(iterations: int, reason: str = "") -> Correction:
        distance = norm(point.weights, u - predicted)
        anchor = anchors[-1] if anchors else None
        return Correction(u, not reason, iterations, residual_norm, contraction, distance, reason, anchor=anchor)

    try:
        r = evaluator.residual(u)
        for k in range(max_iterations):
            increment = direction(k, u, r, contraction)
            before, size = size, tolerance.measure(increment, u)
            if k and size > 1.0:
                ratio = size / before if before > 0.0 else np.inf
                contraction = max(contraction, ratio)
                if ratio > max_contraction:
                    return outcome(k + 1, f"the corrector does not contract (ratio {ratio:.2g})")
            u += increment
            r = evaluator.residual(u)
            residual_norm = largest(r)
            if size <= 1.0 and residual_norm <= tolerance.residual:
                return outcome(k + 1)
    except EvaluationError as error:
        finite, singular = not isinstance(error, NotFiniteError), isinstance(error, SingularPointError)
        return evolve(outcome(0, str(error)), finite=finite, singular=singular)
    return outcome(max_iterations, f"the corrector did not converge in {max_iterations} iterations")
