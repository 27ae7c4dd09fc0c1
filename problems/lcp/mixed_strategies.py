"""Hypothesis strategies for problems with bounds."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from continuation.arrays import Array
from problems.lcp.data.problem import BETWEEN, LOWER, UPPER, MixedLCP
from problems.lcp.data.program import Program, from_qp
from problems.lcp.strategies import ORDERS, Draw, Order, matrices

KINDS = ("lower", "upper", "box", "free", "fixed")
"""Kinds of bounds."""

_END = st.integers(-3, 3)
_WIDTH = st.integers(1, 4)


@st.composite
def bounds(draw: Draw, n: int, kinds: tuple[str, ...] = KINDS) -> tuple[Array, Array]:
    """Integer bounds (lower, upper) of n unknowns, each of its own kind.

    Parameters
    ----------
    n : int
    kinds : tuple of str
        From `KINDS`.
    """
    lower, upper = np.full(n, -np.inf), np.full(n, np.inf)
    for i in range(n):
        kind = draw(st.sampled_from(kinds))
        if kind in ("lower", "box", "fixed"):
            lower[i] = draw(_END)
        if kind == "upper":
            upper[i] = draw(_END)
        elif kind in ("box", "fixed"):
            upper[i] = lower[i] + (draw(_WIDTH) if kind == "box" else 0)
    return lower, upper


@st.composite
def mixed_lcps(draw: Draw, cls: str = "any", n: Order = ORDERS, kinds: tuple[str, ...] = KINDS) -> MixedLCP:
    """Problems with a matrix of the class, any integer q and bounds, solvable or not.

    Parameters
    ----------
    cls : str
        Of `strategies.CLASSES`.
    n : int or strategy of int
    kinds : tuple of str
        From `KINDS`.
    """
    A = draw(matrices(cls, n))
    q = np.array([draw(st.integers(-4, 4)) for _ in A], dtype=float)
    return MixedLCP(A, q, *draw(bounds(len(A), kinds)))


@st.composite
def planted_mixed_lcps(
    draw: Draw, cls: str = "any", n: Order = ORDERS, kinds: tuple[str, ...] = KINDS
) -> tuple[MixedLCP, Array]:
    """A problem with bounds and an exact integer solution x."""
    A = draw(matrices(cls, n))
    lower, upper = draw(bounds(len(A), kinds))
    x, w = np.empty(len(A)), np.zeros(len(A))
    for i, (low, high) in enumerate(zip(lower, upper)):
        ends = [s for s, end in ((LOWER, low), (UPPER, high)) if np.isfinite(end)]
        where = draw(st.sampled_from([BETWEEN, *ends]))
        inside = st.integers(int(low) if np.isfinite(low) else int(min(high, 0)) - 3,
                             int(high) if np.isfinite(high) else int(max(low, 0)) + 3)  # fmt: skip
        x[i] = draw(inside) if where == BETWEEN else low if where == LOWER else high
        if where != BETWEEN:
            w[i] = -int(where) * draw(st.integers(0, 4))
    return MixedLCP(A, w - A @ x, lower, upper), x


@st.composite
def programs(draw: Draw, n: Order = ORDERS, convex: bool = True) -> Program:
    """Feasible quadratic programs with integer data, rows and bounds of all kinds.

    Parameters
    ----------
    n : int or strategy of int
    convex : bool
        Whether P is positive semidefinite.
    """
    A = draw(matrices("PSD" if convex else "any", n))
    P, size = A + A.T, len(A)
    lower, upper = draw(bounds(size, ("lower", "upper", "box", "free")))
    middle = [low if np.isfinite(low) else high if np.isfinite(high) else 0.0 for low, high in zip(lower, upper)]
    rows = draw(st.integers(0, 3))
    G = np.array([draw(st.integers(-3, 3)) for _ in range(rows * size)], dtype=float).reshape(rows, size)
    c = np.array([draw(st.integers(-4, 4)) for _ in range(size)], dtype=float)
    if not rows:
        return from_qp(P, c, lower=lower, upper=upper)
    level = G @ np.array(middle)
    below = np.array([draw(st.sampled_from((0.0, 1.0, np.inf))) for _ in range(rows)])
    above = np.array([draw(st.sampled_from((0.0, 1.0, np.inf))) for _ in range(rows)])
    return from_qp(P, c, G, level + above, lower=lower, upper=upper, rows_lower=level - below)
