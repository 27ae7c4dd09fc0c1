"""A guess of the active set of a large sparse problem from smaller ones, for matrices of the diffusion kind.

The active-set method moves the boundary of the contact set by about one grid line a step, so from a poor guess it
takes as many steps as there are lines. The guess of this module comes from coarser problems, P'AP and P'q, by direct
interpolation of algebraic multigrid: no geometry is asked for, and an unsuitable matrix costs time only, since
nothing is called a solution here.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Array, Matrix
from problems.lcp.active_set.face import Faces, Mask
from problems.lcp.active_set.iteration import Policy, iterate
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, MixedLCP, State

SMALL = 200
"""A problem of this order is not made coarser: its faces cost less than the interpolation."""

COARSEST = Policy(steps=SMALL - 1)
"""There: for an M-matrix each step from x = 0 enlarges the active set until it is right, so this is enough."""

SLOW = 0.8
"""Coarsening that keeps more than this share of the unknowns, where a grid keeps half of them, is given up."""

ELSEWHERE = Policy(steps=11)
"""On every other level: interpolation puts the boundary within a few lines of its place."""


def suitable(structure: Structure) -> bool:
    """Whether it is an LCP, A is large and sparse, with a positive diagonal, and nearly all else is nonpositive.

    Parameters
    ----------
    structure : Structure
        Of the problem.
    """
    problem = structure.problem
    if not (problem.standard and problem.sparse) or problem.n <= SMALL or (problem.A.diagonal() <= 0.0).any():
        return False
    return int(np.count_nonzero(problem.A.data > 0.0)) <= 1.5 * problem.n


def guess(problem: MixedLCP) -> Array:
    """An approximate solution, shape (n,), from the coarser problems; its support is the guess of the active set.

    Parameters
    ----------
    problem : MixedLCP
        One that is `suitable`.
    """
    if problem.n <= SMALL:
        return _corrected(problem, problem.states(problem.near_zero, problem.q), COARSEST)
    P = _interpolation(problem.A)
    if P.shape[1] > SLOW * problem.n:
        return _corrected(problem, problem.states(problem.near_zero, problem.q), ELSEWHERE)
    coarse = LCP(sp.csr_array(P.T @ problem.A @ P), P.T @ problem.q)
    return _corrected(problem, problem.states(P @ guess(coarse), np.zeros(problem.n)), ELSEWHERE)


def _corrected(problem: MixedLCP, state: State, policy: Policy) -> Array:
    """The last point of a few active-set steps, clipped at zero."""
    return np.maximum(iterate(Faces(Structure(problem)), state, policy).x, 0.0)


def _interpolation(A: Matrix) -> Matrix:
    """Direct interpolation from an independent set of unknowns, taken greedily in the given order."""
    n = A.shape[0]
    coarse = _independent(A)
    column = np.cumsum(coarse) - 1
    entries = A.tocoo()
    i, j, a = entries.row, entries.col, entries.data
    off = (i != j) & (a < 0.0)
    every = np.bincount(i[off], -a[off], minlength=n)
    chosen = off & ~coarse[i] & coarse[j]
    own = np.bincount(i[chosen], -a[chosen], minlength=n)
    diagonal = A.diagonal()
    weight = -a[chosen] * (every / diagonal)[i[chosen]] / own[i[chosen]]
    kept = np.flatnonzero(coarse)
    rows = np.concatenate([i[chosen], kept])
    columns = np.concatenate([column[j[chosen]], column[kept]])
    return sp.csr_array((np.concatenate([weight, np.ones(kept.size)]), (rows, columns)), shape=(n, kept.size))


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
