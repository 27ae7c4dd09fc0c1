"""What is quickly found out about the matrix; `search.table` decides by it what is tried."""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen

from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import MixedLCP


@frozen
class MatrixFacts:
    """What is known of A; False where it is not so or was not proved.

    `semidefinite`: x'Ax >= 0 for all x, to working precision. Then a feasible problem has a solution. None where not
    asked. `z_matrix`: No positive entry off the diagonal: the active-set method from x = 0 ends within n steps at the
    least element of the feasible set, or proves nothing. `negative_diagonal`: Some a_ii < 0: not copositive, so that
    Wang's path mostly diverges. `nonnegative`: No negative entry: copositive, as the block matrix of a bimatrix game.
    """

    symmetric: bool
    semidefinite: bool | None
    z_matrix: bool
    negative_diagonal: bool
    nonnegative: bool

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
    """What the entries of A tell, at a cost of O(n^2) at most."""
    diagonal = structure.problem.A.diagonal()
    least, largest = _off_diagonal(structure.problem)
    return MatrixFacts(
        symmetric=structure.symmetric,
        semidefinite=None,
        z_matrix=largest <= 0.0,
        negative_diagonal=bool(diagonal.min() < 0.0),
        nonnegative=least >= 0.0 and bool(diagonal.min() >= 0.0),
    )


def matrix_facts(structure: Structure, entries: MatrixFacts | None = None) -> MatrixFacts:
    """The same, and one Cholesky factorisation if A is dense with a nonnegative diagonal.

    `entries`: What `entry_facts` said, where it was asked before.
    """
    known = entry_facts(structure) if entries is None else entries
    return evolve(known, semidefinite=structure.semidefinite)


def _off_diagonal(problem: MixedLCP) -> tuple[float, float]:
    """The least and the largest entry off the diagonal; zeros where there is none."""
    if problem.sparse:
        entries = problem.A.tocoo()
        values = entries.data[entries.row != entries.col]
    else:
        n = problem.n
        # Every entry but the diagonal: drop the first one, then each (n + 1)-th.
        values = problem.A.ravel()[1:].reshape(n - 1, n + 1)[:, :-1] if n > 1 else np.zeros(0)
    return float(values.min(initial=0.0)), float(values.max(initial=0.0))
