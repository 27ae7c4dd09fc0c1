"""What a cheap look at the matrix proves, and what that decides about the search."""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen

from problems.lcp.data.problem import LCP
from problems.lcp.homotopies import Structure


@frozen
class MatrixFacts:
    """What is known of A; False where it is not so or was not proved.

    Attributes
    ----------
    symmetric : bool
    semidefinite : bool or None
        x'Ax >= 0 for all x, to working precision. Then a feasible problem has a solution. None where not asked.
    z_matrix : bool
        No positive entry off the diagonal: the active-set method from x = 0 ends within n steps at the least element
        of the feasible set, or proves nothing.
    negative_diagonal : bool
        Some a_ii < 0: not copositive, so that Wang's path mostly diverges.
    nonnegative : bool
        No negative entry: copositive, as the block matrix of a bimatrix game.
    """

    symmetric: bool
    semidefinite: bool | None
    z_matrix: bool
    negative_diagonal: bool
    nonnegative: bool

    @property
    def names(self) -> tuple[str, ...]:
        """The homotopies to try from their default starts, in order."""
        if self.negative_diagonal:
            return ("kkt",)
        return ("wang", "kkt")

    def __str__(self) -> str:
        parts = ["symmetric" if self.symmetric else "not symmetric"]
        if self.semidefinite is not None:
            parts.append("positive semidefinite" if self.semidefinite else "not known to be positive semidefinite")
        if self.z_matrix:
            parts.append("Z")
        if self.nonnegative:
            parts.append("nonnegative")
        if self.negative_diagonal:
            parts.append("a negative diagonal entry")
        return ", ".join(parts)


def entry_facts(structure: Structure) -> MatrixFacts:
    """MatrixFacts at the entries of A, which costs O(n^2) at most."""
    A = structure.problem.A
    diagonal = A.diagonal()
    off = _off_diagonal(structure.problem)
    return MatrixFacts(
        symmetric=structure.symmetric,
        semidefinite=None,
        z_matrix=off[1] <= 0.0,
        negative_diagonal=bool((diagonal < 0.0).any()),
        nonnegative=off[0] >= 0.0 and bool((diagonal >= 0.0).all()),
    )


def matrix_facts(structure: Structure) -> MatrixFacts:
    """The same, and one Cholesky factorisation if A is dense with a nonnegative diagonal."""
    return evolve(entry_facts(structure), semidefinite=structure.semidefinite)


def _off_diagonal(problem: LCP) -> tuple[float, float]:
    """The least and the largest entry off the diagonal; zeros where there is none."""
    if problem.sparse:
        entries = problem.A.tocoo()
        values = entries.data[entries.row != entries.col]
    else:
        n = problem.n
        # Every entry but the diagonal: drop the first one, then each (n + 1)-th.
        values = problem.A.ravel()[1:].reshape(n - 1, n + 1)[:, :-1] if n > 1 else np.zeros(0)
    return float(values.min(initial=0.0)), float(values.max(initial=0.0))
