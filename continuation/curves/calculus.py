"""Derivatives of a family H(y, lam; mu)."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import evolve, frozen

from continuation.arrays import Array, Matrix, generic_vector
from continuation.counts import Counts
from continuation.evaluation.derivatives import Derivative, from_residual
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.functions import DifferentiableHomotopy
from continuation.evaluation.products import difference_along, sizes
from continuation.events.singularity import SECOND, full_derivative, scales
from continuation.linear import BorderedSystem
from continuation.linear.nullspace import Bordered, null_vectors
from continuation.linear.system import Solver
from continuation.numbers.derivatives import BLOCK

Member = Callable[[Any], Any]


@frozen(eq=False, slots=False)
class Calculus:
    """How a family is differentiated, decided at a point.

    `derivative`: gives (H_y, H_lam) of members without one, or None. `jets`: whether jets give second derivatives and
    those by mu. `u0`: point (y, lam, mu). `extent`: scales of (y, lam). `reach`, `bend`: relative steps in mu for
    differences of H, H' v.
    """

    family: Member
    derivative: Derivative | None
    jets: bool
    u0: Array
    extent: Array
    reach: float
    bend: float

    def member(self, mu: float) -> Any:
        """The homotopy at mu, with a derivative."""
        homotopy = self.family(mu)
        if self.derivative is None:
            return homotopy
        return DifferentiableHomotopy(homotopy, evolve(self.derivative, residual=homotopy.residual))

    def evaluator(self, mu: float) -> Evaluator:
        """Evaluator of the homotopy at mu."""
        return Evaluator(self.member(mu), Counts())

    @cached_property
    def rows(self) -> Array:
        """Row sizes of H' at the start, shape (N,)."""
        return scales(self.evaluator(float(self.u0[-1])), self.extent, (self.u0[:-1],))[1]

    def scaled(self, matrix: Matrix) -> Matrix:
        """The matrix times extents over row sizes."""
        extent = self.extent[:-1]
        if sp.issparse(matrix):
            return sp.csc_array(sp.diags_array(1.0 / self.rows) @ matrix @ sp.diags_array(extent))
        return matrix * extent / self.rows[:, None]

    def borders(self, matrix: Matrix) -> tuple[Array, Array]:
        """Approximate null vectors of a scaled matrix, by inverse iteration."""
        n = self.rows.size
        b, c = generic_vector(n), generic_vector(2 * n)[n:]
        for _ in range(2):
            near = null_vectors(matrix, b / np.linalg.norm(b), c / np.linalg.norm(c))
            b, c = near.left, near.right
        return b / np.linalg.norm(b), c / np.linalg.norm(c)

    def unscaled(self, factors: Bordered) -> BorderedSystem:
        """Factors of the unscaled bordered matrix."""

        def solve(r: Array, rho: float) -> Array:
            x = factors.solve(np.append(r / self.rows, rho))
            x[:-1] *= self.extent[:-1]
            return x

        return Solver(solve, lambda: factors.sign)

    def residual(self, U: Any) -> Any:
        """H(y, lam; mu) of one vector or jet."""
        return self.family(U[-1]).residual(U[:-2], U[-2])

    def by_parameter(self, u: Array, mu: float) -> Array:
        """H_mu at u = (y, lam), shape (N,)."""
        if self.jets:
            from continuation import jets

            U = np.append(u, mu)
            return np.asarray(jets.taylor(self.residual, U, 1, np.arange(U.size) == u.size)[1])
        h = self.reach * self._size(mu)
        ahead, behind = (np.array(self.family(m).residual(u[:-1], float(u[-1]))) for m in (mu + h, mu - h))
        return np.asarray((ahead - behind) / (2.0 * h), dtype=float)

    def second(self, u: Array, mu: float, v: Array, left: Array) -> Array:
        """The row left' H''[v, .] over (y, lam, mu), shape (N + 2,).

        `v`: real; `left`, shape (N,), may be complex and is not conjugated.
        """
        if not v.any():
            return np.zeros(u.size + 1)
        if self.jets:
            from continuation import jets

            return left @ jets.second_derivatives(self.residual, np.append(u, mu), np.append(v, 0.0))
        return self._by_two_jacobians(u, mu, v, left)

    def _by_two_jacobians(self, u: Array, mu: float, v: Array, left: Array) -> Array:
        extent = np.maximum(self.extent, np.abs(u - self.u0[:-1]))
        eps, h = SECOND / float(np.abs(v / extent).max()), self.bend * self._size(mu)
        evaluator = self.evaluator(mu)
        ahead, behind = (full_derivative(evaluator, u + e * v).T @ left for e in (eps, -eps))
        later, before = (full_derivative(self.evaluator(m), u) @ v for m in (mu + h, mu - h))
        return np.append((ahead - behind) / (2.0 * eps), left @ (later - before) / (2.0 * h))

    def _size(self, mu: float) -> float:
        return max(abs(mu), float(sizes(self.u0[-1:])[0]))


def calculus_at(family: Member, u: Array, mu: float, extent: Array) -> Calculus:
    """Decide how to differentiate a family."""
    homotopy = family(mu)
    own = any(hasattr(homotopy, name) for name in ("jacobian", "bordered", "differential"))
    derivative = None if own else from_residual(homotopy.residual, (u[:-1], float(u[-1])))
    U = np.append(u, mu)

    v = extent * generic_vector(u.size)

    def at(y: Array, m: float) -> Any:
        return family(m).residual(y[:-1], float(y[-1]))

    def bent(y: Array, m: float) -> Any:
        return full_derivative(first.evaluator(m), y) @ v

    along = np.zeros_like(U)
    along[-1] = sizes(U[-1:])[0]
    reach = difference_along(at, U, along)[1]
    first = Calculus(family, derivative, False, U, extent, reach, reach)
    plain = evolve(first, bend=difference_along(bent, U, along)[1])
    with_jets = evolve(plain, jets=True)
    if U.size > BLOCK:  # Jets compute all columns: beyond one block two Jacobians are cheaper.
        return plain
    with suppress(TypeError, ArithmeticError, ValueError, AttributeError), np.errstate(all="ignore"):
        if np.isfinite(with_jets.by_parameter(u, mu)).all():
            with_jets.second(u, mu, v, np.ones(u.size - 1))
            return with_jets
    return plain
