"""What is quickly found out about the matrix; `search.table` decides by it what is tried."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen

from problems.lcp.data.matrix_structure import Structure


@frozen(eq=False, slots=False)
class MatrixFacts:
    """What is known of A, found out where it is asked for; False where it is not so or was not proved."""

    structure: Structure

    @property
    def symmetric(self) -> bool:
        """Whether A = A'."""
        return self.structure.symmetric

    @cached_property
    def semidefinite(self) -> bool:
        """Whether x'Ax >= 0 for all x, to working precision: one factorisation. What is feasible is solvable then."""
        return self.structure.semidefinite

    @cached_property
    def negative_diagonal(self) -> bool:
        """Some a_ii < 0: not copositive, so that Wang's path mostly diverges."""
        return bool(self.structure.problem.A.diagonal().min() < 0.0)

    @property
    def z_matrix(self) -> bool:
        """No positive entry off the diagonal.

        The active-set method from x = 0 ends within n steps at the least element of the feasible set, or nowhere.
        """
        return self._off_diagonal[1] <= 0.0

    @property
    def nonnegative(self) -> bool:
        """No negative entry: copositive, as the block matrix of a bimatrix game."""
        return self._off_diagonal[0] >= 0.0 and not self.negative_diagonal

    @cached_property
    def _off_diagonal(self) -> tuple[float, float]:
        """The least and the largest entry off the diagonal; zeros where there is none."""
        problem = self.structure.problem
        if problem.sparse:
            entries = problem.A.tocoo()
            values = entries.data[entries.row != entries.col]
        else:
            n = problem.n
            # Every entry but the diagonal: drop the first one, then each (n + 1)-th.
            values = problem.A.ravel()[1:].reshape(n - 1, n + 1)[:, :-1] if n > 1 else np.zeros(0)
        return float(values.min(initial=0.0)), float(values.max(initial=0.0))

    def __str__(self) -> str:
        parts = ["symmetric" if self.symmetric else "not symmetric"]
        # What was never asked of the matrix was not needed.
        if "semidefinite" in vars(self):
            parts.append("positive semidefinite" if self.semidefinite else "not known to be positive semidefinite")
        said = {
            "Z": self.z_matrix,
            "nonnegative": self.nonnegative,
            "a negative diagonal entry": self.negative_diagonal,
        }
        return ", ".join([*parts, *(name for name, holds in said.items() if holds)])
