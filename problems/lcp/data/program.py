"""Quadratic and linear programs as problems with bounds."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arguments.checks import expect
from continuation.arrays import Array, Matrix
from problems.lcp.data.bounds import bound_vector, ordered_bounds
from problems.lcp.data.matrix_structure import semidefinite
from problems.lcp.data.problem import MixedLCP
from problems.options import finite_matrix, finite_vector


@frozen(eq=False, slots=False)
class Program:
    """min 1/2 x'P x + c'x subject to lower <= x <= upper, A_eq x = b_eq, rows_lower <= G x <= h.

    `from_qp` and `from_lp` make it. An equation is a row with equal sides. The unknowns of `problem` are x and one
    multiplier a side::

        P x + c = A_eq' equations + G' rows + bounds

    Attributes
    ----------
    P : Matrix, shape (n, n)
        Symmetric.
    c : Array of shape (n,)
    problem : MixedLCP
        The optimality conditions.
    shape : tuple of int
        The numbers of rows of A_eq and of G.
    row : ndarray of int
        The row of [A_eq; G] of each multiplier.
    sign : ndarray
        -1 for upper sides, else 1.
    """

    P: Matrix
    c: Array
    problem: MixedLCP
    shape: tuple[int, int]
    row: NDArray[np.intp]
    sign: Array

    @property
    def n(self) -> int:
        """Number of variables."""
        return int(self.c.size)

    @cached_property
    def convex(self) -> bool:
        """Whether P is positive semidefinite to working precision."""
        return semidefinite(self.P.toarray() if sp.issparse(self.P) else self.P)

    def objective(self, x: Array) -> float:
        """1/2 x'P x + c'x.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        return float(0.5 * (x @ (self.P @ x)) + self.c @ x)

    def named(self, unknowns: Array, w: Array) -> Mapping[str, Array]:
        """A solution of `problem` by name: x, `equations`, `rows` and `bounds`.

        Multipliers are positive at lower sides, negative at upper.

        Parameters
        ----------
        unknowns, w : ndarray
            Of `problem`.
        """
        total = np.zeros(sum(self.shape))
        np.add.at(total, self.row, self.sign * unknowns[self.n :])
        equations, rows = np.split(total, self.shape[:1])
        return {"x": unknowns[: self.n], "equations": equations, "rows": rows, "bounds": w[: self.n]}

    def reading(self, multiplier: Array) -> str:
        """The meaning of a proof that the conditions have no solution.

        Parameters
        ----------
        multiplier : ndarray
            A Farkas vector of `problem`.
        """
        if multiplier[self.n :].any():
            return "The constraints have no common point." if not multiplier[: self.n].any() else ""
        return "Along a direction that no constraint ends the objective falls for ever."


