"""Implicit enumeration of complementary faces, which linear programs exclude in groups.

A node fixes some x_i and some w_i at zero. If no x >= 0, w >= 0 has these zeros, a row of the dictionary gives a
multiplier for `proof.groups`. Else the point with least c'x is a solution, or a pair x_i > 0, w_i > 0 is fixed either
way.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from attrs import define, field, frozen
from numpy.typing import NDArray

from continuation.arrays import Array, largest
from problems.lcp.classes.exact import indices
from problems.lcp.classes.faces import face_point
from problems.lcp.data.problem import LCP
from problems.lcp.pivoting.dictionary import Dictionary
from problems.lcp.pivoting.starts import unit_of
from problems.lcp.proof.groups import Excluding, Fixed, Group, Groups
from problems.lcp.reference.enumeration import Exhaustion

Active = NDArray[np.bool_]

ROUNDED_TO_ZERO = 1e-9
"""Smaller entries, relative to the largest, cause no pivot: linear programs only guide."""

PIVOTS_PER_NODE = 50
"""Most pivots over the order: none of 600 nodes needed more than the order."""


@frozen(eq=False)
class Node:
    """The fixed variables (x, w, the cost last), and the parent's dictionary."""

    fixed: Fixed
    dictionary: Dictionary


@define(eq=False)
class Branching:
    """One problem's tree.

    `accepts` tells whether the caller accepts the face with these w_i = 0.
    """

    problem: LCP
    accepts: Callable[[Active], bool]
    nodes: int = field(default=0, init=False)
    accepted: bool = field(default=False, init=False)
    _waiting: list[Node] = field(factory=list, init=False)
    _groups: list[Group] = field(factory=list, init=False)
    _excluding: Excluding = field(init=False)
    _found: Exhaustion | None = field(default=None, init=False)
    _given_up: bool = field(default=False, init=False)

    def __attrs_post_init__(self) -> None:
        problem, n = self.problem, self.problem.n
        self._excluding = Excluding(problem)
        costs = 1.0 + np.modf(np.arange(1.0, n + 1.0) * (0.5 + math.sqrt(1.25)))[0]
        rows = np.column_stack([problem.A, problem.q]) / unit_of(problem)
        table = np.vstack([rows, np.append(costs, 0.0)])
        root = Dictionary(table, np.arange(n, 2 * n + 1), np.arange(n))
        self._waiting.append(Node(np.zeros(2 * n + 1, dtype=bool), root))

    @property
    def open(self) -> bool:
        """Whether a started tree has nodes left."""
        return self.nodes > 0 and bool(self._waiting) and not self._given_up

    def run(self, most: int) -> Exhaustion | None:
        """Visit nodes, `most` in all; None if undecided or a face was accepted."""
        while self._waiting and not self._given_up:
            if self.nodes >= most:
                return None
            self.nodes += 1
            if not self._look(self._waiting.pop()):
                self._given_up = True
                return self._found
        groups = Groups(tuple(self._groups))
        return Exhaustion(None, 1 << self.problem.n, groups) if not self._given_up and groups.complete else None

    def _look(self, node: Node) -> bool:
        dictionary, fixed, n = node.dictionary, node.fixed, self.problem.n
        row = infeasible_row(dictionary, fixed)
        if row is None:
            return False
        if row >= 0:
            if not self._excluded(node, row):
                dictionary.rebuilt()
                return self._divided(node, fixed[:n] | fixed[n : 2 * n])
            return True
        values = np.zeros(2 * n)
        basic, constants = dictionary.basic[:n], dictionary.entries(-1)[:n]
        values[basic] = constants
        zero = ROUNDED_TO_ZERO * largest(constants)
        x, w = values[:n], values[n:]
        between = np.minimum(x, w)
        if between.max() > zero:
            i = int(between.argmax())
            self._put(node, i, x_first=bool(x[i] < w[i]))
            return True
        if self.accepts(x > w):
            self.accepted = True
            return False
        entries, q, _ = self._excluding.exact
        point = face_point(entries, q, indices(sum(1 << int(i) for i in (x > w).nonzero()[0])))
        if point is not None:
            self._found = Exhaustion(point.x, self.nodes)
            return False
        return self._divided(node, node.fixed[:n] | node.fixed[n : 2 * n])

    def _excluded(self, node: Node, row: int) -> bool:
        dictionary, n = node.dictionary, self.problem.n
        sign = 1.0 if dictionary.entries(-1)[row] < 0.0 else -1.0
        group = self._excluding.group(node.fixed[: 2 * n], dictionary.basic[:n], row, sign)
        if group is not None:
            self._groups.append(group)
        return group is not None

    def _put(self, node: Node, i: int, x_first: bool) -> None:
        n = self.problem.n
        for variable in (i + n, i) if x_first else (i, i + n):
            fixed = node.fixed.copy()
            fixed[variable] = True
            last = (variable < n) is x_first
            self._waiting.append(Node(fixed, node.dictionary if last else node.dictionary.copied()))

    def _divided(self, node: Node, closed: Active) -> bool:
        if not closed.all():
            self._put(node, int(closed.argmin()), x_first=True)
            return True
        group = Group(node.fixed[: 2 * closed.size], None)
        if not self._excluding.exactly(group):
            return False
        self._groups.append(group)
        return True


def infeasible_row(dictionary: Dictionary, fixed: Fixed) -> int | None:
    """The row that forbids the fixed zeros, by the dual simplex method; -1 if a point has them,
    None if the method does not end. The dictionary changes.
    """
    n = dictionary.nonbasic.size
    for _ in range(PIVOTS_PER_NODE * n):
        constants = dictionary.entries(-1)[:n]
        wrong: Array = np.where(fixed[dictionary.basic[:n]], np.abs(constants), -constants)
        row = int(wrong.argmax())
        if wrong[row] <= ROUNDED_TO_ZERO * largest(constants):
            return -1
        slopes = dictionary.table[row, :n] if constants[row] < 0.0 else -dictionary.table[row, :n]
        rising = ((slopes > ROUNDED_TO_ZERO) & ~fixed[dictionary.nonbasic]).nonzero()[0]
        if not rising.size:
            return row
        ratios = np.maximum(dictionary.table[n, rising], 0.0) / slopes[rising]
        dictionary.pivot(row, int(rising[ratios.argmin()]))
    return None
