"""Starts of almost complementary paths."""

from __future__ import annotations

import math

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, largest
from problems.lcp.data.problem import LCP
from problems.lcp.data.spread import largest_entries
from problems.lcp.pivoting.almost import PATH_LEFT, AlmostComplementary, Ended
from problems.lcp.pivoting.dictionary import TIE, Dictionary


def unit_of(problem: LCP) -> float:
    """The power of two next to A's largest entry, which divides tables."""
    most = largest_entries(problem)[1]
    return math.ldexp(1.0, min(math.frexp(most)[1], 1023)) if most > 0.0 else 1.0


def covering(problem: LCP, d: Array, active: NDArray[np.bool_] | None = None) -> AlmostComplementary | None:
    """The path of LCP(q + t d, A) as t falls to zero: Lemke's method from infinity, or from the solution at t = 1.

    `d`, (n,): positive for a start at infinity. `active`, (n,): where x may be positive at t = 1; None if its face
    holds no solution.

    References
    ----------
    Lemke, Management Science 11, 1965; Cottle, Pang and
    Stone, Algorithm 4.4.5 and sections 4.5 and 4.9.
    """
    n = problem.n
    t = 2 * n
    # By columns, as pivots need.
    first = np.empty((n, n + 2), order="F")
    first[:, :n] = problem.A.toarray() if problem.sparse else problem.A
    first[:, n], first[:, n + 1] = d, problem.q
    first /= unit_of(problem)
    dictionary = Dictionary(first, np.arange(n), np.arange(n, 2 * n + 1))
    if active is not None and active.any():
        dictionary.basic = np.where(active, np.arange(n, 2 * n), np.arange(n))
        dictionary.nonbasic = np.append(np.where(active, np.arange(n), np.arange(n, 2 * n)), t)
        if np.isnan(dictionary.rebuilt()):
            return None
        # Constants below zero at t = 1 are rounding.
        short = -(dictionary.table[:, -1] + dictionary.table[:, dictionary.column(t)])
        if short.max() > -PATH_LEFT * largest(dictionary.table[:, -1]):
            return None
        dictionary.table[:, -1] += np.maximum(short, 0.0)
    column = dictionary.column(t)
    assert column is not None
    path = AlmostComplementary(n, (dictionary,), t, frozenset({t}))
    constants = dictionary.table[:, -1]
    if constants.min() >= (0.0 if active is None else -TIE * largest(constants)):
        path.ended = Ended.REACHED
        return path
    row = dictionary.last_zero(column)
    if row is None:
        return None
    path.left(dictionary.pivot(row, column))
    constants = dictionary.table[:, -1]
    return path if constants.min() >= PATH_LEFT * np.abs(constants).max() else None


@frozen(eq=False)
class Game:
    """A bimatrix game as an LCP: ``A = [[0, C], [D', 0]]`` with positive costs C and D, and q < 0.

    `actions`: of the first player.
    """

    problem: LCP
    actions: int

    @classmethod
    def of(cls, problem: LCP) -> Game | None:
        """The game of a dense LCP, or None."""
        A, n = problem.A, problem.n
        if problem.sparse or n < 2 or A[0, 0] != 0.0 or not (problem.q < 0.0).all():
            return None
        m = int(np.argmax(A[0] != 0.0))
        if m == 0 or A[:m, :m].any() or A[m:, m:].any() or not ((A[:m, m:] > 0.0).all() and (A[m:, :m] > 0.0).all()):
            return None
        return cls(problem, m)

    def path(self, label: int) -> AlmostComplementary:
        """The path on which one label (0 to n - 1) may be missing.

        References
        ----------
        Lemke and Howson, SIAM J. Appl. Math. 12, 1964.
        """
        n, m = self.problem.n, self.actions
        players = (0, m), (m, n)
        own, other = players[::-1] if label >= m else players
        tables = tuple(self._dictionary(mine, theirs) for mine, theirs in ((own, other), (other, own)))
        path = AlmostComplementary(n, tables, label + n, frozenset({label, label + n}))
        for table in tables:
            column = table.column(path.entering)
            row = None if column is None else table.last_zero(column)
            assert column is not None
            assert row is not None  # costs are positive
            path.left(table.pivot(row, column))
        return path

    def _dictionary(self, mine: tuple[int, int], theirs: tuple[int, int]) -> Dictionary:
        columns, rows = slice(*mine), slice(*theirs)
        first = np.empty((theirs[1] - theirs[0], mine[1] - mine[0] + 1), order="F")
        first[:, :-1], first[:, -1] = self.problem.A[rows, columns], self.problem.q[rows]
        first /= unit_of(self.problem)
        return Dictionary(first, np.arange(*theirs), np.arange(*mine) + self.problem.n)
