"""Broyden's good update on the last point's factorisation."""

from __future__ import annotations

import itertools
from typing import ClassVar

from attrs import field, frozen

from continuation.arguments.checks import POSITIVE, integer
from continuation.arrays import Array
from continuation.citation.bibliography import KELLEY
from continuation.contraction import MONOTONE
from continuation.correctors.base import Correction, iterate
from continuation.evaluation.evaluator import Evaluator
from continuation.metric import inner
from continuation.point.linearization import Linearization
from continuation.tolerance import Tolerance


def updated(increments: list[Array], z: Array, weights: Array) -> Array:
    """Apply Broyden's good update to a chord increment z; append it to `increments`.

    All increments since the factorisation define the update (Kelley, Iterative Methods for Linear and Nonlinear
    Equations, Section 7.3).
    """
    for before, after in itertools.pairwise(increments):
        z = z + (inner(weights, before, z) / inner(weights, before, before)) * after
    if increments:
        last = increments[-1]
        left = 1.0 - inner(weights, last, z) / inner(weights, last, last)
        if left < 1.0 - MONOTONE:
            # Round-off contains nothing about the matrix.
            increments.clear()
        else:
            z = z / left
    if inner(weights, z, z) > 0.0:
        increments.append(z)
    return z


@frozen
class Broyden:
    """Broyden's method on the bordered system, restarted each step from the tangent's factorisation.

    One factorisation a step, superlinear. It stores increments only (see `updated`), so resuming needs no matrix.
    """

    references: ClassVar[tuple[str, ...]] = (KELLEY,)
    max_iterations: int = field(default=15, validator=integer(1))
    max_contraction: float = field(default=0.7, validator=POSITIVE)

    def correct(
        self, evaluator: Evaluator, point: Linearization, predicted: Array, border: Array, tolerance: Tolerance
    ) -> Correction:
        """See `Corrector.correct`."""
        increments: list[Array] = []

        def direction(k: int, u: Array, r: Array, contraction: float) -> Array:
            return updated(increments, point.solve(-r, 0.0, border), point.weights)

        return iterate(evaluator, point, predicted, tolerance, direction, self.max_iterations, self.max_contraction)
