"""`solve_many`: many small LCPs together."""

from __future__ import annotations

from concurrent.futures import Executor
from functools import partial
from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arguments.checks import instance_with
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.linear.threads import one_thread
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.lockstep import lemke_bases
from problems.lcp.proof.pieces import all_faces
from problems.lcp.proof.stacked import faces_in_doubt, judged
from problems.lcp.search.outcome import Outcome
from problems.lcp.search.solver import solve
from problems.options import check_finite, real_array

LARGEST_TOGETHER = 20
"""Largest order pivoted together: n = 20 takes a tenth of `solve`'s time."""

LARGEST_ALL_FACES = 8
"""Largest order with all faces tried together: n = 8 takes 1.6 ms, where `solve` takes 4 ms."""

TABLE_ENTRIES = 1 << 16
"""Table entries of a batch, which fit the cache."""


@frozen(eq=False)
class Answers:
    """The answers to k problems.

    Attributes
    ----------
    x : Array of shape (k, n)
        The solutions; NaN without one.
    outcome : ndarray of int, shape (k,)
        Each an `Outcome`.
    residual, relative_residual : Array of shape (k,)
        As in `Certificate`; infinite without a point.
    singly : integer array
        Indices solved one by one.
    """

    x: Array
    outcome: NDArray[np.int8]
    residual: Array
    relative_residual: Array
    singly: NDArray[np.intp]

    @property
    def solved(self) -> NDArray[np.bool_]:
        """Which problems are solved, shape (k,)."""
        return np.isin(self.outcome, (Outcome.SOLVED, Outcome.SOLVED_TO_PRECISION))

    def __len__(self) -> int:
        return len(self.outcome)

    def __repr__(self) -> str:
        k, n = self.x.shape
        return f"<Answers: {int(self.solved.sum())} of {k} solved, n = {n}, {self.singly.size} one by one>"


@one_thread
def solve_many(
    A: Any, q: Any, *, tolerance: float = 1e-10, budget: Budget | None = None, executor: Executor | None = None
) -> Answers:
    """Solve k problems LCP(q_i, A_i) of one order, or LCP(q_i, A) for one matrix.

    Up to order 20 Lemke's method runs on all together. Up to order 8 all faces of the rest are tried, which finds a
    solution or proves that none exists. `solve` treats the others singly.

    Parameters
    ----------
    A : array_like, shape (k, n, n) or (n, n)
    q : array_like, shape (k, n)
    tolerance : float, default 1e-10
    budget : continuation.Budget, optional
        For each problem solved singly.
    executor : concurrent.futures.Executor, optional
        Runs batches.

    Returns
    -------
    Answers

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument.

    References
    ----------
    Lemke, Management Science 11, 1965; Cottle, Pang and Stone, Algorithm 4.4.5.
    """
    matrices, constants = _stacks(A, q)
    solve(LCP(np.eye(1), np.ones(1)), tolerance=tolerance, budget=budget)
    if executor is not None:
        instance_with("executor", executor, ("map",), "a concurrent.futures.Executor")
    k, n = constants.shape
    together = max(TABLE_ENTRIES // max(n * (n + 2), 1), 1)
    one = partial(_answers, tolerance=tolerance, budget=budget)
    parts = [slice(begin, begin + together) for begin in range(0, max(k, 1), together)]
    given = [matrices[part] for part in parts], [constants[part] for part in parts]
    found = list(map(one, *given) if executor is None else executor.map(one, *given))
    singly = [answers.singly + part.start for answers, part in zip(found, parts)]
    return Answers(
        np.concatenate([answers.x for answers in found]),
        np.concatenate([answers.outcome for answers in found]),
        np.concatenate([answers.residual for answers in found]),
        np.concatenate([answers.relative_residual for answers in found]),
        np.concatenate(singly),
    )


def _stacks(A: Any, q: Any) -> tuple[Array, Array]:
    constants, matrices = real_array("q", q), real_array("A", A)
    if constants.ndim != 2:
        raise ValueError(f"q: expected an array of shape (k, n), found shape {constants.shape}")
    k, n = constants.shape
    if matrices.shape not in ((n, n), (k, n, n)):
        raise ValueError(f"A: expected an array of shape {(k, n, n)} or {(n, n)}, found shape {matrices.shape}")
    for name, entries in (("q", constants), ("A", matrices)):
        check_finite(name, entries)
    return np.broadcast_to(matrices, (k, n, n)), constants


def _answers(A: Array, q: Array, *, tolerance: float, budget: Budget | None) -> Answers:
    k, n = q.shape
    x, outcome = np.full((k, n), np.nan), np.full(k, Outcome.NOT_FOUND, dtype=np.int8)
    residual, relative = np.full(k, np.inf), np.full(k, np.inf)
    left = np.ones(k, dtype=bool)

    def settle(which: NDArray[np.intp], active: NDArray[np.bool_]) -> None:
        solves, *found = judged(A[which], q[which], active, tolerance)
        good = which[solves]
        x[good], residual[good], relative[good] = (values[solves] for values in found)
        outcome[good], left[good] = Outcome.SOLVED, False

    with np.errstate(all="ignore"):
        if 0 < n <= LARGEST_TOGETHER:
            active, ended = lemke_bases(A, q)
            settle(np.flatnonzero(ended), active[ended])
        if 0 < n <= LARGEST_ALL_FACES:
            rest, size = np.flatnonzero(left), max(k >> n, 1)
            for which in (rest[begin : begin + size] for begin in range(0, rest.size, size)):
                doubtful = faces_in_doubt(A[which], q[which])
                none = which[~doubtful.any(axis=1)]
                outcome[none], left[none] = Outcome.UNSOLVABLE, False
                held = doubtful.any(axis=1)
                settle(which[held], all_faces(n)[doubtful[held].argmax(axis=1)])
    singly = np.flatnonzero(left)
    for i in singly:
        found = solve(LCP(A[i], q[i]), tolerance=tolerance, budget=budget)
        outcome[i], residual[i], relative[i] = found.outcome, found.residual, found.relative_residual
        if found.x is not None and found.solved:
            x[i] = found.x
    return Answers(x, outcome, residual, relative, singly)
