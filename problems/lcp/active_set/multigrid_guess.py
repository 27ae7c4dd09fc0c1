"""A guess of the active set of a diffusion-like problem from coarser ones.

Active sets move the contact boundary by about one grid line a step, so the guess comes from problems P'AP, P'q of
algebraic multigrid.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from continuation.arrays import Array, Mask, Matrix
from continuation.counts import Counts
from continuation.linear.factoring import Factoring
from continuation.linear.refine import BACKWARD_ERROR
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.iteration import Policy, iterate
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import BETWEEN, LCP, MixedLCP, State

COARSEST_ORDER = 200
"""Problems up to this order are not coarsened but corrected, at most this often."""

SWEEPS, CORRECTIONS = 20, 3
"""On other levels; with 3 and 1 an obstacle factors six of 805,000 points, not three."""

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
    return _interpolated(problem, _smooth(problem.A), factoring, counts)[0]


def _interpolated(problem: MixedLCP, d: Array, factoring: Factoring, counts: Counts) -> tuple[State, int]:
    P, kept = (None, None) if problem.n <= COARSEST_ORDER else _interpolation(problem.A, d)
    if P is None or P.shape[1] > LEAST_COARSENING * problem.n:
        return _states(problem, problem.near_zero), COARSEST_ORDER
    A, q = sp.csr_array(P.T @ problem.A @ P), P.T @ problem.q
    coarse = LCP(A, q) if problem.standard else MixedLCP(A, q, problem.lower[kept], problem.upper[kept])
    state, steps = _interpolated(coarse, d[kept], factoring, counts)
    found = iterate(Faces(Structure(coarse), factoring=factoring), state, Policy(steps), counts=counts)
    x, diagonal = problem.clipped(P @ coarse.clipped(found.x)), problem.A.diagonal()
    for _ in range(SWEEPS):
        x = problem.clipped(x - DAMPING * problem.w(x) / diagonal)
    return _states(problem, x), CORRECTIONS


def _states(problem: MixedLCP, x: Array) -> State:
    """The state at x; points with w = 0 count as between bounds."""
    w = problem.w(x)
    return np.where(w == 0.0, BETWEEN, problem.states(x, w / problem.A.diagonal()))


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
