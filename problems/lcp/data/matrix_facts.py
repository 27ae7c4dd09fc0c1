"""Cheap facts about the matrix; `search.table` chooses methods by them."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen

from problems.lcp.data.matrix_structure import Structure


@frozen(eq=False, slots=False)
class MatrixFacts:
    """Facts about A, computed on demand; False where untrue or unproved."""

    structure: Structure

    @property
    def symmetric(self) -> bool:
        """Whether A = A'."""
        return self.structure.symmetric

    @cached_property
    def semidefinite(self) -> bool:
        """Whether A is positive semidefinite to working precision: then a feasible LCP is solvable."""
        return self.structure.semidefinite

    @cached_property
    def negative_diagonal(self) -> bool:
        """Whether some a_ii < 0: not copositive, Wang's path mostly diverges."""
        return bool(self.structure.problem.A.diagonal().min() < 0.0)

    @property
    def z_matrix(self) -> bool:
        """Whether off-diagonal entries are <= 0.

        Then active sets from x = 0 reach the least feasible element within n steps, or fail.
        """
        return self._off_diagonal[1] <= 0.0

    @property
    def nonnegative(self) -> bool:
        """Whether all entries are >= 0: copositive, as for bimatrix games."""
        return self._off_diagonal[0] >= 0.0 and not self.negative_diagonal

    @cached_property
    def _off_diagonal(self) -> tuple[float, float]:
        problem = self.structure.problem
        if problem.sparse:
            entries = problem.A.tocoo()
            values = entries.data[entries.row != entries.col]
        else:
            n = problem.n
            # Drops the diagonal.
            values = problem.A.ravel()[1:].reshape(n - 1, n + 1)[:, :-1] if n > 1 else np.zeros(0)
        return float(values.min(initial=0.0)), float(values.max(initial=0.0))

    def __str__(self) -> str:
        parts = ["symmetric" if self.symmetric else "not symmetric"]
        if "semidefinite" in vars(self):
            parts.append("positive semidefinite" if self.semidefinite else "not known to be positive semidefinite")
        said = {
            "Z": self.z_matrix,
            "nonnegative": self.nonnegative,
            "a negative diagonal entry": self.negative_diagonal,
        }
        return ", ".join([*parts, *(name for name, holds in said.items() if holds)])
