"""Newton-type correctors."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import POSITIVE, SHARE, integer
from continuation.arrays import Array
from continuation.citation.bibliography import ALLGOWER_GEORG, DEUFLHARD, KELLER_1977, KELLEY
from continuation.contraction import updated
from continuation.correctors.base import Correction, iterate
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import Anchor, Linearization, linearize
from continuation.tolerance import Tolerance


@frozen
class BorderedNewton:
    """Keller's pseudo-arclength corrector: Newton on H(u) = 0, border . (u - predicted) = 0.

    Parameters
    ----------
    reuse : float
        Largest ratio of increments at which a factorisation is reused; 0 is Newton's method.
    max_iterations : int
    max_contraction : float
        Largest ratio of increments: above a half Newton's theorem fails, and a shorter step is cheaper.

    References
    ----------
    H. B. Keller, Numerical solution of bifurcation and nonlinear eigenvalue problems, 1977; Deuflhard, Newton Methods
    for Nonlinear Problems, Section 2.1; Broyden's good update (C. T. Kelley, Iterative Methods for Linear and Nonlinear
    Equations, Section 7.3).
    """

    references: ClassVar[tuple[str, ...]] = (KELLER_1977, DEUFLHARD, KELLEY)
    reuse: float = field(default=0.1, validator=SHARE)
    max_iterations: int = field(default=8, validator=integer(1))
    max_contraction: float = field(default=0.6, validator=POSITIVE)

    def correct(
        self, evaluator: Evaluator, point: Linearization, predicted: Array, border: Array, tolerance: Tolerance
    ) -> Correction:
        """See `Corrector.correct`."""
        anchors: list[Anchor] = []
        increments: list[tuple[Array, Array]] = []
        fresh_at = 0

        def direction(k: int, u: Array, r: Array, contraction: float) -> Array:
            nonlocal fresh_at
            if not anchors or self.reuse == 0.0 or (contraction > self.reuse and k > fresh_at + 1):
                anchors[:] = [Anchor(u.copy(), border, evaluator.factor(u, border))]
                fresh_at = k
                increments.clear()
            return updated(increments, anchors[0].system.approximate(-r, 0.0), point.weights)

        # With reuse 0 no factorisation serves twice.
        offered = anchors if self.reuse > 0.0 else ()
        return iterate(
            evaluator, point, predicted, tolerance, direction, self.max_iterations, self.max_contraction, offered
        )


@frozen
class MoorePenrose:
    """Normal-flow Newton: increments -H'(u)^+ H(u), orthogonal to the kernel in the default metric.

    It ends near the foot of the perpendicular (Allgower and Georg, Chapter 3).

    Parameters
    ----------
    max_iterations : int
    max_contraction : float
    """

    references: ClassVar[tuple[str, ...]] = (ALLGOWER_GEORG,)
    max_iterations: int = field(default=8, validator=integer(1))
    max_contraction: float = field(default=0.6, validator=POSITIVE)

    def correct(
        self, evaluator: Evaluator, point: Linearization, predicted: Array, border: Array, tolerance: Tolerance
    ) -> Correction:
        """See `Corrector.correct`."""

        def direction(k: int, u: Array, r: Array, contraction: float) -> Array:
            return linearize(evaluator, u, point.weights, point.border).solve(-r)

        return iterate(evaluator, point, predicted, tolerance, direction, self.max_iterations, self.max_contraction)


@frozen
class NaturalParameter:
    """Newton at fixed parameter: border e_{N+1}, singular at folds."""

    reuse: float = field(default=0.1, validator=SHARE)
    max_iterations: int = field(default=8, validator=integer(1))
    max_contraction: float = field(default=0.6, validator=POSITIVE)

    def correct(
        self, evaluator: Evaluator, point: Linearization, predicted: Array, border: Array, tolerance: Tolerance
    ) -> Correction:
        """See `Corrector.correct`."""
        unit = np.append(np.zeros(predicted.size - 1), 1.0)
        newton = BorderedNewton(self.reuse, self.max_iterations, self.max_contraction)
        return newton.correct(evaluator, point, predicted, unit, tolerance)
