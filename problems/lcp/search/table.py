"""The methods of `solve` and their order.

A solution lies on one of 2^n complementary faces. Active sets move to the face that the last signs ask for, pivots to a
neighbour, reflections through points of no face, paths through interior points; exclusion proves many faces empty at
once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

from attrs import frozen

from problems.lcp.search.active_sets import ActiveSets
from problems.lcp.search.exclusion import LARGEST_TREE, Exclusion, Leaves, few_faces
from problems.lcp.search.paths import Paths
from problems.lcp.search.pivots import Pivots, game, pivotable
from problems.lcp.search.reflections import Reflections, reflectable
from problems.lcp.search.search import Search


class Method(Protocol):
    """A method for one problem; a second call continues it."""

    def run(self, work: float) -> str:
        """Say what settled the problem, or ""."""


@frozen
class Row:
    """A method, its condition, and its work in `unit`."""

    name: str
    method: Callable[[Search], Method]
    when: Callable[[Search], bool]
    work: float
    unit: str


def always(search: Search) -> bool:
    """Any problem."""
    return True


AUTOMATIC = (
    Row("active sets", ActiveSets, lambda s: not game(s), 30, "corrections of each guess"),
    Row("all faces", Leaves, few_faces, 8, "faces in doubt"),
    Row("pivots", Pivots, pivotable, 10, "pivots times the order, at most 9e6 over it"),
    Row("few groups of faces", Exclusion, lambda s: s.problem.n <= LARGEST_TREE, 100, "linear programs"),
    Row("reflections", Reflections, reflectable, 4, "rounds, of 4e8 iterations times n^2 at most"),
    Row("groups of faces", Exclusion, always, 10_000, "linear programs, of n <= 40, else one"),
    Row("paths", Paths, always, 1, "path of each homotopy"),
    Row("reflections, further", Reflections, reflectable, 16, "rounds"),
    Row("restarts", Paths, lambda s: s.asked.restarts > 0, math.inf, "paths, as many as were asked for"),
)
"""For any matrix."""

*_, _GROUPS, _PATHS, _REFLECTIONS, _RESTARTS = AUTOMATIC

PATHS = (_PATHS, _GROUPS, _REFLECTIONS, _RESTARTS)
"""If a path is wanted."""

NAMED = (_PATHS, Row("root", Exclusion, always, 0, "linear programs beside the first"), _RESTARTS)
"""For a homotopy by name."""


def settled_by(search: Search, table: tuple[Row, ...]) -> str:
    """Run the rows in order; say what settled the problem, or ""."""
    made: dict[Callable[[Search], Method], Method] = {}
    for row in table:
        if row.when(search):
            if row.method not in made:
                made[row.method] = row.method(search)
            if said := made[row.method].run(row.work):
                return said
            if search.exhausted:
                break
    return ""
