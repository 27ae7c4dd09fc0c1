"""Matrix-free H_y: preconditioned GMRES on the bordered operator."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen
from attrs.converters import optional
from scipy.sparse.linalg import LinearOperator, aslinearoperator, gmres

from continuation.arrays import ROOT_OF_ROUND_OFF, Array, Matrix
from continuation.linear.elimination import eliminated
from continuation.linear.refine import TRUSTED, BorderedMatrix, join, refined
from continuation.linear.system import SingularError

RESTART = 100
CYCLES = 20
"""GMRES keeps RESTART vectors, and restarts CYCLES times."""


def _operator(operator: Any) -> Matrix:
    return aslinearoperator(operator)


@frozen(eq=False)
class Operator:
    """A matrix given by its products, with an optional preconditioner.

    Parameters
    ----------
    operator : LinearOperator
        H_y, shape (N, N).
    preconditioner : LinearOperator, optional
        Approximates H_y^{-1}, shape (N, N).
    """

    operator: Matrix = field(converter=_operator)
    preconditioner: Matrix | None = field(default=None, converter=optional(_operator))

    def __attrs_post_init__(self) -> None:
        if self.preconditioner is not None and self.preconditioner.shape != self.operator.shape:
            raise ValueError(f"preconditioner has shape {self.preconditioner.shape}; expected {self.operator.shape}")

    @property
    def shape(self) -> tuple[int, int]:
        """(N, N)."""
        n, m = self.operator.shape
        return int(n), int(m)

    def toarray(self) -> Array:
        """A dense copy, by N products."""
        return np.asarray(self.operator @ np.eye(self.shape[0]))

    def __matmul__(self, other: Array) -> Array:
        return np.asarray(self.operator @ other)


@frozen(eq=False)
class Krylov:
    """The bordered operator, solved by GMRES; `scale`: of the last row; `inverse`: bordered preconditioner."""

    bordered: BorderedMatrix
    scale: float
    inverse: Matrix | None

    @property
    def sign(self) -> int:
        """0: products do not tell the sign."""
        return 0

    def solve(self, r: Array, rho: float) -> Array:
        """The solution, shape (N + 1,); `SingularError` if GMRES fails."""
        rhs = join(r, self.scale * rho)
        z, accurate = refined(self.bordered, self._gmres, rhs)
        with np.errstate(all="ignore"):
            left = float(np.abs(self.bordered.residual(z, rhs)).max() / (np.abs(rhs).max() or 1.0))
        # A singular operator gives z of size 1 / eps and a tiny residual; this bound is that of condition 1e12.
        if not (accurate and left <= np.sqrt(ROOT_OF_ROUND_OFF)):
            raise SingularError(
                f"GMRES on the bordered operator of order {len(rhs)} did not converge: relative residual {left:.1e} "
                f"after {CYCLES} cycles of {min(RESTART, len(rhs))} steps. Give H_y a (better) preconditioner."
            )
        return z

    def approximate(self, r: Array, rho: float) -> Array:
        """Solve to six digits."""
        return self._gmres(join(r, self.scale * rho))

    def _gmres(self, rhs: Array) -> Array:
        if not rhs.any() or not np.isfinite(rhs).all():
            return rhs
        order = len(rhs)
        product = LinearOperator((order, order), matvec=self.bordered.times, dtype=float)
        restart = min(RESTART, order)
        return np.asarray(gmres(product, rhs, M=self.inverse, rtol=TRUSTED, restart=restart, maxiter=CYCLES)[0])


def factor_operator(matrix: Operator, column: Array, row: Array) -> Krylov:
    """Prepare GMRES; `SingularError` if a product is not finite or the border is zero."""
    n, length = len(column), float(np.linalg.norm(row))
    if length == 0:
        raise SingularError("The bordered operator is singular: the border is zero.")
    # For random signs, E |A v|^2 is the squared Frobenius norm.
    probe = np.where(np.random.default_rng(n).random(n) < 0.5, -1.0, 1.0)
    with np.errstate(all="ignore"):
        size = float(np.linalg.norm(matrix @ probe))
        scale = float(np.hypot(size, np.linalg.norm(column))) / np.sqrt(n) / length or 1.0
        bordered = BorderedMatrix(matrix, column, scale * row, np.full(n, size))
    if matrix.preconditioner is None:
        return Krylov(bordered, scale, None)
    first = matrix.preconditioner.matvec
    W, border = first(column), bordered.row
    if border[-1] == border[:-1] @ W:
        # The preconditioner is no inverse: it may have another corner.
        border = np.append(border[:-1], border[-1] + np.linalg.norm(border))
    inverse = eliminated(first, W[:, None], border[None])
    return Krylov(bordered, scale, LinearOperator((n + 1, n + 1), matvec=inverse.solve, dtype=float))
