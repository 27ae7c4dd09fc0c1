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
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP
from problems.lcp.proof.compensated import accurate_w

Mask = NDArray[np.bool_]
Solver = Callable[[Array], Array]

SINGULAR = 1e-14
"""Reciprocal condition below which a face counts as singular."""

DOUBTFUL = 1e-6
"""Ratio of the smallest to the largest pivot below which the condition is estimated."""

EPS = float(np.finfo(float).eps)

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
            # From zero, where w = q, one solve is all that exact factors need.
            for _ in range(1 if self.exact else CORRECTIONS):
                x = self._corrected(x, self.problem.q if self.exact else self.problem.w(x))
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

    def face(self, active: Mask, shift: float = 0.0) -> Face | None:
        """The face of an active set, factored, with `shift` added to the diagonal; None where that is impossible."""
        inside = np.flatnonzero(active)
        if inside.size == 0:
            return Face(self.problem, active, lambda r: r, True)
        if self.structure.band is not None:
            solver, exact = self._banded(active, shift), True
        elif self.problem.sparse:
            solver, exact = _sparse(self.problem.A[inside][:, inside], shift)
        else:
            solver, exact = self._dense(inside, shift)
        return None if solver is None else Face(self.problem, active, solver, exact)

    def _dense(self, inside: NDArray[np.intp], shift: float) -> tuple[Solver | None, bool]:
        # Rows, then columns: the quickest of numpy's ways, and the block comes out in LAPACK's order.
        block = np.asfortranarray(self.problem.A[inside][:, inside])
        block[np.diag_indices(inside.size)] += shift
        if self.structure.symmetric and (solver := _cholesky(block)) is not None:
            return solver, True
        # Whether A is semidefinite is asked only once a factorisation has failed: the answer costs one of order n.
        definite = self.structure.symmetric and self.structure.semidefinite
        if not definite and (solver := _lu(block)) is not None:
            return solver, True
        block[np.diag_indices(inside.size)] += SHIFT * max(_norm(block), 1e-300)
        return (_cholesky if definite else _lu)(block), False

    def _banded(self, active: Mask, shift: float) -> Solver | None:
        """In the band of the whole matrix, with unit rows off the face: no index is moved."""
        band = self.structure.band
        assert band is not None
        n, lower, upper = active.size, band.lower, band.upper
        room = np.zeros((2 * lower + upper + 1, n), order="F")
        for k in range(-lower, upper + 1):
            begin, end = max(0, -k), min(n, n - k)
            room[lower + upper - k, begin + k : end + k] = (active * band.rows[lower + k])[begin:end]
        room[lower + upper] += shift
        room[lower + upper, ~active] = 1.0
        lu, pivots, info = dgbtrf(room, lower, upper, overwrite_ab=1)

        def solve(right: Array) -> Array:
            whole = np.zeros(n)
            whole[active] = right
            solution: Array = dgbtrs(lu, lower, upper, whole, pivots)[0].ravel()
            return solution[active]

        return solve if info == 0 else None


def _norm(block: Array) -> float:
    return float(np.abs(block).sum(axis=0).max())


def _cholesky(block: Array) -> Solver | None:
    factor, info = dpotrf(block, lower=1, clean=0)
    if info != 0 or factor.diagonal().min() ** 2 < EPS * block.shape[0] * block.diagonal().max():
        return None
    return lambda right: np.asarray(dpotrs(factor, right, lower=1)[0]).ravel()


def _lu(block: Array) -> Solver | None:
    factors, swaps, info = dgetrf(block)
    if info != 0:
        return None
    pivots = np.abs(factors.diagonal())
    # The condition is estimated only where the pivots make it doubtful: at these orders it costs half a factorisation.
    if pivots.min() < DOUBTFUL * pivots.max() and dgecon(factors, _norm(block))[0] < SINGULAR:
        return None
    return lambda right: np.asarray(dgetrs(factors, swaps, right)[0]).ravel()


def _sparse(block: Matrix, shift: float) -> tuple[Solver | None, bool]:
    block = sp.csc_array(block)
    if shift:
        block = sp.csc_array(block + shift * sp.eye_array(block.shape[0]))
    try:
        return splu(block, permc_spec="MMD_AT_PLUS_A").solve, True
    except RuntimeError:  # SuperLU's word for an exact zero pivot
        pass
    norm = float(abs(block).sum(axis=0).max())
    try:
        return splu(sp.csc_array(block + SHIFT * max(norm, 1e-300) * sp.eye_array(block.shape[0]))).solve, False
    except RuntimeError:
        return None, False
