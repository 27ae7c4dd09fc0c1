"""Exact scaling of rows and columns by powers of two.

For positive diagonal R and C, LCP(q, A) and LCP(R q, R A C) have the same solutions up to units. Least squares of
logarithms, then Ruiz's iteration, make the largest entries of rows and columns about 1; the result is the same for all
given units, up to rounding.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import LinearOperator, cg

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.data.spread import alike, largest_entries, near_one

Exponents = NDArray[np.int64]
Indices = NDArray[np.intp]

RUIZ = 8
"""Sweeps: each halves the logarithms of the largest entries."""

GRADIENT_STEPS = 30
"""Conjugate gradient steps: full matrices need one, sparse random ones about ten."""

HALVES = 1e-3
"""Fractions this near to 1/2 are rounded up, as noise would decide."""

NEGLIGIBLE = -27.0
"""Entries with |a_ij a_ji| < 2^-27 |a_ii a_jj| are ignored: those of exp(-d^2) go down to 1e-300."""


@frozen(eq=False)
class Scaled:
    """LCP(R q, R A C), R = diag(2^rows), C = diag(2^columns); its solution u gives x = C u.

    `exact`: whether scaling back gives the same entries.
    """

    problem: MixedLCP
    rows: Exponents
    columns: Exponents
    exact: bool

    def x(self, u: Array) -> Array:
        """The point in given units, perhaps beyond the float range."""
        return _times(u, self.columns)

    def u(self, x: Array) -> Array:
        """The scaled point."""
        return _times(x, -self.columns)

    @property
    def common(self) -> bool:
        """Whether R is a multiple of I, and C = I."""
        return not self.columns.any() and not np.ptp(self.rows).any()


def balanced(problem: MixedLCP) -> Scaled | None:
    """Problem in balanced units, or None if unchanged.

    References
    ----------
    Curtis and Reid, J. Inst. Maths Applics 10, 1972; Ruiz, RAL-TR-2001-034.
    """
    if not problem.standard and alike(problem) and near_one(problem):
        return None
    rows, columns = units(problem)
    if not rows.any() and not columns.any():
        return None
    given = () if problem.standard else (problem.lower, problem.upper)
    bounds = [_times(end, -columns) for end in given]
    if not all(np.array_equal(_times(new, columns), old) for new, old in zip(bounds, given)):
        return None
    scaled = _by(problem, rows, columns, _times(problem.q, rows), *bounds)
    scaled.problem.known["units"] = np.zeros_like(rows), np.zeros_like(columns)
    return scaled


def _by(problem: MixedLCP, rows: Exponents, columns: Exponents, q: Array, *bounds: Array) -> Scaled:
    A = _scaled(problem.A, rows, columns)
    same = abs(_scaled(A, -rows, -columns) - problem.A).max() == 0.0
    exact = bool(same) and np.array_equal(_times(q, -rows), problem.q)
    scaled = MixedLCP(A, q, *bounds, primal=problem.primal) if bounds else LCP(A, q, primal=problem.primal)
    return Scaled(scaled, rows, columns, exact)


def without_far_factor(problem: MixedLCP) -> tuple[Scaled | None, bool]:
    """LCP(s q, s A), s a power of two for extreme entries (None for s = 1), and whether active sets can use it.

    They can if entries are `alike` and s rounds nothing.
    """
    if not alike(problem) or near_one(problem):
        return None, alike(problem)
    rows = np.full(problem.n, 1 - int(np.frexp(largest_entries(problem)[1])[1]))
    q = _times(problem.q, rows)
    scaled = _by(problem, rows, np.zeros_like(rows), q) if np.isfinite(q).all() else None
    return (scaled, True) if scaled is not None and scaled.exact else (None, False)


def units(problem: MixedLCP) -> tuple[Exponents, Exponents]:
    """The exponents of two for rows of [A, q] and columns of A.

    Matrices that are symmetric up to units become symmetric.
    """
    if "units" not in problem.known:
        with np.errstate(divide="ignore", invalid="ignore"):
            problem.known["units"] = _units(problem)
    found: tuple[Exponents, Exponents] = problem.known["units"]
    return found


def _units(problem: MixedLCP) -> tuple[Exponents, Exponents]:
    n, zero = problem.n, np.zeros(problem.n)
    row, column, log, counts = _logarithms(problem.A)
    r, c = _least_squares(row[counts], column[counts], log[counts], n)
    for _ in range(RUIZ):
        now = log + r[row] + c[column]
        r, c = r - 0.5 * _largest(row, now, zero), c - 0.5 * _largest(column, now, zero)
    # The free factor of each connected part makes its largest q_i one, or leaves its last row.
    part_of_row, part_of_column = _parts(row, column, n)
    shift = np.zeros(2 * n)
    shift[part_of_row] = r
    asked = np.flatnonzero(problem.q)
    shift = _largest(part_of_row[asked], np.log2(np.abs(problem.q[asked])) + r[asked], shift)
    r, c = r - shift[part_of_row], c + shift[part_of_column]
    difference = _rounded(r - c)
    rows = _rounded(0.5 * (r + c + difference))
    return rows.astype(np.int64), (rows - difference).astype(np.int64)


def _logarithms(A: Matrix) -> tuple[Indices, Indices, Array, NDArray[np.bool_]]:
    """Rows and columns of the entries, their base-2 logarithms, and which count (sparse: all)."""
    if sp.issparse(A):
        stored = sp.coo_array(A)
        row, column = stored.nonzero()
        return row, column, np.log2(np.abs(stored.data[stored.data != 0.0])), np.ones(row.size, dtype=bool)
    logs = np.log2(np.abs(A))
    diagonal = logs.diagonal()
    excess = logs + logs.T - diagonal[:, None] - diagonal
    counts, there = ~((excess < NEGLIGIBLE) & (excess > -np.inf)), A != 0.0
    row, column = there.nonzero()
    return row, column, logs[there], counts[there]


def _least_squares(row: Indices, column: Indices, log: Array, n: int) -> tuple[Array, Array]:
    """The r and c that minimise sum (log |a_ij| + r_i + c_j)^2, by conjugate gradients for c."""
    weights = sp.csr_array((np.ones(row.size), (row, column)), shape=(n, n))
    in_row, in_column = (np.maximum(np.bincount(index, minlength=n), 1.0) for index in (row, column))
    of_rows, of_columns = np.bincount(row, log, n), np.bincount(column, log, n)
    system = LinearOperator((n, n), lambda c: in_column * c - weights.T @ ((weights @ c) / in_row), dtype=float)
    diagonal = LinearOperator((n, n), lambda c: c / in_column, dtype=float)
    right = weights.T @ (of_rows / in_row) - of_columns
    c = cg(system, right, rtol=HALVES**3, maxiter=GRADIENT_STEPS, M=diagonal)[0]
    return -(of_rows + weights @ c) / in_row, c


def _largest(index: Indices, values: Array, default: Array) -> Array:
    found = np.full(default.size, -np.inf)
    np.maximum.at(found, index, values)
    return np.where(found > -np.inf, found, default)


def _parts(row: Indices, column: Indices, n: int) -> tuple[Indices, Indices]:
    if row.size == n * n:
        return np.zeros(n, dtype=np.intp), np.zeros(n, dtype=np.intp)
    graph = sp.coo_array((np.ones(row.size), (row, n + column)), shape=(2 * n, 2 * n))
    labels = connected_components(graph, directed=False)[1]
    return labels[:n], labels[n:]


def _rounded(values: Array) -> Array:
    return np.floor(values + (0.5 + HALVES))


def _times(values: Array, exponents: Exponents) -> Array:
    with np.errstate(over="ignore", under="ignore"):
        product: Array = np.ldexp(values, exponents)
    return product


def _scaled(A: Matrix, rows: Exponents, columns: Exponents) -> Matrix:
    if not sp.issparse(A):
        return _times(A, rows[:, None] + columns)
    stored = sp.csr_array(A)
    exponents = np.repeat(rows, np.diff(stored.indptr)) + columns[stored.indices]
    return sp.csr_array((_times(stored.data, exponents), stored.indices, stored.indptr), shape=A.shape)
