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
from problems.lcp.proof.stacked import judged
from problems.lcp.search.outcome import Outcome
from problems.lcp.search.solver import solve
from problems.options import check_finite, real_array

LARGEST_TOGETHER = 20
"""Largest order solved together: n = 20 takes a tenth of `solve`'s time."""

ENTRIES = 1 << 16
"""Matrix entries of a batch, which fit the cache."""


@frozen(eq=False)
class Answers:
    """Answers to k problems.

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

    Up to order 20 block principal pivots run on all together. `solve` treats the others singly.

    Parameters
    ----------
    A : array_like, shape (k, n, n) or (n, n)
    q : array_like, shape (k, n)
    tolerance : float, default 1e-10
    budget : continuation.Budget, optional
        For each problem solved singly.
    executor : concurrent.futures.Executor, optional
        Runs batches.

    Raises
    ------
    TypeError, ValueError
        For bad input, naming the argument.

    References
    ----------
    Judice and Pires, Comput. Oper. Res. 21, 1994.
    """
    matrices, constants = _stacks(A, q)
    solve(LCP(np.eye(1), np.ones(1)), tolerance=tolerance, budget=budget)
    if executor is not None:
        instance_with("executor", executor, ("map",), "a concurrent.futures.Executor")
    k, n = constants.shape
    together = max(ENTRIES // max(n * n, 1), 1)
    one = partial(_answers, tolerance=tolerance, budget=budget)
    parts = [slice(begin, begin + together) for begin in range(0, max(k, 1), together)]
    given = [matrices[part] for part in parts], [constants[part] for part in parts]
    found = list(map(one, *given) if executor is None else executor.map(one, *given))
    singly = np.concatenate([answers.singly + part.start for answers, part in zip(found, parts)])
    names = ("x", "outcome", "residual", "relative_residual")
    whole = {name: np.concatenate([getattr(answers, name) for answers in found]) for name in names}
    return Answers(**whole, singly=singly)


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
    if 0 < n <= LARGEST_TOGETHER:
        with np.errstate(all="ignore"):
            active, found = block_pivots(A, q)
            solves, *values = judged(A[found], q[found], active[found], tolerance)
        good = found[solves]
        x[good], residual[good], relative[good] = (value[solves] for value in values)
        outcome[good], left[good] = Outcome.SOLVED, False
    singly = np.flatnonzero(left)
    for i in singly:
        one = solve(LCP(A[i], q[i]), tolerance=tolerance, budget=budget)
        outcome[i], residual[i], relative[i] = one.outcome, one.residual, one.relative_residual
        if one.x is not None and one.solved:
            x[i] = one.x
    return Answers(x, outcome, residual, relative, singly)


def block_pivots(A: Array, q: Array) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """Active sets (w_i = 0) of many problems, and indices of those that are right but for rounding.

    If four changes leave no fewer wrong indices, only the last one changes, else all, so that P-matrices need finitely
    many changes; at most 2 n + 10 are made.
    """
    k, n = q.shape
    active, left, right = q < 0.0, np.arange(k), np.zeros(k, dtype=bool)
    fewest, vain = np.full(k, n + 1), np.zeros(k, dtype=np.intp)
    for _ in range(2 * n + 10):
        now = active[left]
        faces = np.where(now[:, :, None], A[left], np.eye(n))
        try:
            x = np.linalg.solve(faces, np.where(now, -q[left], 0.0)[..., None])
        except np.linalg.LinAlgError:
            left = left[np.linalg.slogdet(faces)[0] != 0.0]
            continue
        wrong = np.where(now, x[..., 0] <= 0.0, (A[left] @ x)[..., 0] + q[left] < 0.0)
        number = wrong.sum(axis=1)
        right[left[number == 0]] = True
        vain[left] = np.where(number < fewest[left], 0, vain[left] + 1)
        fewest[left] = np.minimum(fewest[left], number)
        last = np.arange(n) == n - 1 - wrong[:, ::-1].argmax(axis=1)[:, None]
        active[left] = now ^ np.where((vain[left] > 3)[:, None], last, wrong)
        left = left[number > 0]
    return active, np.flatnonzero(right)
