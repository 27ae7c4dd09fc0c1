"""Exact scaling of rows and columns by powers of two.

For positive diagonal R and C, LCP(q, A) and LCP(R q, R A C) have the same solutions up to units. Least squares of
logarithms, then Ruiz's iteration, make the largest entries of rows and columns about 1, and give the same problem for
all given units, up to rounding.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import LCP, MixedLCP
from problems.lcp.data.spread import alike, largest_entries, near_one

Exponents = NDArray[np.int64]

RUIZ = 8
"""Sweeps: each halves the logarithms of the largest entries."""

GRADIENT_STEPS = 30
"""Conjugate gradient steps: full matrices need one, sparse random ones about ten."""

LOGARITHM_TOLERANCE = 1e-6
"""Tolerance of the logarithms, far below the 1/2 where rounding decides."""

HALVES = 1e-3
"""Fractions this near to 1/2 are noise and round up."""

NEGLIGIBLE = -27.0
"""Entries with |a_ij a_ji| < 2^-27 |a_ii a_jj| are ignored: matrices exp(-d^2) have entries down to 1e-300."""

LEVEL = 0.02
"""Sweeps end at smaller logarithms: rounding changes them more."""


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
    """The problem in balanced units, or None if unchanged.

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
    # A balanced problem needs no units.
    scaled.problem.known["units"] = np.zeros_like(rows), np.zeros_like(columns)
    return scaled


def _by(problem: MixedLCP, rows: Exponents, columns: Exponents, q: Array, *bounds: Array) -> Scaled:
    A = _scaled(problem.A, rows, columns)
    back = _scaled(A, -rows, -columns)
    same = np.array_equal(back.data, problem.A.data) if problem.sparse else np.array_equal(back, problem.A)
    exact = same and np.array_equal(_times(q, -rows), problem.q)
    scaled = MixedLCP(A, q, *bounds, primal=problem.primal) if bounds else LCP(A, q, primal=problem.primal)
    return Scaled(scaled, rows, columns, exact)


def without_far_factor(problem: MixedLCP) -> tuple[Scaled | None, bool]:
    """LCP(s q, s A), s a power of two for extreme entries (None for s = 1), and whether active sets can use it.

    They can if entries are `alike` and s rounds nothing.
    """
    if not alike(problem):
        return None, False
    if near_one(problem):
        return None, True
    rows, columns = (
        np.full(problem.n, 1 - int(np.frexp(largest_entries(problem)[1])[1])),
        np.zeros(problem.n, dtype=np.int64),
    )
    q = _times(problem.q, rows)
    scaled = _by(problem, rows, columns, q) if np.isfinite(q).all() else None
    return (scaled, True) if scaled is not None and scaled.exact else (None, False)


def units(problem: MixedLCP) -> tuple[Exponents, Exponents]:
    """The exponents of two for rows of [A, q] and columns of A.

    Matrices that are symmetric up to units become symmetric.
    """
    if "units" not in problem.known:
        problem.known["units"] = _units(problem)
    found: tuple[Exponents, Exponents] = problem.known["units"]
    return found


def _units(problem: MixedLCP) -> tuple[Exponents, Exponents]:
    logs, counts = _logarithms(problem.A)
    r, c = _equilibrated(logs, *_least_squares(logs, counts))
    # Negligible entries also connect rows and columns.
    pattern = counts if sp.issparse(logs) else (logs > -np.inf).astype(float)
    part_of_row, part_of_column = _parts(pattern)
    parts = int(max(part_of_row.max(), part_of_column.max())) + 1
    about_r, about_c = r - _fractions(r, part_of_row, parts), c - _fractions(c, part_of_column, parts)
    difference = _rounded(about_r - about_c)
    rows = _rounded(0.5 * (about_r + about_c + difference))
    columns = rows - difference
    # Undo the mean rounding of each connected part.
    in_row, in_column = pattern @ np.ones(problem.n), pattern.T @ np.ones(problem.n)
    added = np.bincount(part_of_row, in_row * (rows - r), parts)
    added += np.bincount(part_of_column, in_column * (columns - c), parts)
    mean = added / np.maximum(np.bincount(part_of_row, in_row, parts), 1.0)
    rows = rows - _rounded(mean)[part_of_row]
    # A free factor makes a part's largest q_i about 1.
    largest = np.full(parts, -np.inf)
    known = problem.q != 0.0
    np.maximum.at(largest, part_of_row[known], np.log2(np.abs(problem.q[known])) + rows[known])
    shift = _rounded(np.where(np.isfinite(largest), largest, 0.0))
    return (rows - shift[part_of_row]).astype(np.int64), (columns + shift[part_of_column]).astype(np.int64)


