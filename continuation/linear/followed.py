"""One eigenvalue, followed to nearby matrices with one factorisation."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array, Matrix, generic_vector
from continuation.contraction import Contraction, Iteration
from continuation.linear.nullspace import NearlySingular, null_vectors
from continuation.linear.spectrum import OFF_AXIS

FOLLOWING = Contraction(iterations=15)
"""15 increments, each half of the last, gain five digits."""


@frozen(eq=False)
class FollowedEigenvalue:
    """An eigenvalue, its vector, and a bordered factorisation made nearby.

    `turned`: derivative of the bordered solution by the eigenvalue.
    """

    value: complex
    near: NearlySingular
    turned: Any

    @classmethod
    def of(cls, matrix: Matrix, value: complex) -> FollowedEigenvalue:
        """The eigenvalue nearest to `value`; `ArithmeticError` if the bordered matrix is singular."""
        n = matrix.shape[0]
        eye = sp.eye_array(n, format="csc") if sp.issparse(matrix) else np.eye(n)
        b, c = np.split(generic_vector(2 * n), 2)
        near = null_vectors(matrix - value * eye, b / np.linalg.norm(b), c / np.linalg.norm(c))
        return cls(value, near, near.factors.solve(np.append(near.right, 0.0)))

    def at(self, matrix: Matrix) -> tuple[complex, int]:
        """A nearby matrix's eigenvalue and the solves for it, by Newton's chord for (A - z) v = 0, c*v fixed.

        Raises `ArithmeticError` if it does not converge.
        """
        pair = Iteration(np.append(self.near.right, self.value), FOLLOWING)

        def increment() -> Array:
            v, z = pair.x[:-1], pair.x[-1]
            step = self.near.factors.solve(np.append(z * v - matrix @ v, 0.0))
            change = -step[-1] / self.turned[-1]
            return np.append(step[:-1] + change * self.turned[:-1], change)

        def measure(step: Array) -> float:
            return float(abs(step[-1]) / abs(pair.x[-1]))

        if not (pair.run(increment, measure, lambda size: size <= 2.0**-52) or pair.size <= OFF_AXIS):
            raise ArithmeticError("an eigenvalue is not followed from one matrix to the other")
        return complex(pair.x[-1]), pair.count
