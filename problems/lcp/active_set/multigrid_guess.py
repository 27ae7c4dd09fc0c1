"""A guess of the active set of a large sparse problem from smaller ones, for matrices of the diffusion kind.

The active-set method moves the boundary of the contact set by about one grid line a step, so from a poor guess it
takes as many steps as there are lines. The guess of this module comes from coarser problems, P'AP and P'q, by direct
interpolation of algebraic multigrid: no geometry is asked for, and an unsuitable matrix costs time only, since
nothing is called a solution here.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix
from continuation.counts import Counts
from continuation.linear.factoring import Factoring
from continuation.linear.refine import BACKWARD_ERROR
from problems.lcp.active_set.face import Faces, Mask
from problems.lcp.active_set.iteration import Policy, iterate
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import BETWEEN, LCP, MixedLCP, State

COARSEST_ORDER = 200
"""A problem of this order is not made coarser: its faces cost less than the interpolation. So many corrections are made
of it at most, since for an M-matrix each from x = 0 enlarges the active set until it is right, and one on other levels,
where what is still wrong is mended on the next: on 316 x 316 points two faces of each leave two of the finest, of which
one of each leaves three."""

LEAST_COARSENING = 0.8
"""Coarsening that keeps more than this share of the unknowns, where a grid keeps half of them, is given up."""

DAMPING = 0.8
"""Of the damped Jacobi method."""

SMOOTHINGS = 60
"""Of the damped Jacobi method on A d = 0 from ones, where their rows sum to less than zero: units that differ from one
unknown to its neighbours do so on few lines, as those that make a torsion's diagonal alike. Of one with n = 97,020 the
cascade then takes 17 factorisations with 30 sweeps or more, as in the units given, and 31 with 10."""


def suitable(structure: Structure) -> bool:
    """Whether A is large and sparse, with a positive diagonal, and nearly all else is nonpositive.

    `structure`: Of the problem.
    """
    problem = structure.problem
    if not problem.sparse or problem.n <= COARSEST_ORDER or (problem.A.diagonal() <= 0.0).any():
        return False
    few = int(np.count_nonzero(problem.A.data > 0.0)) <= 1.5 * problem.n
    return few and (problem.standard or structure.ranges is None)


def guess(problem: MixedLCP, factoring: Factoring, counts: Counts) -> State:
    """The pieces on which a solution may be, from the coarser problems.

    Parameters
    ----------
    problem : MixedLCP
        One that is `suitable`.
    factoring : Factoring
    counts : Counts
        Where factorisations are added up, those of coarser problems too.
    """
    if not problem.standard:
        # What is zero at a bound is zero there after interpolation.
        low, high = problem.lower, problem.upper
        at = np.where(np.isfinite(low), low, np.where(np.isfinite(high), high, 0.0))
        problem = MixedLCP(problem.A, problem.w(at), low - at, high - at)
    return _interpolated(problem, _smooth(problem.A), factoring, counts)[0]


def _interpolated(problem: MixedLCP, d: Array, factoring: Factoring, counts: Counts) -> tuple[State, int]:
    """The pieces that the next coarser problem says, and how often they are corrected."""
    P, kept = (None, None) if problem.n <= COARSEST_ORDER else _interpolation(problem.A, d)
    if P is None or P.shape[1] > LEAST_COARSENING * problem.n:
        return _states(problem, problem.near_zero), COARSEST_ORDER
    A, q = sp.csr_array(P.T @ problem.A @ P), P.T @ problem.q
    coarse = LCP(A, q) if problem.standard else MixedLCP(A, q, problem.lower[kept], problem.upper[kept])
    state, steps = _interpolated(coarse, d[kept], factoring, counts)
    found = iterate(Faces(Structure(coarse), factoring=factoring), state, Policy(steps), counts=counts)
    x, diagonal = problem.clipped(P @ coarse.clipped(found.x)), problem.A.diagonal()
    # Interpolation is wrong by a few lines about the boundary of the contact set, which sweeps mend.
    for _ in range(3):
        x = problem.clipped(x - DAMPING * problem.w(x) / diagonal)
    return _states(problem, x), 1


def _states(problem: MixedLCP, x: Array) -> State:
    """The pieces at a point; where w = 0, far from all that pushes, between the bounds: else they join one by one."""
    w = problem.w(x)
    return np.where(w == 0.0, BETWEEN, problem.states(x, w / problem.A.diagonal()))


def _smooth(A: Matrix) -> Array:
    """What interpolation is to reproduce, d > 0 with A d of about zero: ones, but for the units of the unknowns."""
    d, diagonal = np.ones(A.shape[0]), A.diagonal()
    for _ in range(SMOOTHINGS):
        off = (A @ d) / diagonal
        if (off >= -BACKWARD_ERROR * d).all():
            break
        d = np.maximum(d - DAMPING * off, 0.1 * d)
    return d


def _interpolation(A: Matrix, d: Array) -> tuple[Matrix, NDArray[np.intp]]:
    """Direct interpolation from an independent set of unknowns, taken greedily in the given order, and that set."""
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
    """A maximal set of unknowns no two of which are neighbours: on a grid every second one."""
    n = A.shape[0]
    if A.nnz == 3 * n - 2 and (np.abs(A.indices - np.repeat(np.arange(n), np.diff(A.indptr))) <= 1).all():
        # A chain, where that is what the loop below finds.
        return np.asarray(np.arange(n) % 2 == 0)
    starts, neighbours = A.indptr.tolist(), A.indices.tolist()
    taken = [0] * n
    for i in range(n):
        if not taken[i]:
            for j in neighbours[starts[i] : starts[i + 1]]:
                taken[j] = taken[j] or 2
            taken[i] = 1
    return np.asarray(np.array(taken) == 1)
