"""Hypothesis strategies for problems with bounds."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program, from_qp
from problems.lcp.matrix_strategies import ORDERS, POSITIVE, Draw, Order, matrices, vector

KINDS = ("lower", "upper", "box", "free", "fixed")


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
            lower[i] = draw(st.integers(-3, 3))
        if kind == "upper":
            upper[i] = draw(st.integers(-3, 3))
        elif kind in ("box", "fixed"):
            upper[i] = lower[i] + (draw(POSITIVE) if kind == "box" else 0)
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
    return MixedLCP(A, vector(draw, len(A), st.integers(-4, 4)), *draw(bounds(len(A), kinds)))


@st.composite
def programs(draw: Draw, n: Order = ORDERS, convex: bool = True) -> Program:
    """Feasible quadratic programs with integer data, rows and bounds of all kinds.

    Parameters
    ----------
    n : int or strategy of int
    convex : bool
        True: P is positive semidefinite; False: any symmetric P.
    """
    A = draw(matrices("PSD" if convex else "any", n))
    P, size = A + A.T, len(A)
    lower, upper = draw(bounds(size, ("lower", "upper", "box", "free")))
    middle = [low if np.isfinite(low) else high if np.isfinite(high) else 0.0 for low, high in zip(lower, upper)]
    rows = draw(st.integers(0, 3))
    G, c = vector(draw, rows * size).reshape(rows, size), vector(draw, size, st.integers(-4, 4))
    below, above = (vector(draw, rows, st.sampled_from((0.0, 1.0, np.inf))) for _ in range(2))
    level = G @ np.array(middle)
    sides = {"G": G, "h": level + above, "rows_lower": level - below} if rows else {}
    return from_qp(P, c, lower=lower, upper=upper, **sides)