def from_qp(
    P: Any,
    c: Any,
    G: Any = None,
    h: Any = None,
    A_eq: Any = None,
    b_eq: Any = None,
    lower: Any = None,
    upper: Any = None,
    *,
    rows_lower: Any = None,
) -> Program:
    """Min 1/2 x'P x + c'x subject to G x <= h, A_eq x = b_eq, lower <= x <= upper.

    If P is not positive semidefinite, `solve` finds a KKT point, perhaps no minimum, and says so.

    Parameters
    ----------
    P : array_like or scipy sparse, shape (n, n)
        Symmetric.
    c : array_like, shape (n,)
    G : array_like or scipy sparse, shape (m, n), optional
    h : array_like, shape (m,), or one number, optional
        Upper sides of rows, inf for none.
    A_eq : array_like or scipy sparse, shape (k, n), optional
    b_eq : array_like, shape (k,), optional
    lower, upper : array_like, shape (n,), or one number, optional
        Default -inf and inf.
    rows_lower : array_like, shape (m,), or one number, optional
        Lower sides of rows.

    References
    ----------
    Cottle, Pang and Stone, section 1.2.
    """
    c = finite_vector("c", c)
    n = c.size
    P = _matrix("P", P, n)
    expect(P.shape[0] == n, "P", f"shape {(n, n)}, one row a number of c", P.shape)
    expect(abs(P - P.T).sum() == 0.0, "P", "a symmetric matrix, such as (P + P') / 2", P)
    if not sp.issparse(P):
        # Then the problem of a program with bounds alone shares it.
        P.flags.writeable = False
    expect(
        (G is None) == (h is None and rows_lower is None),
        "G", "rows and one side of them, h or rows_lower, or none of these", G,
    )  # fmt: skip
    expect((A_eq is None) == (b_eq is None), "A_eq", "A_eq and b_eq, or neither", A_eq)
    G = np.zeros((0, n)) if G is None else _matrix("G", G, n)
    B = np.zeros((0, n)) if A_eq is None else _matrix("A_eq", A_eq, n)
    b = np.zeros(0) if b_eq is None else finite_vector("b_eq", b_eq, B.shape[0])
    m = G.shape[0]
    high, low = bound_vector("h", h, m, np.inf), bound_vector("rows_lower", rows_lower, m, -np.inf)
    ordered_bounds(low, high, "rows_lower", "h")
    x_low, x_high = bound_vector("lower", lower, n, -np.inf), bound_vector("upper", upper, n, np.inf)
    ordered_bounds(x_low, x_high)
    low, high = np.append(b, low), np.append(b, high)
    equal = low == high
    kinds = [np.flatnonzero(kind) for kind in (equal, np.isfinite(high) & ~equal, np.isfinite(low) & ~equal)]
    row, sizes = np.concatenate(kinds), [kind.size for kind in kinds]
    sign = np.repeat([1.0, -1.0, 1.0], sizes)
    A = _optimality(P, B, G, row, sign) if row.size else P
    problem = MixedLCP(
        A, np.append(c, -sign * np.where(sign > 0.0, low[row], high[row])),
        np.concatenate([x_low, np.repeat([-np.inf, 0.0], [sizes[0], row.size - sizes[0]])]),
        np.append(x_high, np.full(row.size, np.inf)), primal=n,
    )  # fmt: skip
    return Program(P, c, problem, (B.shape[0], m), row, sign)


def from_lp(
    c: Any,
    G: Any = None,
    h: Any = None,
    A_eq: Any = None,
    b_eq: Any = None,
    lower: Any = None,
    upper: Any = None,
    *,
    rows_lower: Any = None,
) -> Program:
    """Min c'x subject to G x <= h, A_eq x = b_eq, lower <= x <= upper.

    Parameters
    ----------
    c, G, h, A_eq, b_eq, lower, upper, rows_lower : array_like
        As for `from_qp`.
    """
    c = finite_vector("c", c)
    P = (sp.csr_array if sp.issparse(G) or sp.issparse(A_eq) else np.zeros)((c.size, c.size))
    return from_qp(P, c, G, h, A_eq, b_eq, lower, upper, rows_lower=rows_lower)


def _matrix(name: str, value: Any, columns: int) -> Matrix:
    matrix = finite_matrix(name, value)
    expect(matrix.shape[1:] == (columns,), name, f"{columns} columns, one a number of c", matrix.shape)
    return matrix


def _optimality(P: Matrix, B: Matrix, G: Matrix, row: NDArray[np.intp], sign: Array) -> Matrix:
    """[[P, -R'], [R, 0]] for rows R of [B; G] with signs."""
    if any(sp.issparse(part) for part in (P, B, G)):
        R = sp.diags_array(sign) @ sp.vstack([sp.csr_array(B), sp.csr_array(G)], format="csr")[row]
        return sp.csr_array(sp.block_array([[sp.csr_array(P), -R.T], [R, None]]))
    R = sign[:, None] * np.vstack([B, G])[row]
    return np.block([[P, -R.T], [R, np.zeros((len(R), len(R)))]])
