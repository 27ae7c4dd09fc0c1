"""A guess of the active set of a diffusion-like problem by algebraic multigrid.

Active sets move the contact boundary by about one grid line a step. From the coarsest of the problems P'AP, P'q on, the
point is corrected on its face by flexible GMRES, preconditioned by a V-cycle on the faces of the coarser ones.

References
----------
Hoppe, SIAM J. Numer. Anal. 24 (1987).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from attrs import define
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, gcrotmk

from continuation.arrays import EPS, Array, Mask, Matrix, finite
from continuation.counts import Counts
from continuation.linear.factoring import Factoring
from continuation.linear.refine import BACKWARD_ERROR
from continuation.linear.silence import without_warnings
from problems.lcp.active_set.face import Face, Faces
from problems.lcp.active_set.iteration import Policy, iterate
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import BETWEEN, LCP, MixedLCP, State

COARSEST_ORDER = 200
"""Problems up to this order are not coarsened but corrected, at most this often."""

FACES, STEPS, SWEEPS = 16, 3, 2
"""Most faces of a level, steps of GMRES on each, and Jacobi sweeps between. Of 40,000 points one factorisation is left;
with strong convection eight faces leave six; with coefficients that jump two steps leave three, one sweep two."""

LEAST_COARSENING = 0.8
"""Coarsening stops if a larger share of the unknowns remains; a grid keeps half."""

DAMPING = 0.8
"""Damping of Jacobi's method."""

SMOOTHINGS = 60
"""Jacobi sweeps on A d = 0 from ones, if rows sum to less than zero. A torsion of n = 97,020, scaled, takes 17
factorisations after 30 sweeps, 31 after 10."""


def suitable(structure: Structure) -> bool:
    """Whether A is large and sparse, with positive diagonal and few other positive entries."""
    problem = structure.problem
    if not problem.sparse or problem.n <= COARSEST_ORDER or (problem.A.diagonal() <= 0.0).any():
        return False
    return int(np.count_nonzero(problem.A.data > 0.0)) <= 1.5 * problem.n


def guess(problem: MixedLCP, factoring: Factoring, counts: Counts) -> State:
    """The state guessed from coarser problems."""
    if not problem.standard:
        low, high = problem.lower, problem.upper
        at = np.where(np.isfinite(low), low, np.where(np.isfinite(high), high, 0.0))
        problem = MixedLCP(problem.A, problem.w(at), low - at, high - at)
    return _solved(problem, _smooth(problem.A), factoring, counts).state


@define(eq=False)
class Level:
    """A problem with its point and state; P interpolates from the coarser level, whose unknowns are `kept`.

    One of few unknowns has its face and no coarser level.
    """

    problem: MixedLCP
    diagonal: Array
    x: Array
    state: State
    P: Matrix
    kept: NDArray[np.intp]
    coarser: Level | None = None
    face: Face | None = None

    def swept(self) -> State:
        """The state after projected Jacobi sweeps."""
        problem = self.problem
        for _ in range(SWEEPS):
            self.x = problem.clipped(self.x - DAMPING * problem.w(self.x) / self.diagonal)
        return _states(problem, self.x, self.diagonal)

    def corrected(self) -> None:
        """Improve the point on its face."""
        free, n = self.state == BETWEEN, self.problem.n
        A = LinearOperator((n, n), lambda e: np.where(free, self.problem.A @ e, 0.0), dtype=float)
        M = LinearOperator((n, n), lambda r: self.cycle(free, r), dtype=float)
        gap = np.where(free, -self.problem.w(self.x), 0.0)
        x = self.x + gcrotmk(A, gap, rtol=EPS, m=STEPS, k=0, maxiter=1, M=M)[0] if finite(gap) else gap
        self.x = self.problem.clipped(x) if finite(x) else self.x

    def cycle(self, free: Mask, r: Array) -> Array:
        """About ``A^-1 r`` on the free unknowns, by a V-cycle; r is zero off them."""
        if self.face is not None:
            e = np.zeros(len(r))
            e[self.face.active] = self.face.inverse(r[self.face.active])
            return np.where(free, e, 0.0)
        A, step = self.problem.A, np.where(free, DAMPING / self.diagonal, 0.0)
        e = step * r
        for _ in range(SWEEPS - 1):
            e += step * (r - A @ e)
        if self.coarser is not None:
            below = free[self.kept]
            rest = np.where(below, self.P.T @ np.where(free, r - A @ e, 0.0), 0.0)
            e += np.where(free, self.P @ self.coarser.cycle(below, rest), 0.0)
        for _ in range(SWEEPS):
            e += step * (r - A @ e)
        return e


