"""The equations of one complementary face, x_i = 0 off a set and w_i = 0 on it, solved as the matrix is stored."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray
from scipy.linalg.lapack import dgbtrf, dgbtrs, dgecon, dgetrf, dgetrs, dpotrf, dpotrs
from scipy.sparse.linalg import splu

from continuation.arrays import Array, Matrix
from problems.lcp.compensated import accurate_w
from problems.lcp.homotopies.structure import Structure
from problems.lcp.problem import LCP

Mask = NDArray[np.bool_]
Solver = Callable[[Array], Array]

SINGULAR = 1e-14
"""Reciprocal condition below which a face counts as singular."""

SHIFT = 1e-8
"""Shift of the diagonal, relative to the largest entry, with which the equations of a singular face are solved."""

CORRECTIONS = 4
"""Refinements of the solution by a shifted matrix: each gains the ratio of the shift to the least singular value."""


@frozen(eq=False)
class Face:
    """One face and the factorisation of its equations.

    Attributes
    ----------
    problem : LCP
    active : Mask
        Where w_i = 0 is asked for.
    inverse : callable
        Right-hand side on the active set to the solution there, of the equations or of shifted ones.
    exact : bool
        Whether the equations themselves were factored, not shifted ones.
    """

    problem: LCP
    active: Mask
    inverse: Solver
    exact: bool

    def point(self, near: Array) -> tuple[Array, Array] | None:
        """(x, A x + q) on the face, w zero on the active set; None where nothing finite comes out.

        Where the face holds many points this is, about, the one nearest to `near`.
        """
        x = np.zeros_like(near) if self.exact else np.where(self.active, near, 0.0)
        with np.errstate(over="ignore", invalid="ignore"):
            for _ in range(1 if self.exact else CORRECTIONS):
                x = self._corrected(x, self.problem.w(x))
            w = self.problem.w(x)
        if not (np.isfinite(x).all() and np.isfinite(w).all()):
            return None
        if self.exact:
            w[self.active] = 0.0
        return x, w

    def refined(self, x: Array) -> Array:
        """The point x of the face after a correction with w in twice the working precision."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self._corrected(x, accurate_w(self.problem, x)[0])

    def _corrected(self, x: Array, w: Array) -> Array:
        corrected = x.copy()
        corrected[self.active] -= self.inverse(w[self.active])
        return corrected


@frozen(eq=False)
class Faces:
    """The faces of one problem.

    Parameters
    ----------
    structure : Structure
        Of the problem.
    """

    structure: Structure

    @property
    def problem(self) -> LCP:
        """The problem."""
        return self.structure.problem

    def face(self, active: Mask) -> Face | None:
        """The face of an active set, factored; None where that is impossible."""
        inside = np.flatnonzero(active)
        if inside.size == 0:
            return Face(self.problem, active, lambda r: r, True)
        if self.structure.band is not None:
            solver, exact = self._banded(active), True
        elif self.problem.sparse:
            solver, exact = _sparse(self.problem.A[inside][:, inside])
        else:
            solver, exact = self._dense(inside)
        return None if solver is None else Face(self.problem, active, solver, exact)

    def _dense(self, inside: NDArray[np.intp]) -> tuple[Solver | None, bool]:
        block = self.problem.A[np.ix_(inside, inside)] if inside.size < self.problem.n else self.problem.A
        symmetric = self.structure.symmetric and self.structure.semidefinite
        norm = float(np.abs(block).sum(axis=0).max())
        for exact in (True, False):
            if not exact:
                block = block + SHIFT * max(norm, 1e-300) * np.eye(inside.size)
            solver = _cholesky(block, norm) if symmetric else _lu(block, norm)
            if solver is not None:
                return solver, exact
        return None, False

    def _banded(self, active: Mask) -> Solver | None:
        """In the band of the whole matrix, with unit rows off the face: no index is moved."""
        band = self.structure.band
        assert band is not None
        n, lower, upper = active.size, band.lower, band.upper
        room = np.zeros((2 * lower + upper + 1, n), order="F")
        for k in range(-lower, upper + 1):
            begin, end = max(0, -k), min(n, n - k)
            room[lower + upper - k, begin + k : end + k] = (active * band.rows[lower + k])[begin:end]
        room[lower + upper, ~active] = 1.0
        lu, pivots, info = dgbtrf(room, lower, upper, overwrite_ab=1)

        def solve(right: Array) -> Array:
            whole = np.zeros(n)
            whole[active] = right
            solution: Array = dgbtrs(lu, lower, upper, whole, pivots)[0].ravel()
            return solution[active]

        return solve if info == 0 else None


def _cholesky(block: Array, norm: float) -> Solver | None:
    factor, info = dpotrf(block.T, lower=1, clean=0)
    if info != 0 or float(factor.diagonal().min()) ** 2 < SINGULAR * norm:
        return None
    return lambda right: np.asarray(dpotrs(factor, right, lower=1)[0]).ravel()


def _lu(block: Array, norm: float) -> Solver | None:
    # The transpose is Fortran-ordered as LAPACK wants it; the factors then solve with their transpose.
    factors, swaps, info = dgetrf(block.T)
    if info != 0 or dgecon(factors, norm)[0] < SINGULAR:
        return None
    return lambda right: np.asarray(dgetrs(factors, swaps, right, trans=1)[0]).ravel()


def _sparse(block: Matrix) -> tuple[Solver | None, bool]:
    block = sp.csc_array(block)
    try:
        return splu(block, permc_spec="MMD_AT_PLUS_A").solve, True
    except RuntimeError:  # SuperLU's word for an exact zero pivot
        pass
    norm = float(abs(block).sum(axis=0).max())
    try:
        return splu(sp.csc_array(block + SHIFT * max(norm, 1e-300) * sp.eye_array(block.shape[0]))).solve, False
    except RuntimeError:
        return None, False
