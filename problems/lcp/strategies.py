"""Hypothesis strategies for problems with a property, from integers, so that they shrink."""

from __future__ import annotations

from hypothesis import strategies as st

from continuation.arguments.checks import expect
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.matrix_strategies import (
    CLASSES,
    ORDERS,
    POSITIVE,
    Draw,
    Entries,
    Order,
    matrices,
    orders_of,
    square,
    vector,
)

__all__ = [
    "CLASSES",
    "ORDERS",
    "Draw",
    "Order",
    "badly_scaled_lcps",
    "feasible_lcps",
    "lcps",
    "matrices",
    "near_singular_lcps",
    "planted_lcps",
    "two_solution_lcps",
]


def lcps(cls: str = "any", n: Order = ORDERS, entries: Entries | None = None) -> st.SearchStrategy[LCP]:
    """Problems with a matrix of the class and any q, feasible or not.

    Parameters
    ----------
    cls : str
        One of `CLASSES`.
    n : int or strategy of int
    entries : strategy of numbers, optional
        For A, as in `matrices`, and q.
    """
    return _lcps(matrices(cls, n, entries), st.integers(-4, 4) if entries is None else entries)


@st.composite
def _lcps(draw: Draw, matrix: st.SearchStrategy[Array], entries: Entries) -> LCP:
    A = draw(matrix)
    return LCP(A, vector(draw, len(A), entries))


def feasible_lcps(cls: str = "any", n: Order = ORDERS) -> st.SearchStrategy[tuple[LCP, Array]]:
    """A problem and a strictly feasible integer start: x0 > 0 and A x0 + q > 0, exactly.

    Parameters
    ----------
    cls : str
        One of `CLASSES`.
    n : int or strategy of int
    """
    return _feasible(matrices(cls, n))


@st.composite
def _feasible(draw: Draw, matrix: st.SearchStrategy[Array]) -> tuple[LCP, Array]:
    return _with_start(draw, draw(matrix))


def _with_start(draw: Draw, A: Array) -> tuple[LCP, Array]:
    x0, w0 = (vector(draw, len(A), POSITIVE) for _ in range(2))
    return LCP(A, w0 - A @ x0), x0


def planted_lcps(kind: str = "strict", cls: str = "any", n: Order = ORDERS) -> st.SearchStrategy[tuple[LCP, Array]]:
    """A problem and an exact integer solution x.

    Parameters
    ----------
    kind : str
        "strict": strictly complementary. "degenerate": x_i = w_i = 0 for some i. "many": at least two solutions, for a
        matrix of no class (`two_solution_lcps` gives both).
    cls : str
        For the first two kinds.
    n : int or strategy of int
    """
    if kind in ("strict", "degenerate"):
        return _planted(matrices(cls, n), kind == "degenerate")
    expect(kind == "many", "kind", "strict, degenerate or many", kind)
    expect(cls == "any", "cls", "any for kind many", cls)
    return two_solution_lcps(n).map(lambda triple: triple[:2])


@st.composite
def _planted(draw: Draw, matrix: st.SearchStrategy[Array], degenerate: bool) -> tuple[LCP, Array]:
    A = draw(matrix)
    x, w = _complementary_pair(draw, len(A))
    if degenerate:
        i = draw(st.integers(0, len(A) - 1))
        x[i] = w[i] = 0
    return LCP(A, w - A @ x), x


def _complementary_pair(draw: Draw, n: int) -> tuple[Array, Array]:
    values, basic = vector(draw, n, POSITIVE), vector(draw, n, st.integers(0, 1))
    return basic * values, (1.0 - basic) * values


@st.composite
def two_solution_lcps(draw: Draw, n: Order = ORDERS) -> tuple[LCP, Array, Array]:
    """A problem and two solutions x and y, exactly.

    They differ by one in one coordinate.
    """
    order = draw(orders_of(n))
    x, w = _complementary_pair(draw, order)
    y, v = _complementary_pair(draw, order)
    j = draw(st.integers(0, order - 1))
    y[j], v[j] = x[j] + 1, 0
    A = square(draw, order)
    A[:, j] = 0
    A[:, j] = v - w - A @ (y - x)
    return LCP(A, w - A @ x), x, y


@st.composite
def near_singular_lcps(draw: Draw, n: Order = ORDERS) -> tuple[LCP, Array]:
    """A strictly feasible problem with a nearly singular matrix, and its start.

    One row combines the others, then one entry moves by 2^-k, k from 10 to 40.
    """
    order = draw(orders_of(n))
    A = square(draw, order)
    i = draw(st.integers(0, order - 1))
    A[i] = sum(draw(st.integers(-1, 1)) * A[j] for j in range(order) if j != i)
    A[i, draw(st.integers(0, order - 1))] += 2.0 ** -draw(st.integers(10, 40))
    return _with_start(draw, A)


@st.composite
def badly_scaled_lcps(draw: Draw, cls: str = "any", n: Order = ORDERS) -> tuple[LCP, Array]:
    """A strictly feasible problem in units from 2^-26 to 2^26, with its start.

    Powers of two scale exactly.

    Parameters
    ----------
    cls : str
        One of `CLASSES`.
    n : int or strategy of int
    """
    problem, x0 = draw(feasible_lcps(cls, n))
    powers = st.integers(-26, 26)
    left, right = (2.0 ** vector(draw, x0.size, powers) for _ in range(2))
    return LCP(left[:, None] * problem.A * right, left * problem.q), x0 / right
