"""Proofs that a feasible LCP has no solution: multipliers exclude groups of complementary faces.

A group fixes some x_i = 0 and some w_i = 0. If y_i >= 0 unless w_i is fixed, and (A'y)_j <= 0 unless x_j is fixed, its
points have 0 <= y'w - (A'y)'x = q'y; so q'y < 0 excludes it (Farkas). Groups that cover all faces exclude all.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from problems.lcp.classes.exact import IntRow, indices, solve
from problems.lcp.classes.faces import face_point, whole_numbers
from problems.lcp.data.problem import LCP
from problems.lcp.proof.inequalities import Conditions, conditions_of
from problems.lcp.proof.pieces import SMALLEST_NORMAL, SUM_OF_TERMS_ROUNDING
from problems.lcp.proof.rational import integers

Fixed = NDArray[np.bool_]
"""Which of x, then of w, are fixed at zero, shape (2n,)."""


@frozen(eq=False)
class Group:
    """Faces with common fixed variables, and why none holds a solution.

    The multiplier `y` holds floats or integers, or is None for one face decided in rationals.
    """

    fixed: Fixed
    y: Array | tuple[int, ...] | None


@frozen(eq=False)
class Groups:
    """Groups without solutions that cover all faces."""

    groups: tuple[Group, ...]

    def __len__(self) -> int:
        return len(self.groups)

    @property
    def root(self) -> list[int] | None:
        """A Farkas vector that excludes all faces, if any."""
        one = self.groups[0] if len(self.groups) == 1 else None
        return None if one is None or one.y is None or one.fixed.any() else _whole(one.y)

    def in_units(self, rows: NDArray[np.int64]) -> Groups:
        """Undo a scaling of rows by 2^rows, shape (n,)."""

        def moved(group: Group) -> Group:
            if group.y is None:
                return group
            whole, least = _whole(group.y), int(rows.min())
            return evolve(group, y=tuple(value << (int(power) - least) for value, power in zip(whole, rows)))

        return Groups(tuple(moved(group) for group in self.groups))

    def holds(self, problem: LCP) -> bool:
        """Whether the groups prove that the problem has no solution."""
        return self.complete and all(map(Excluding(problem).exactly, self.groups))

    @property
    def complete(self) -> bool:
        """Whether the groups cover every face."""
        if not self.groups:
            return False
        fixed = np.array([group.fixed for group in self.groups])
        return _all_of_them(fixed.reshape(len(fixed), 2, -1))


def _whole(y: Array | Sequence[int]) -> list[int]:
    return integers(y)[0] if isinstance(y, np.ndarray) else list(y)


def _all_of_them(groups: NDArray[np.bool_]) -> bool:
    """Whether groups, of shape (number, 2, n), cover all faces: recursion over a pair that each fixes."""
    if not groups.size:
        return bool(len(groups))
    if not groups.any(axis=(1, 2)).all():
        return True
    dividing = np.flatnonzero(np.logical_and.reduce(groups[:, 0] ^ groups[:, 1], axis=0))
    if not dividing.size:
        return False
    i = int(dividing[0])
    rest = np.delete(groups, i, axis=2)
    return all(_all_of_them(rest[groups[:, side, i]]) for side in (0, 1))


@frozen(eq=False, slots=False)
class Excluding:
    """Finds and checks multipliers for one dense problem."""

    problem: LCP

    @cached_property
    def slopes(self) -> Array:
        """Coefficients of x and w in 0 = q'y - y'w + (A'y)'x from y, shape (2n, n)."""
        return np.vstack([-self.problem.A.T, np.eye(self.problem.n)])

    @cached_property
    def _sizes(self) -> Array:
        return np.abs(self.slopes)

    @cached_property
    def exact(self) -> tuple[list[list[int]], list[int], Conditions]:
        """A and q in integers, and conditions on multipliers."""
        return *whole_numbers(self.problem)[:2], conditions_of(self.problem)

    def group(self, fixed: Fixed, basic: NDArray[np.intp], row: int, sign: float) -> Group | None:
        """The group, if a dictionary's row makes its basic variable times `sign` negative.

        Adding a little of the other rows exceeds rounding; otherwise integers are used.
        """
        right = np.zeros((basic.size, 2))
        right[:, 1] = ~fixed[basic]
        right[row] = sign, 0.0
        try:
            solved = np.linalg.solve(self.slopes[basic], right)
        except np.linalg.LinAlgError:
            return None
        terms, gaps = self.slopes @ solved, self.problem.q @ solved
        terms[basic] = right
        falling = ~fixed & (terms[:, 1] < 0.0)
        falling[basic] = False
        share = 0.5 * float((terms[falling, 0] / -terms[falling, 1]).min(initial=2.0))
        if gaps[1] > 0.0:
            share = min(share, -0.5 * gaps[0] / gaps[1])
        y = solved[:, 0] + max(share, 0.0) * solved[:, 1]
        y = np.where(fixed[y.size :], y, np.maximum(y, 0.0))
        if self._clearly(fixed, y):
            return Group(fixed, y)
        found = self._solved(basic, row, int(sign))
        group = None if found is None else Group(fixed, tuple(found))
        return group if group is not None and self.exactly(group) else None

    def _clearly(self, fixed: Fixed, y: Array) -> bool:
        n, q = y.size, self.problem.q
        unit, size = (n + 4) * SUM_OF_TERMS_ROUNDING, np.abs(y)
        terms = self._sizes[:n] @ size
        below = self.slopes[:n] @ y >= unit * terms + SMALLEST_NORMAL
        if not (below | fixed[:n] | (terms == 0.0)).all():
            return False
        return bool(q @ y + unit * (np.abs(q) @ size) + SMALLEST_NORMAL < 0.0)

    def _solved(self, basic: NDArray[np.intp], row: int, sign: int) -> list[int] | None:
        entries, q, _ = self.exact
        n = len(q)
        rows: list[IntRow] = [
            [-line[k] for line in entries] if k < n else [int(i == k - n) for i in range(n)] for k in basic.tolist()
        ]
        found = solve(rows, [[sign * (i == row)] for i in range(n)])
        return None if found is None else [value[0] for value in found[0]]

    def exactly(self, group: Group) -> bool:
        """Whether the group holds no solution, exactly."""
        entries, q, conditions = self.exact
        n, fixed = len(q), group.fixed.tolist()
        if group.y is None:
            face = sum(1 << i for i in range(n) if not fixed[i])
            single = all(a != b for a, b in zip(fixed[:n], fixed[n:]))
            return single and face_point(entries, q, indices(face)) is None
        upper = [0.0 if here else np.inf for here in fixed[:n]]
        gap = evolve(conditions, upper=upper, signs=[(True, here) for here in fixed[n:]]).gap(_whole(group.y))
        return gap is not None and gap < 0
