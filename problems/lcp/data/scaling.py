"""Rows and columns brought to comparable size by powers of two, which is exact, and undone in the answer.

LCP(q, A) and LCP(R q, R A C) have the same solutions up to their units, for all positive diagonal R and C. The units
taken here make the largest entry of each row and column of A about 1. Such units are not unique; those are taken to
which Ruiz's iteration leads from the units in which the logarithms of the entries have the least sum of squares. So
they lead to the same problem, up to the rounding to powers of two, whatever the units of the problem as given.
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
from problems.lcp.data.spread import EXTREME, alike, largest_entries, level

Exponents = NDArray[np.int64]

RUIZ = 8
"""Sweeps of Ruiz's iteration: each takes the root of what the largest entries of rows and columns are off."""

GRADIENT_STEPS = 30
"""Of conjugate gradients. A full matrix needs one, sparse random ones about ten; on long chains what is then still
missing is smooth, a common unit of neighbours, and changes no entry of the scaled matrix."""

LOGARITHM_TOLERANCE = 1e-6
"""Of the logarithms: far below the 1/2 at which rounding decides."""

LEAST_EXPONENT = -1021
"""Base-2 logarithm below which a float has fewer digits, so that scaling may round it."""

HALVES = 1e-3
"""Further above the noise of the logarithms than any fraction that matters: what is this near to 1/2 is rounded up."""

NEGLIGIBLE = -27.0
"""An a_ij with |a_ij a_ji| below 2^-27 (1e-8) of |a_ii a_jj|, which knows no units, says nothing about units: such are
the entries down to 1e-300 in a matrix of a kernel exp(-d^2)."""

LEVEL = 0.02
"""Logarithms of the largest entries that no sweep need improve: the rounding to powers of two changes them by more."""


@frozen(eq=False)
class Scaled:
    """LCP(R q, R A C): its solution u gives x = C u, and its w is R w.

    `rows`, `columns`, of shape (n,): R = diag(2^rows) and C = diag(2^columns). `exact`: Whether no entry was rounded:
    one below 1e-290 of the others may be, or vanish.
    """

    problem: MixedLCP
    rows: Exponents
    columns: Exponents
    exact: bool

    def x(self, u: Array) -> Array:
        """The point of the problem as given; infinite or zero where it is beyond the range of floats."""
        return _times(u, self.columns)

    def u(self, x: Array) -> Array:
        """The point of the scaled problem."""
        return _times(x, -self.columns)

    @property
    def common(self) -> bool:
        """Whether all rows have one factor, and the columns none."""
        return not self.columns.any() and not np.ptp(self.rows).any()


def balanced(problem: MixedLCP) -> Scaled | None:
    """The problem in units of its own, or None where these are the units in which it is given.

    References
    ----------
    Curtis and Reid, "On the Automatic Scaling of Matrices for Gaussian Elimination", J. Inst. Maths Applics 10, 1972;
    Ruiz, "A scaling algorithm to equilibrate both rows and columns norms in matrices", RAL-TR-2001-034.
    """
    if not problem.standard and level(problem):
        return None
    rows, columns = units(problem)
    if not rows.any() and not columns.any():
        return None
    A, q = _scaled(problem.A, rows, columns), _times(problem.q, rows)
    scaled: MixedLCP
    if problem.standard:
        scaled = LCP(A, q, primal=problem.primal)
    else:
        bounds = _times(problem.lower, -columns), _times(problem.upper, -columns)
        ends = zip(bounds, (problem.lower, problem.upper))
        if not all(np.array_equal(_times(new, columns), old) for new, old in ends):
            return None  # a bound that vanishes or overflows would make another problem
        scaled = MixedLCP(A, q, *bounds, primal=problem.primal)
    # Whatever the units, the same problem comes out: of the balanced one it is the problem itself.
    scaled.known["units"] = np.zeros_like(rows), np.zeros_like(columns)
    return Scaled(scaled, rows, columns, exact=_smallest(problem, rows, columns) > LEAST_EXPONENT)


def without_far_factor(problem: MixedLCP) -> tuple[Scaled | None, bool]:
    """LCP(s q, s A) with s = 1, or a power of two where entries are extreme; and whether active sets can begin with it.

    They can where the largest entries of rows and columns are alike, but for that factor, and it rounds nothing. Within
    the range of products a factor that is a power of two changes nothing of what active sets and pivots do.
    The problem has no bounds; None stands for s = 1.
    """
    if not alike(problem):
        return None, False
    most = largest_entries(problem)[1]
    if EXTREME**-0.5 <= most <= EXTREME**0.5:
        return None, True
    rows, columns = np.full(problem.n, 1 - int(np.frexp(most)[1])), np.zeros(problem.n, dtype=np.int64)
    q = _times(problem.q, rows)
    if not np.isfinite(q).all() or not _smallest(problem, rows, columns) > LEAST_EXPONENT:
        return None, False
    scaled = LCP(_scaled(problem.A, rows, columns), q, primal=problem.primal)
    return Scaled(scaled, rows, columns, exact=True), True


