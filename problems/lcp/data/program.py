"""Quadratic and linear programs as problems with bounds."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen
from numpy.typing import NDArray

from continuation.arrays import Array, Matrix
from problems.lcp.data.bounds import bound_vector, ordered_bounds
from problems.lcp.data.matrix_structure import semidefinite
from problems.lcp.data.problem import MixedLCP
from problems.options import check_finite, finite_vector, real_array, sound_sparse


@frozen(eq=False, slots=False)
class Program:
    """min 1/2 x'P x + c'x subject to lower <= x <= upper, A_eq x = b_eq, rows_lower <= G x <= h.

    Made by `from_qp` or `from_lp`. The unknowns of `problem` are x, free multipliers of equations, nonnegative ones of
    one-sided rows, free ones of two-sided rows, and these rows' values G x::

        P x + c = A_eq' equations + G' rows + bounds

    Attributes
    ----------
    P : Matrix, shape (n, n)
        Symmetric.
    c : Array of shape (n,)
    problem : MixedLCP
        The optimality conditions.
    equations : tuple of int
        Begin and end of their multipliers.
    equal, above, below, both : ndarray of int
        Rows of G that are equations, or have an upper side, a lower side, or both, in the order of multipliers.
    rows : int
        The number of rows of G.
    """

    P: Matrix
    c: Array
    problem: MixedLCP
    equations: tuple[int, int]
    equal: NDArray[np.intp]
    above: NDArray[np.intp]
    below: NDArray[np.intp]
    both: NDArray[np.intp]
    rows: int

    @property
    def n(self) -> int:
        """The number of variables."""
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
        begin, end = self.equations
        kinds = self.equal, self.above, self.below, self.both
        multipliers = unknowns[end : end + sum(kind.size for kind in kinds)]
        rows = np.zeros(self.rows)
        rows[np.concatenate(kinds)] = multipliers
        rows[self.above] *= -1.0
        return {"x": unknowns[: self.n], "equations": unknowns[begin:end], "rows": rows, "bounds": w[: self.n]}

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

    If P is not positive semidefinite, `solve` finds a KKT point, possibly no minimum, and says so.

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
        Default -inf and inf; x is fixed where they are equal.
    rows_lower : array_like, shape (m,), or one number, optional
        Lower sides of rows; equations where it equals h.

    Returns
    -------
    Program

    Raises
    ------
    ValueError
        For inconsistent arguments.

    References
    ----------
    Cottle, Pang and Stone, The Linear Complementarity Problem, 1992, section 1.2.
    """
    c = finite_vector("c", c)
    n = c.size
    P = _matrix("P", P, n)
    if P.shape[0] != n:
        raise ValueError(f"P: expected shape {(n, n)}, one row a number of c, found {P.shape}")
    _check_symmetric(P)
    if not sp.issparse(P):
        P.flags.writeable = False  # so that the problem does not copy it
    if (G is None) != (h is None and rows_lower is None):
        raise ValueError("G: expected rows and one side of them, h or rows_lower, or none of these")
    if (A_eq is None) != (b_eq is None):
        raise ValueError("A_eq: expected A_eq and b_eq, or neither")
    G = np.zeros((0, n)) if G is None else _matrix("G", G, n)
    B = np.zeros((0, n)) if A_eq is None else _matrix("A_eq", A_eq, n)
    b = np.zeros(0) if b_eq is None else finite_vector("b_eq", b_eq, B.shape[0])
    m = G.shape[0]
    high, low = bound_vector("h", h, m, np.inf), bound_vector("rows_lower", rows_lower, m, -np.inf)
    if (low > high).any():
        i = int(np.argmax(low > high))
        raise ValueError(f"rows_lower: expected at most h, found rows_lower[{i}] = {low[i]} > h[{i}] = {high[i]}")
    x_low, x_high = bound_vector("lower", lower, n, -np.inf), bound_vector("upper", upper, n, np.inf)
    ordered_bounds(x_low, x_high)
    has_low, has_high = low > -np.inf, high < np.inf
    equal, both = np.flatnonzero(low == high), np.flatnonzero(has_low & has_high & (low != high))
    above, below = np.flatnonzero(has_high & ~has_low), np.flatnonzero(has_low & ~has_high)
    parts = [
        (B, -b), (G[equal], -low[equal]), (-1 * G[above], high[above]), (G[below], -low[below]),
        (G[both], np.zeros(both.size)),
    ]  # fmt: skip
    free, signed = B.shape[0] + equal.size, above.size + below.size
    A = _optimality(P, [part for part, _ in parts if part.shape[0]], both.size)
    q = np.concatenate([c, *(constant for _, constant in parts), np.zeros(both.size)])
    none = np.full(both.size, np.inf)
    problem = MixedLCP(
        A, q, np.concatenate([x_low, np.full(free, -np.inf), np.zeros(signed), -none, low[both]]),
        np.concatenate([x_high, np.full(free + signed, np.inf), none, high[both]]), primal=n,
    )  # fmt: skip
    if problem.n == n:
        problem.known["symmetric"] = True
    return Program(P, c, problem, (n, n + B.shape[0]), equal, above, below, both, m)


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

    Returns
    -------
    Program

    Raises
    ------
    ValueError
        For inconsistent arguments.
    """
    c = finite_vector("c", c)
    P = sp.csr_array((c.size, c.size))
    if not (sp.issparse(G) or sp.issparse(A_eq)):
        P = P.toarray()
    return from_qp(P, c, G, h, A_eq, b_eq, lower, upper, rows_lower=rows_lower)


def _matrix(name: str, value: Any, columns: int) -> Matrix:
    matrix = sound_sparse(name, value) if sp.issparse(value) else real_array(name, value)
    if matrix.ndim != 2 or matrix.shape[1] != columns:
        raise ValueError(f"{name}: expected {columns} columns, one a number of c, found shape {matrix.shape}")
    check_finite(name, matrix)
    return matrix


def _check_symmetric(P: Matrix) -> None:
    if not sp.issparse(P) and np.array_equal(P, P.T):
        return
    difference = sp.coo_array(P - P.T)
    if difference.nnz and difference.data.any():
        k = int(np.argmax(np.abs(difference.data)))
        i, j = int(difference.row[k]), int(difference.col[k])
        raise ValueError(f"P: expected a symmetric matrix, found P[{i}, {j}] unlike P[{j}, {i}]; give (P + P') / 2")


def _optimality(P: Matrix, rows: list[Matrix], both: int) -> Matrix:
    """[[P, -R', 0], [R, 0, -E], [0, E', 0]] for stacked rows R; E marks two-sided rows."""
    if not rows:
        return P
    if sp.issparse(P) or any(sp.issparse(part) for part in rows):
        R = sp.vstack([sp.csr_array(part) for part in rows], format="csr")
        E = sp.eye_array(R.shape[0], format="csr")[:, R.shape[0] - both :]
        whole = sp.block_array([[sp.csr_array(P), -R.T, None], [R, None, -E], [None, E.T, sp.csr_array((both, both))]])
        return sp.csr_array(whole)
    R = np.vstack(rows)
    k, n = R.shape
    E, none = np.eye(k)[:, k - both :], np.zeros((n, both))
    return np.block([[P, -R.T, none], [R, np.zeros((k, k)), -E], [none.T, E.T, np.zeros((both, both))]])
