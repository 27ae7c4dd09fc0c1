"""Sparse factorisations by SuperLU, or by PARDISO or CHOLMOD if installed."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from copy import copy
from functools import cache, partial
from importlib.util import find_spec
from typing import Any

import numpy as np
from attrs import define, field
from scipy.sparse import csr_array, tril
from scipy.sparse.csgraph import reverse_cuthill_mckee

from continuation.arrays import Array, Matrix
from continuation.linear.refine import BACKWARD_ERROR
from continuation.linear.superlu import factor_superlu, superlu_sign
from continuation.linear.system import Solver

PACKAGES = {"pardiso": ("pypardiso", 5000), "cholmod": ("cvxopt", 1000)}
"""What factors symmetric matrices if installed, the faster first: the package, and the least order at which it is
faster than SuperLU on five-point Laplacians (PARDISO takes 0.6 of its time at 10,000, 1.3 at 2,500)."""

PIVOT = 0.1
"""SuperLU takes the diagonal pivot if no entry of its column is ten times as large (UMFPACK's threshold)."""

PERTURBED = 13
"""PARDISO's pivots below 1e-13 of the matrix count as zero."""

WIDE = 10.0
"""Width squared by order (1 for squares, m for cubes of m^3 points) from which nested dissection pays: order, factors
and solves of 22^3 points take 0.9 of minimum degree's time, of 44^3 half, of 16^3 1.2, of 316^2 1.8."""


def check_method(argument: str, name: object) -> str:
    """The method's name; ValueError if unknown, ImportError if not installed."""
    known = ("auto", "superlu", *PACKAGES)
    if not isinstance(name, str) or name not in known:
        found = repr(name) if isinstance(name, str) else type(name).__name__
        raise ValueError(f"{argument}: expected one of {', '.join(known)}, found {found}")
    package = PACKAGES[name][0] if name in PACKAGES else None
    if package and find_spec(package) is None:
        raise ImportError(f"{argument}={name!r} needs {package}: pip install 'pseudoarclength[{name}]'")
    return name


@define(eq=False)
class Factoring:
    """Factors sparse matrices; `used` counts them by method.

    `method`: "auto", "superlu", "pardiso" for symmetric matrices, or "cholmod" for definite ones. `weak_pivots`: weak
    diagonal pivots of symmetric patterns are kept, to save fill; refinement corrects.
    """

    method: str = "auto"
    weak_pivots: bool = True
    used: dict[str, int] = field(factory=dict, init=False)

    def factor(self, matrix: Matrix) -> Solver | None:
        """Factors of a square matrix, csc, in canonical format; None if singular."""
        diagonal, rows = matrix.diagonal(), matrix.tocsr()
        matrix.sort_indices()
        symmetric = bool(diagonal.all()) and all(
            np.array_equal(getattr(rows, part), getattr(matrix, part)) for part in ("indptr", "indices")
        )
        suited = [
            name
            for name, (package, least) in PACKAGES.items()
            if self.method == name or (self.method == "auto" and len(diagonal) >= least and find_spec(package))
        ]
        for name in suited if symmetric and suited and symmetric_values(matrix, rows, diagonal) else ():
            definite = name == "cholmod"
            factor = factor_definite(matrix, diagonal) if definite else factor_pardiso(matrix, self.weak_pivots)
            if factor is not None:
                return self._counted(name.upper(), factor)
        how: dict[str, Any] = {"permc_spec": "COLAMD" if self.weak_pivots else "MMD_AT_PLUS_A"}
        if symmetric:
            # Without its symmetric mode SuperLU fills a perforated grid of 8,900 points ten times as much.
            threshold = 1e-3 if self.weak_pivots else PIVOT
            how = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": threshold, "options": {"SymmetricMode": True}}
        lu = factor_superlu(matrix, **how)
        return None if lu is None else self._counted("SuperLU", Solver(lu.solve, partial(superlu_sign, lu)))

    def _counted(self, name: str, factor: Solver) -> Solver:
        self.used[name] = self.used.get(name, 0) + 1
        return factor

    def __str__(self) -> str:
        parts = "; ".join(f"{count} by {name}" for name, count in self.used.items())
        return f"Sparse factorisations: {parts}." if parts else ""


def symmetric_values(matrix: Matrix, rows: Matrix, diagonal: Array) -> bool:
    """Whether a matrix of symmetric pattern, given as csc and csr, is symmetric up to rounding."""
    root = np.sqrt(np.abs(diagonal))
    size = root[matrix.indices] * np.repeat(root, np.diff(matrix.indptr))
    return bool((np.abs(matrix.data - rows.data) <= BACKWARD_ERROR * size).all())


def factor_definite(matrix: Matrix, diagonal: Array) -> Solver | None:
    """Factors of a positive or negative definite matrix, csc; or None."""
    # A discretised Laplacian is negative definite; det A = (-1)^n det(-A).
    side = np.sign(diagonal[0])
    solve = factor_cholmod(side * matrix) if (diagonal * side > 0.0).all() else None
    if solve is None:
        return None
    return Solver(lambda rhs: side * solve(rhs), lambda: int(side) ** matrix.shape[0])


@cache
def _pardiso() -> Any:
    # To make a solver searches the disk for the library; to copy one does not.
    from pypardiso import PyPardisoSolver

    return PyPardisoSolver(mtype=-2)


def _wide(upper: Matrix) -> bool:
    # The width by reverse Cuthill and McKee is about a separator's, whose triangle in the factors is dense.
    place = np.argsort(reverse_cuthill_mckee(upper + upper.T, symmetric_mode=True))
    rows, columns = upper.nonzero()
    return bool(np.abs(place[rows] - place[columns]).max() ** 2.0 > WIDE * len(place))


def factor_pardiso(matrix: Matrix, weak_pivots: bool = True) -> Solver | None:
    """Factors L D L' of a symmetric matrix, csc (Schenk & Gaertner, Electron. Trans. Numer. Anal. 23, 2006).

    None if a pivot is zero.
    """
    from pypardiso.pardiso_wrapper import PyPardisoError

    solver = copy(_pardiso())
    solver.pt, solver.iparm = np.zeros_like(solver.pt), np.zeros_like(solver.iparm)
    upper = csr_array(tril(matrix, format="csc").T)
    # Nested dissection or minimum degree; 1 x 1 pivots, or Bunch and Kaufman's.
    for place, value in ((1, 1), (2, 2 * _wide(upper)), (10, PERTURBED), (21, int(not weak_pivots))):
        solver.set_iparm(place, value)
    factor = Solver(partial(solver.solve, upper), lambda: -1 if solver.get_iparm(23) % 2 else 1)
    # The library holds the factors as long as `solve` holds the matrix.
    weakref.finalize(upper, solver.free_memory, everything=True)
    try:
        solver.factorize(upper)
    except PyPardisoError:
        return None
    return None if solver.get_iparm(14) else factor


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
