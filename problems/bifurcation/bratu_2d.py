"""Bratu's problem on the unit square."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from scipy.sparse.linalg import LaplacianNd

from continuation.arrays import Array, Matrix
from continuation.events.box import Box
from problems.bifurcation.bratu_1d import Bratu1D
from problems.options import finite_or_none, positive_integer, quiet


def five_point(m: int) -> Matrix:
    """h^2 times the Dirichlet Laplacian on m x m interior points, sorted CSC."""
    laplacian = sp.csc_array(LaplacianNd((m, m), boundary_conditions="dirichlet", dtype=float).tosparse())
    laplacian.sort_indices()
    return laplacian


@frozen(eq=False)
class Bratu2D:
    """Laplacian(u) + lam e^u = 0 on the unit square, u = 0 on its edge, by the five-point formula.

    ``H = h^2 (Laplacian_h u + lam e^u)``, h = 1/(m + 1), points by rows. The path turns at lam* = 6.808... and returns
    towards lam = 0.

    Parameters
    ----------
    m : int
        Interior points per side.
    target : float or None
        lam at the end; None: max u = 8.

    References
    ----------
    Bratu, Bull. Soc. Math. France 42, 1914.
    """

    m: int = field(default=20, validator=positive_integer)
    target: float | None = field(default=None, validator=finite_or_none)
    box: ClassVar[Box] = Bratu1D.box
    parameter_name: ClassVar[str] = Bratu1D.parameter_name
    problem_class: ClassVar[str] = Bratu1D.problem_class
    references: ClassVar[tuple[str, ...]] = Bratu1D.references

    @cached_property
    def _pattern(self) -> tuple[Matrix, Any]:
        """Laplacian and its stored diagonal."""
        laplacian = five_point(self.m)
        columns = np.repeat(np.arange(self.m**2), np.diff(laplacian.indptr))
        return laplacian, np.flatnonzero(laplacian.indices == columns)

    def start(self) -> tuple[Array, float]:
        """Zero at lam = 0."""
        return np.zeros(self.m**2), 0.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """H, shape (m^2,)."""
        equations: Array = self._pattern[0] @ y + (1.0 / (self.m + 1.0) ** 2) * lam * np.exp(y)
        return equations

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam): CSC of order m^2; shape (m^2,)."""
        slope = (1.0 / (self.m + 1.0) ** 2) * np.exp(y)
        laplacian, diagonal = self._pattern
        matrix = laplacian.copy()
        matrix.data[diagonal] += lam * slope
        return matrix, slope

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """Maximum of u."""
        return {"max_u": float(np.max(y))}