@without_warnings(all="ignore")
def _solved(problem: MixedLCP, d: Array, factoring: Factoring, counts: Counts) -> Level:
    diagonal, x = problem.A.diagonal(), problem.near_zero
    level = Level(problem, diagonal, x, _states(problem, x, diagonal), *_interpolation(problem.A, d))
    P, kept = level.P, level.kept
    if problem.n <= COARSEST_ORDER:
        faces = Faces(Structure(problem), factoring)
        found = iterate(faces, level.state, Policy(COARSEST_ORDER), counts=counts)
        counts.factorizations += 1
        level.x, level.state, level.face = problem.clipped(found.x), found.state, faces.face(found.state)
        return level
    q = P.T @ problem.q
    if len(kept) <= LEAST_COARSENING * problem.n and finite(q):
        A = sp.csr_array(P.T @ problem.A @ P)
        coarse = LCP(A, q) if problem.standard else MixedLCP(A, q, problem.lower[kept], problem.upper[kept])
        level.coarser = _solved(coarse, d[kept], factoring, counts)
        level.x = problem.clipped(P @ level.coarser.x)
    level.state = level.swept()
    for _ in range(FACES):
        level.corrected()
        before, level.state = level.state, level.swept()
        if np.array_equal(before, level.state):
            break
    return level


def _states(problem: MixedLCP, x: Array, diagonal: Array) -> State:
    """The state at x; points with w = 0 count as between bounds."""
    w = problem.w(x)
    return np.where(w == 0.0, BETWEEN, problem.states(x, w / diagonal))


def _smooth(A: Matrix) -> Array:
    """The vector d > 0 with A d near zero that interpolation reproduces."""
    d, diagonal = np.ones(A.shape[0]), A.diagonal()
    for _ in range(SMOOTHINGS):
        off = (A @ d) / diagonal
        if (off >= -BACKWARD_ERROR * d).all():
            break
        d = np.maximum(d - DAMPING * off, 0.1 * d)
    return d


def _interpolation(A: Matrix, d: Array) -> tuple[Matrix, NDArray[np.intp]]:
    n = A.shape[0]
    coarse = _independent(A)
    column = np.cumsum(coarse) - 1
    entries = A.tocoo()
    i, j, a = entries.row, entries.col, entries.data
    off = (i != j) & (a < 0.0)
    d_a = -a * d[j]
    every = np.bincount(i[off], d_a[off], minlength=n)
    chosen = off & ~coarse[i] & coarse[j]
    own = np.bincount(i[chosen], d_a[chosen], minlength=n)
    diagonal = A.diagonal()
    weight = -a[chosen] * (every / diagonal)[i[chosen]] / own[i[chosen]]
    kept = np.flatnonzero(coarse)
    rows = np.concatenate([i[chosen], kept])
    columns = np.concatenate([column[j[chosen]], column[kept]])
    values = np.concatenate([weight, np.ones(kept.size)])
    return sp.csr_array((values, (rows, columns)), shape=(n, kept.size)), kept


def _independent(A: Matrix) -> Mask:
    n = A.shape[0]
    starts, neighbours = A.indptr.tolist(), A.indices.tolist()
    taken = [0] * n
    for i in range(n):
        if not taken[i]:
            for j in neighbours[starts[i] : starts[i + 1]]:
                taken[j] = taken[j] or 2
            taken[i] = 1
    return np.asarray(np.array(taken) == 1)