def _logarithms(A: Matrix) -> tuple[Any, Any]:
    """Base-2 logarithms of |A|, and 1 where an entry counts (sparse: everywhere)."""
    if sp.issparse(A):
        stored = sp.csr_array((A.data, A.indices, A.indptr), shape=A.shape, copy=True)
        stored.eliminate_zeros()
        logs = sp.csr_array((np.log2(np.abs(stored.data)), stored.indices, stored.indptr), shape=A.shape)
        return logs, sp.csr_array((np.ones(stored.nnz), stored.indices, stored.indptr), shape=A.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log2(np.abs(A))
        diagonal = logs.diagonal()
        counts = logs > -np.inf
        excess = logs + logs.T
        excess -= diagonal[:, None] + diagonal
    return logs, (counts & ~((excess < NEGLIGIBLE) & (excess > -np.inf))).astype(float)


def _least_squares(logs: Any, weights: Any) -> tuple[Array, Array]:
    """The r and c that minimise sum (log |a_ij| + r_i + c_j)^2, by conjugate gradients for c."""
    if sp.issparse(logs):
        row_sums, column_sums = np.asarray(logs.sum(axis=1)).ravel(), np.asarray(logs.sum(axis=0)).ravel()
    else:
        counted = logs if weights.all() else np.where(weights > 0.0, logs, 0.0)
        row_sums, column_sums = counted.sum(axis=1), counted.sum(axis=0)
    ones = np.ones(row_sums.size)
    in_row, in_column = np.maximum(weights @ ones, 1.0), np.maximum(weights.T @ ones, 1.0)
    c = np.zeros(ones.size)
    residual = weights.T @ (row_sums / in_row) - column_sums
    direction, last = c, 1.0
    for _ in range(GRADIENT_STEPS):
        preconditioned = residual / in_column
        if np.abs(preconditioned).max() <= LOGARITHM_TOLERANCE:
            break
        product = float(residual @ preconditioned)
        direction = preconditioned + (product / last) * direction
        image = in_column * direction - weights.T @ ((weights @ direction) / in_row)
        curvature = float(direction @ image)
        if not curvature > 0.0:
            break
        c = c + (product / curvature) * direction
        residual = residual - (product / curvature) * image
        last = product
    return -(row_sums + weights @ c) / in_row, c


def _equilibrated(logs: Any, r: Array, c: Array) -> tuple[Array, Array]:
    row = None
    if sp.issparse(logs):
        row, column, logs = np.repeat(np.arange(r.size), np.diff(logs.indptr)), logs.indices, logs.data
    for _ in range(RUIZ):
        if row is None:
            now = logs + r[:, None]
            now += c
            of_rows, of_columns = now.max(axis=1), now.max(axis=0)
        else:
            of_rows, of_columns = np.full(r.size, -np.inf), np.full(c.size, -np.inf)
            now = logs + r[row] + c[column]
            np.maximum.at(of_rows, row, now)
            np.maximum.at(of_columns, column, now)
        of_rows = np.where(of_rows > -np.inf, of_rows, 0.0)
        of_columns = np.where(of_columns > -np.inf, of_columns, 0.0)
        if max(np.abs(of_rows).max(), np.abs(of_columns).max()) <= LEVEL:
            break
        r, c = r - 0.5 * of_rows, c - 0.5 * of_columns
    return r, c


def _parts(pattern: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    n = pattern.shape[0]
    if not sp.issparse(pattern) and pattern.all():
        return np.zeros(n, dtype=np.intp), np.zeros(n, dtype=np.intp)
    entries = sp.coo_array(pattern)
    graph = sp.coo_array((entries.data, (entries.row, n + entries.col)), shape=(2 * n, 2 * n))
    labels = connected_components(graph, directed=False)[1]
    return labels[:n], labels[n:]


def _rounded(values: Array) -> Array:
    return np.floor(values + (0.5 + HALVES))


def _fractions(values: Array, parts: NDArray[Any], number: int) -> Array:
    """The mean fraction of each part: equal values round equally about it."""
    turns = np.exp(2j * np.pi * values)
    sums = np.bincount(parts, turns.real, number) + 1j * np.bincount(parts, turns.imag, number)
    # Where fractions cancel, their mean is noise.
    present, first = np.unique(parts, return_index=True)
    cancelled = np.abs(sums[present]) <= HALVES * np.bincount(parts, minlength=number)[present]
    sums[present[cancelled]] = turns[first[cancelled]]
    fractions: Array = np.angle(sums)[parts] / (2.0 * np.pi)
    return fractions


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
