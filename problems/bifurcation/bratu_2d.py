"""Bratu's problem on the unit square: a sparse path with one fold."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, fields, frozen

from continuation.arrays import Array, Matrix
from continuation.events.box import Box
from problems.bibliography import BRATU
from problems.options import finite_or_none, positive_integer, quiet


def five_point(m: int) -> Matrix:
    """h^2 times the five-point Laplacian of an m x m interior grid with Dirichlet boundary, CSC, indices sorted."""
    one = np.ones(m - 1)
    line = sp.diags_array([one, np.full(m, -2.0), one], offsets=[-1, 0, 1])
    eye = sp.eye_array(m)
    laplacian = sp.csc_array(sp.kron(eye, line) + sp.kron(line, eye))
    laplacian.sort_indices()
    return laplacian


@frozen(eq=False)
class Bratu2D:
    """Laplacian(u) + lam e^u = 0 on the unit square, u = 0 on its edge, by the five-point formula.

    ``H = h^2 (Laplacian_h u + lam e^u)`` with h = 1/(m + 1), on m x m interior points numbered row by row: multiplied
    by h^2, so that H_y has entries of order 1 for every m. The path leaves u = 0 at lam = 0, turns at lam* = 6.808...
    and returns towards lam = 0.

    Parameters
    ----------
    m : int
        Interior points a side; m^2 unknowns.
    target : float or None
        Where the path ends. The upper branch has no end: where nothing is said, the path stops at max u = 8.

    References
    ----------
    Bratu, Bull. Soc. Math. France 42, 1914.
    """

    m: int = field(default=20, validator=positive_integer)
    target: float | None = field(default=None, validator=finite_or_none)
    box: ClassVar[Box] = {"y": (None, 8.0)}
    parameter_name: ClassVar[str] = "lambda"
    problem_class: ClassVar[str] = "nonlinear boundary-value problems, discretised"
    references: ClassVar[tuple[str, ...]] = (BRATU,)
    # The sparsity never changes along the path: it is worked out once, and H_y alters the diagonal's values alone.
    _laplacian: Any = field(init=False, repr=False)
    _diagonal: Any = field(init=False, repr=False)
    _has_left: Any = field(init=False, repr=False)

    @_laplacian.default
    def _five_point_laplacian(self) -> Matrix:
        # Attrs runs validators after defaults, and this default needs a good m.
        positive_integer(self, fields(Bratu2D).m, self.m)
        return five_point(self.m)

    @_diagonal.default
    def _positions_of_the_diagonal(self) -> Any:
        columns = np.repeat(np.arange(self.m**2), np.diff(self._laplacian.indptr))
        return np.flatnonzero(self._laplacian.indices == columns)

    @_has_left.default
    def _points_with_a_left_neighbour(self) -> Any:
        return (np.arange(self.m**2) % self.m > 0).astype(float)

    def start(self) -> tuple[Array, float]:
        """The trivial solution at lam = 0."""
        return np.zeros(self.m**2), 0.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (m^2,); inf or nan where e^u overflows."""
        # Shifts instead of the sparse product: they let complex numbers and jets pass through numpy.
        row, point = np.zeros(self.m), np.zeros(1)
        vertical = np.concatenate((row, y[: -self.m])) + np.concatenate((y[self.m :], row))
        left = np.concatenate((point, y[:-1])) * self._has_left
        right = np.concatenate((y[1:] * self._has_left[1:], point))
        equations: Array = vertical + left + right - 4.0 * y + self._square * lam * np.exp(y)
        return equations

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam): CSC of order m^2, and shape (m^2,)."""
        slope = self._square * np.exp(y)
        matrix = self._laplacian.copy()
        matrix.data[self._diagonal] += lam * slope
        return matrix, slope

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """The maximum of u, the ordinate of the usual diagram."""
        return {"max_u": float(np.max(y))}

    @property
    def _square(self) -> float:
        return 1.0 / (self.m + 1.0) ** 2
