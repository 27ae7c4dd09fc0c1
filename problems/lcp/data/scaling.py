"""Rows and columns brought to comparable size by powers of two, which is exact, and undone in the answer.

LCP(q, A) and LCP(R q, R A C) have the same solutions up to their units, for all positive diagonal R and C. The units
taken here are those in which the logarithms of the entries of A have the least sum of squares: they lead to the same
problem, up to the rounding to powers of two, whatever the units of the problem as given.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from continuation.arrays import Array, Matrix
from problems.lcp.data.problem import LCP

Exponents = NDArray[np.int64]

SWEEPS = 30
"""Of conjugate gradients. A full matrix needs one, sparse random ones about ten; on long chains what is then still
missing is smooth, a common unit of neighbours, and changes no entry of the scaled matrix."""

ACCURACY = 1e-6
"""Of the logarithms: far below the 1/2 at which rounding decides."""

SMALLEST, LARGEST = -962.0, 962.0
"""Base-2 logarithms between which all entries must lie, about 1e-290 and 1e290: products of two rows' terms may
underflow or overflow beyond."""


class OutOfRange(ValueError):
    """No units bring the entries of A and q within the range in which floats can be worked with."""


@frozen(eq=False)
class Scaled:
    """LCP(R q, R A C): its solution u gives x = C u, and its w is R w.

    Attributes
    ----------
    problem : LCP
    rows, columns : integer arrays of shape (n,)
        R = diag(2^rows) and C = diag(2^columns).
    """

    problem: LCP
    rows: Exponents
    columns: Exponents

    def x(self, u: Array) -> Array:
        """The point of the problem as given; infinite or zero where it is beyond the range of floats."""
        return _times(u, self.columns)

    def u(self, x: Array) -> Array:
        """The point of the scaled problem."""
        return _times(x, -self.columns)


def balanced(problem: LCP) -> Scaled | None:
    """The problem in units of its own, or None where these are the units in which it is given.

    Raises
    ------
    OutOfRange
        If neither these units nor the given ones keep all entries within 1e-290 .. 1e290.

    References
    ----------
    Curtis and Reid, On the automatic reordering and scaling of matrices, J. Inst. Maths Applics 10, 1972.
    """
    rows, columns = units(problem)
    if not rows.any() and not columns.any():
        return None
    if not _within(problem, rows, columns):
        if _within(problem, np.zeros_like(rows), np.zeros_like(columns)):
            return None
        raise OutOfRange(
            "A, q: expected entries that some units of rows and columns bring within 1e-290 .. 1e290, found none: "
            "their sizes are too far apart"
        )
    return Scaled(LCP(_scaled(problem.A, rows, columns), _times(problem.q, rows)), rows, columns)


def units(problem: LCP) -> tuple[Exponents, Exponents]:
    """The exponents of two for the rows of [A, q] and the columns of A.

    Units of the given problem that are powers of two come out again, exactly: nothing is rounded but differences that
    they do not change. Row i and column i are rounded together, so that what is symmetric up to units becomes so.
    """
    pattern, row_sums, column_sums = _logarithms(problem.A)
    r, c = _least_squares(pattern, row_sums, column_sums)
    part_of_row, part_of_column = _parts(pattern)
    parts = int(max(part_of_row.max(), part_of_column.max())) + 1
    pairs = np.unique(parts * part_of_row + part_of_column, return_inverse=True)[1]
    difference = _rounded(r - c, pairs)
    rows = _rounded(0.5 * (r + c + difference), pairs)
    columns = rows - difference
    # What rounding has added to all entries of a connected part of A is taken off again.
    in_row, in_column = pattern @ np.ones(problem.n), pattern.T @ np.ones(problem.n)
    added = np.bincount(part_of_row, in_row * (rows - r), parts) + np.bincount(part_of_column, in_column * (columns - c), parts)
    rows = rows - np.round(added / np.maximum(np.bincount(part_of_row, in_row, parts), 1.0)).astype(np.int64)[part_of_row]
    # Each part leaves a factor between its rows and columns free: the largest entry of q there becomes about 1.
    largest = np.full(parts, -np.inf)
    known = problem.q != 0.0
    np.maximum.at(largest, part_of_row[known], np.log2(np.abs(problem.q[known])) + rows[known])
    shift = np.round(np.where(np.isfinite(largest), largest, 0.0)).astype(np.int64)
    return rows - shift[part_of_row], columns + shift[part_of_column]


def _logarithms(A: Matrix) -> tuple[Any, Array, Array]:
    """The pattern of A, with ones for its nonzero entries, and the sums over rows and columns of their logarithms."""
    if sp.issparse(A):
        pattern = sp.csr_array(A)
        pattern = sp.csr_array((pattern.data, pattern.indices, pattern.indptr), shape=A.shape)
        pattern.eliminate_zeros()
        logs = sp.csr_array((np.log2(np.abs(pattern.data)), pattern.indices, pattern.indptr), shape=A.shape)
        pattern = sp.csr_array((np.ones(pattern.nnz), pattern.indices, pattern.indptr), shape=A.shape)
        return pattern, np.asarray(logs.sum(axis=1)).ravel(), np.asarray(logs.sum(axis=0)).ravel()
    present = A != 0.0
    logs = np.log2(np.abs(A), where=present, out=np.zeros_like(A))
    return present.astype(float), logs.sum(axis=1), logs.sum(axis=0)


def _least_squares(pattern: Any, row_sums: Array, column_sums: Array) -> tuple[Array, Array]:
    """The r and c of least sum of (log |a_ij| + r_i + c_j)^2 over the nonzero entries; zero for empty rows and columns.

    Conjugate gradients for c, after elimination of r.
    """
    ones = np.ones(row_sums.size)
    in_row, in_column = np.maximum(pattern @ ones, 1.0), np.maximum(pattern.T @ ones, 1.0)
    c = np.zeros(ones.size)
    residual = pattern.T @ (row_sums / in_row) - column_sums
    direction, last = c, 1.0
    for _ in range(SWEEPS):
        preconditioned = residual / in_column
        if np.abs(preconditioned).max() <= ACCURACY:
            break
        product = float(residual @ preconditioned)
        direction = preconditioned + (product / last) * direction
        image = in_column * direction - pattern.T @ ((pattern @ direction) / in_row)
        curvature = float(direction @ image)
        if not curvature > 0.0:
            break
        c = c + (product / curvature) * direction
        residual = residual - (product / curvature) * image
        last = product
    return -(row_sums + pattern @ c) / in_row, c


def _parts(pattern: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Which connected part each row and each column is of."""
    n = pattern.shape[0]
    ones = np.ones(n)
    in_row = pattern @ ones
    if in_row.max() == n and in_row.min() > 0.0:
        # A full row joins all columns, and every row has an entry in one.
        return np.zeros(n, dtype=np.intp), np.zeros(n, dtype=np.intp)
    entries = sp.coo_array(pattern)
    graph = sp.coo_array((entries.data, (entries.row, n + entries.col)), shape=(2 * n, 2 * n))
    labels = connected_components(graph, directed=False)[1]
    return labels[:n], labels[n:]


def _rounded(values: Array, groups: NDArray[Any]) -> Exponents:
    """The values rounded to integers, in each group about the mean of their fractions, so that what is alike stays so."""
    turns = np.exp(2j * np.pi * values)
    fraction = np.angle(np.bincount(groups, turns.real) + 1j * np.bincount(groups, turns.imag)) / (2.0 * np.pi)
    return np.round(values - fraction[groups]).astype(np.int64)


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


def _within(problem: LCP, rows: Exponents, columns: Exponents) -> bool:
    """Whether every entry that is not zero stays within range, so that the scaling is exact."""
    if sp.issparse(problem.A):
        entries = sp.coo_array(problem.A)
        values, exponents = entries.data, rows[entries.row] + columns[entries.col]
    else:
        values, exponents = problem.A, rows[:, None] + columns
    for part, powers in ((values, exponents), (problem.q, rows)):
        chosen = part != 0.0
        logs = (np.frexp(part)[1] + powers)[chosen]
        if logs.size and not (logs.min() >= SMALLEST and logs.max() <= LARGEST):
            return False
    return True
