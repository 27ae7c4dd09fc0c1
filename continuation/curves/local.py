"""Factorisations with H_y in them along a curve; vectors that have units are scaled by those of the start."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array, Matrix, generic_vector
from continuation.curves.calculus import Calculus
from continuation.events.singularity import row_sizes
from continuation.linear import BorderedSystem
from continuation.linear.nullspace import LONG, REFRESHED, Bordered, null_vectors
from continuation.linear.system import Solver


@frozen(eq=False, slots=False)
class Scaled:
    """H_y in units of the start: columns multiplied by extents, rows divided by what they are made of."""

    calculus: Calculus
    rows: Array

    @classmethod
    def at_start(cls, calculus: Calculus) -> Scaled:
        """Measured where the calculus was decided."""
        u0 = calculus.u0
        sizes = row_sizes(calculus.evaluator(float(u0[-1])), calculus.extent, (u0[:-1],))
        return cls(calculus, sizes)

    @property
    def extent(self) -> Array:
        """Of y, shape (N,)."""
        return self.calculus.extent[:-1]

    def times(self, matrix: Matrix) -> Matrix:
        """The scaled matrix."""
        if sp.issparse(matrix):
            return sp.csc_array(sp.diags_array(1.0 / self.rows) @ matrix @ sp.diags_array(self.extent))
        return matrix * self.extent / self.rows[:, None]

    def first(self, matrix: Matrix) -> tuple[Array, Array]:
        """Borders for a matrix: its null vectors, about, by inverse iteration from vectors in general position."""
        n = self.rows.size
        b, c = generic_vector(n), generic_vector(2 * n)[n:]
        for _ in range(2):
            near = null_vectors(matrix, b / np.linalg.norm(b), c / np.linalg.norm(c))
            b, c = near.left, near.right
        return b / np.linalg.norm(b), c / np.linalg.norm(c)

    def unscaled(self, factors: Bordered) -> BorderedSystem:
        """The factors of a scaled matrix, as those of the matrix: scaling is by positive numbers."""

        def solve(r: Array, rho: float) -> Array:
            x = factors.solve(np.append(r / self.rows, rho))
            x[:-1] *= self.extent
            return x

        return Solver(solve, lambda: factors.sign)


@frozen(eq=False)
class Tangential:
    """[H_y, H_lam] bordered by a row that its kernel is not orthogonal to: one of the start's, or the kernel itself."""

    calculus: Calculus
    row: Array

    @classmethod
    def at_start(cls, calculus: Calculus) -> Tangential:
        """With the kernel of the start for a row."""
        first = cls(calculus, generic_vector(calculus.u0.size - 1) / calculus.extent)
        u, mu = calculus.u0[:-1], float(calculus.u0[-1])
        t = first.factored(u, mu)[1] / calculus.extent
        return cls(calculus, t / float(np.linalg.norm(t)) / calculus.extent)

    def factored(self, u: Array, mu: float) -> tuple[Any, Array]:
        """The family's own factorisation, and the kernel, of length one in the extents of the start, oriented."""
        extent, row = self.calculus.extent, self.row
        evaluator = self.calculus.evaluator(mu)
        for _ in range(REFRESHED):
            system = evaluator.factor(u, row)
            t = system.solve(np.zeros(u.size - 1), 1.0)
            size = float(np.linalg.norm(t / extent))
            if size * float(np.linalg.norm(row * extent)) <= LONG:
                break
            row = t / extent**2 / size
        return system, t / size * (system.sign or 1)


def last_column(full: Matrix) -> Array:
    """H_lam of [H_y, H_lam], dense."""
    column: Array = full[:, [-1]].toarray().ravel() if sp.issparse(full) else full[:, -1]
    return column
