"""Sparse factorisations by SuperLU, or by CHOLMOD if installed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from typing import Any

import numpy as np
from attrs import define, field

from continuation.arrays import Array, Matrix
from continuation.linear.refine import BACKWARD_ERROR
from continuation.linear.superlu import factor_superlu, superlu_sign
from continuation.linear.system import Solver

SPARSE_METHODS = ("auto", "superlu", "cholmod")

CHOLMOD_FROM = 1000
"""Least order for CHOLMOD: on five-point Laplacians it takes half of SuperLU's time from 2,000 on, more below 400."""


def check_method(argument: str, name: object) -> str:
    """The method's name; ValueError if unknown, ImportError if not installed."""
    if not isinstance(name, str) or name not in SPARSE_METHODS:
        found = repr(name) if isinstance(name, str) else type(name).__name__
        raise ValueError(f"{argument}: expected one of {', '.join(SPARSE_METHODS)}, found {found}")
    if name == "cholmod" and find_spec("cvxopt") is None:
        raise ImportError(f"{argument}={name!r} needs cvxopt: pip install 'pseudoarclength[{name}]'")
    return name


@define(eq=False)
class Factoring:
    """Factors sparse matrices; `used` counts them by method.

    `method`: "auto", "superlu", or "cholmod" for definite matrices. `weak_pivots`: SuperLU keeps weak diagonal pivots
    of symmetric patterns, to save fill; refinement corrects.
    """

    method: str = "auto"
    weak_pivots: bool = True
    used: dict[str, int] = field(factory=dict, init=False)

    def factor(self, matrix: Matrix) -> Solver | None:
        """Factors of a square matrix, csc, in canonical format; None if singular."""
        wanted = matrix.shape[0] >= CHOLMOD_FROM and find_spec("cvxopt") is not None
        diagonal, rows = matrix.diagonal(), matrix.tocsr()
        matrix.sort_indices()
        symmetric = bool(diagonal.all()) and all(
            np.array_equal(getattr(rows, part), getattr(matrix, part)) for part in ("indptr", "indices")
        )
        if symmetric and (self.method == "cholmod" or (self.method == "auto" and wanted)):
            factor = factor_definite(matrix, diagonal, rows)
            if factor is not None:
                return self._counted("CHOLMOD", factor)
        how: dict[str, Any] = {"permc_spec": "COLAMD"}
        if symmetric or not self.weak_pivots:
            # For symmetric patterns MMD halves the fill.
            how["permc_spec"] = "MMD_AT_PLUS_A"
        if symmetric and self.weak_pivots:
            how |= {"diag_pivot_thresh": 1e-3, "options": {"SymmetricMode": True}}
        lu = factor_superlu(matrix, **how)
        return None if lu is None else self._counted("SuperLU", Solver(lu.solve, partial(superlu_sign, lu)))

    def _counted(self, name: str, factor: Solver) -> Solver:
        self.used[name] = self.used.get(name, 0) + 1
        return factor

    def __str__(self) -> str:
        parts = "; ".join(f"{count} by {name}" for name, count in self.used.items())
        return f"Sparse factorisations: {parts}." if parts else ""


def factor_definite(matrix: Matrix, diagonal: Array, rows: Matrix) -> Solver | None:
    """Factors of a positive or negative definite matrix of symmetric pattern, given as csc and csr; or None."""
    # A discretised Laplacian is negative definite; det A = (-1)^n det(-A).
    side = np.sign(diagonal[0])
    root = np.sqrt(np.abs(diagonal))
    size = root[matrix.indices] * np.repeat(root, np.diff(matrix.indptr))
    rounded = (np.abs(matrix.data - rows.data) <= BACKWARD_ERROR * size).all()
    solve = factor_cholmod(side * matrix) if rounded and (diagonal * side > 0.0).all() else None
    if solve is None:
        return None
    return Solver(lambda rhs: side * solve(rhs), lambda: int(side) ** matrix.shape[0])


def factor_cholmod(matrix: Matrix) -> Callable[[Array], Array] | None:
    """A solver by Cholesky factors (Chen et al., ACM Trans. Math. Softw. 35, 2008); None if not positive definite."""
    from cvxopt import cholmod, spmatrix
    from cvxopt import matrix as column

    entries = matrix.tocoo()
    lower = entries.row >= entries.col
    data, rows, columns = (np.ascontiguousarray(part[lower]) for part in (entries.data, entries.row, entries.col))
    whole = spmatrix(data, rows.astype(np.int64), columns.astype(np.int64), matrix.shape)
    factors = cholmod.symbolic(whole)
    try:
        cholmod.numeric(whole, factors)
    except ArithmeticError:
        return None

    def solve(rhs: Array) -> Array:
        x = column(rhs)
        cholmod.solve(factors, x)
        return np.array(x).ravel()

    return solve