def units(problem: MixedLCP) -> tuple[Exponents, Exponents]:
    """The exponents of two for the rows of [A, q] and the columns of A; found once for a problem.

    Units of the given problem that are powers of two come out again, exactly: nothing is rounded but differences that
    they do not change. Row i and column i are rounded together, so that what is symmetric up to units becomes so.
    """
    if "units" not in problem.known:
        problem.known["units"] = _units(problem)
    found: tuple[Exponents, Exponents] = problem.known["units"]
    return found


def _units(problem: MixedLCP) -> tuple[Exponents, Exponents]:
    logs, counts = _logarithms(problem.A)
    r, c = _equilibrated(logs, *_least_squares(logs, counts))
    # Negligible or not, an entry ties its row to its column: what is free is free of all of them.
    pattern = counts if sp.issparse(logs) else (logs > -np.inf).astype(float)
    part_of_row, part_of_column = _parts(pattern)
    parts = int(max(part_of_row.max(), part_of_column.max())) + 1
    about_r, about_c = r - _fractions(r, part_of_row, parts), c - _fractions(c, part_of_column, parts)
    difference = _rounded(about_r - about_c)
    rows = _rounded(0.5 * (about_r + about_c + difference))
    columns = rows - difference
    # What rounding has added to all entries of a connected part of A is taken off again.
    in_row, in_column = pattern @ np.ones(problem.n), pattern.T @ np.ones(problem.n)
    added = np.bincount(part_of_row, in_row * (rows - r), parts)
    added += np.bincount(part_of_column, in_column * (columns - c), parts)
    mean = added / np.maximum(np.bincount(part_of_row, in_row, parts), 1.0)
    rows = rows - _rounded(mean)[part_of_row]
    # Each part leaves a factor between its rows and columns free: the largest entry of q there becomes about 1.
    largest = np.full(parts, -np.inf)
    known = problem.q != 0.0
    np.maximum.at(largest, part_of_row[known], np.log2(np.abs(problem.q[known])) + rows[known])
    shift = _rounded(np.where(np.isfinite(largest), largest, 0.0))
    return (rows - shift[part_of_row]).astype(np.int64), (columns + shift[part_of_column]).astype(np.int64)


def _logarithms(A: Matrix) -> tuple[Any, Any]:
    """The base-2 logarithms of the entries of A, -inf for zeros of a dense A, and ones where an entry counts.

    Of a sparse matrix all entries count: it has zeros in place of negligible ones.
    """
    if sp.issparse(A):
        stored = sp.csr_array((A.data, A.indices, A.indptr), shape=A.shape, copy=True)
        stored.eliminate_zeros()
        logs = sp.csr_array((np.log2(np.abs(stored.data)), stored.indices, stored.indptr), shape=A.shape)
        return logs, sp.csr_array((np.ones(stored.nnz), stored.indices, stored.indptr), shape=A.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log2(np.abs(A))
        diagonal = logs.diagonal()
        counts = logs > -np.inf
        # Where a_ji, a_ii or a_jj is zero there is nothing to compare with: inf or NaN, and the entry counts.
        excess = logs + logs.T
        excess -= diagonal[:, None] + diagonal
    return logs, (counts & ~((excess < NEGLIGIBLE) & (excess > -np.inf))).astype(float)


def _least_squares(logs: Any, weights: Any) -> tuple[Array, Array]:
    """The r and c of least sum of (log |a_ij| + r_i + c_j)^2 over what counts; zero for empty rows and columns.

    Conjugate gradients for c, after elimination of r.
    """
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
    """Ruiz's iteration from r and c towards largest entries 1 in all rows and columns."""
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
    """Which connected part each row and each column is of."""
    n = pattern.shape[0]
    if not sp.issparse(pattern) and pattern.all():
        return np.zeros(n, dtype=np.intp), np.zeros(n, dtype=np.intp)
    entries = sp.coo_array(pattern)
    graph = sp.coo_array((entries.data, (entries.row, n + entries.col)), shape=(2 * n, 2 * n))
    labels = connected_components(graph, directed=False)[1]
    return labels[:n], labels[n:]


def _rounded(values: Array) -> Array:
    """To the nearest integers; halves, which small integers in A make common, always upwards whatever their noise."""
    return np.floor(values + (0.5 + HALVES))


def _fractions(values: Array, parts: NDArray[Any], number: int) -> Array:
    """For each value the mean of the fractions in its part, about which it is rounded: what is alike stays so."""
    turns = np.exp(2j * np.pi * values)
    sums = np.bincount(parts, turns.real, number) + 1j * np.bincount(parts, turns.imag, number)
    # Where fractions cancel around the circle, only noise has a mean: the fraction of the first takes its place.
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


def _smallest(problem: MixedLCP, rows: Exponents, columns: Exponents) -> int:
    """The base-2 logarithm of the smallest entry that is not zero, once scaled; at most zero."""
    if sp.issparse(problem.A):
        entries = sp.coo_array(problem.A)
        values, exponents = entries.data, rows[entries.row] + columns[entries.col]
    else:
        values, exponents = problem.A, rows[:, None] + columns
    parts = ((values, exponents), (problem.q, rows))
    return min(int((np.frexp(part)[1] + powers)[part != 0.0].min(initial=0)) for part, powers in parts)
