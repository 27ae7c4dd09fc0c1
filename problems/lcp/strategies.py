"""Hypothesis strategies: matrices of a class and problems with a property, built from integers so that they shrink.

Members are constructed, not filtered. No other module of the package needs Hypothesis.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

import numpy as np
from hypothesis import strategies as st

from continuation.arrays import Array
from problems.lcp.classes.exact import principal_minors
from problems.lcp.data.problem import LCP

Order = int | st.SearchStrategy[int]
Rows = list[list[int]]
Draw = st.DrawFn

ORDERS = st.integers(1, 4)
"""The orders drawn when none is given."""

_ENTRY = st.integers(-3, 3)
_POSITIVE = st.integers(1, 4)
_NONNEGATIVE = st.integers(0, 3)


def _orders(n: Order) -> st.SearchStrategy[int]:
    return st.just(n) if isinstance(n, int) else n


def _square(draw: Draw, n: int, entry: st.SearchStrategy[int] = _ENTRY) -> Rows:
    return [[draw(entry) for _ in range(n)] for _ in range(n)]


def _add(*parts: Rows) -> Rows:
    return [[sum(values) for values in zip(*rows, strict=True)] for rows in zip(*parts, strict=True)]


def _gram(draw: Draw, n: int) -> Rows:
    """B'B with B of any rank."""
    factor = [[draw(st.integers(-2, 2)) for _ in range(n)] for _ in range(draw(st.integers(0, n)))]
    return [[sum(row[i] * row[j] for row in factor) for j in range(n)] for i in range(n)]


def _skew(draw: Draw, n: int) -> Rows:
    upper = {(i, j): draw(_ENTRY) for i in range(n) for j in range(i + 1, n)}
    return [[upper.get((i, j), 0) - upper.get((j, i), 0) for j in range(n)] for i in range(n)]


def _diagonal(draw: Draw, n: int, entry: st.SearchStrategy[int]) -> Rows:
    return [[draw(entry) if i == j else 0 for j in range(n)] for i in range(n)]


def _scaled(draw: Draw, rows: Rows) -> Rows:
    """D A E with positive diagonal D and E, which keeps minor signs and sufficiency."""
    left, right = ([draw(st.integers(1, 3)) for _ in rows] for _ in range(2))
    return [[d * e * v for e, v in zip(right, row, strict=True)] for d, row in zip(left, rows, strict=True)]


def _signed(draw: Draw, rows: Rows) -> Rows:
    """S A S with a signature S, which keeps every principal minor."""
    signs = [draw(st.sampled_from((1, -1))) for _ in rows]
    return [[s * t * v for t, v in zip(signs, row, strict=True)] for s, row in zip(signs, rows, strict=True)]


def _psd(draw: Draw, n: int) -> Rows:
    return _add(_gram(draw, n), _skew(draw, n))


def _z(draw: Draw, n: int) -> Rows:
    rows = _square(draw, n, st.integers(-3, 0))
    return _add(rows, _diagonal(draw, n, st.integers(0, 6)))


def _k(draw: Draw, n: int) -> Rows:
    """Z with positive row sums, columns scaled: Z with A s > 0 for an s > 0, which is K."""
    rows = [[-draw(st.integers(0, 2)) if i != j else 0 for j in range(n)] for i in range(n)]
    for i, row in enumerate(rows):
        row[i] = draw(_POSITIVE) - sum(row)
    return _scaled(draw, rows)


def _bordered(draw: Draw, n: int, last: Callable[[Draw, list[int], list[int]], int | None]) -> Rows:
    """Grow a matrix by one row and column at a time; `last` draws the new diagonal entry from what the minors allow.

    It sees, for every index set of the old matrix, the old minor and the bordered minor with diagonal entry zero: the
    new minor is entry * old + bordered. Where it finds no entry, the new column is set to zero, so that bordered = 0.
    """
    rows: Rows = []
    for k in range(n):
        row, column = [draw(_ENTRY) for _ in range(k)], [draw(_ENTRY) for _ in range(k)]
        entry = last(draw, *_affine_minors(rows, row, column))
        if entry is None:
            column = [0] * k
            entry = last(draw, *_affine_minors(rows, row, column))
        assert entry is not None, "a zero column leaves the minors entry * old"
        rows = [[*old, c] for old, c in zip(rows, column, strict=True)] + [[*row, entry]]
    return rows


def _affine_minors(rows: Rows, row: Sequence[int], column: Sequence[int]) -> tuple[list[int], list[int]]:
    minors = principal_minors([*([*old, c] for old, c in zip(rows, column, strict=True)), [*row, 0]])
    half = len(minors) // 2
    return minors[:half], minors[half:]


def _p(draw: Draw, n: int) -> Rows:
    """P, with any off-diagonal entries in range: the new diagonal entry exceeds -bordered / old for each index set."""

    def last(draw: Draw, old: list[int], bordered: list[int]) -> int:
        return max(-b // m for m, b in zip(old, bordered, strict=True)) + draw(_POSITIVE)

    return _bordered(draw, n, last)


def _p0(draw: Draw, n: int) -> Rows:
    """P0: as for P, with equality allowed, and a border that no diagonal entry can mend replaced."""

    def last(draw: Draw, old: list[int], bordered: list[int]) -> int | None:
        if any(m == 0 and b < 0 for m, b in zip(old, bordered, strict=True)):
            return None
        lowest = max(-(b // m) for m, b in zip(old, bordered, strict=True) if m)
        return lowest + draw(_NONNEGATIVE)

    return _bordered(draw, n, last)


def _nondegenerate(draw: Draw, n: int) -> Rows:
    """Nondegenerate, with any off-diagonal entries in range: the new diagonal entry avoids each -bordered / old."""

    def last(draw: Draw, old: list[int], bordered: list[int]) -> int:
        forbidden = {Fraction(-b, m) for m, b in zip(old, bordered, strict=True)}
        small = sorted(range(-len(old) - 5, len(old) + 6), key=lambda v: (abs(v), v < 0))
        return draw(st.sampled_from([v for v in small if v not in forbidden][:8]))

    return _bordered(draw, n, last)


def _n(draw: Draw, n: int) -> Rows:
    """K - u v' with u_i v_i > K_ii, with signs and scales: det = det K (1 - v' K^-1 u) < 0 on every index set."""
    rows = _k(draw, n)
    u, v = [draw(st.integers(1, 2)) for _ in rows], [draw(st.integers(0, 2)) for _ in rows]
    weights = [extra + rows[i][i] // u[i] + 1 for i, extra in enumerate(v)]
    shifted = [[value - u[i] * weights[j] for j, value in enumerate(row)] for i, row in enumerate(rows)]
    return _signed(draw, shifted)


def _row_sufficient(draw: Draw, n: int) -> Rows:
    """PSD scaled from both sides (sufficient), P, or P with zero rows below it (row but not column sufficient)."""
    kind = draw(st.sampled_from(("psd", "p", "zero rows")))
    if kind == "psd":
        return _scaled(draw, _psd(draw, n))
    if kind == "p":
        return _p(draw, n)
    leading = draw(st.integers(0, n))
    block = _p(draw, leading)
    return [[*block[i], *(draw(_ENTRY) for _ in range(n - leading))] if i < leading else [0] * n for i in range(n)]


def _copositive(draw: Draw, n: int) -> Rows:
    """PSD plus nonnegative plus skew, which is every copositive matrix for n <= 4 (Diananda 1962)."""
    return _add(_psd(draw, n), _square(draw, n, _NONNEGATIVE))


_BUILDERS: Mapping[str, Callable[[Draw, int], Rows]] = {
    "any": _square, "P": _p, "P0": _p0, "PSD": _psd, "K": _k, "Z": _z, "N": _n, "nondegenerate": _nondegenerate,
    "row_sufficient": _row_sufficient, "copositive": _copositive,
}  # fmt: skip

CLASSES: tuple[str, ...] = tuple(_BUILDERS)
"""The class names that `matrices` knows."""


@st.composite
def _matrices(draw: Draw, cls: str, n: Order) -> Array:
    rows = _BUILDERS[cls](draw, draw(_orders(n)))
    return np.array(rows, dtype=float)


def matrices(cls: str = "any", n: Order = ORDERS) -> st.SearchStrategy[Array]:
    """Integer matrices of a class, as floats, shape (n, n).

    Parameters
    ----------
    cls : str
        One of `CLASSES`.
    n : int or strategy of int
        The order.

    Raises
    ------
    ValueError
        If the class is not one of them.
    """
    if cls not in _BUILDERS:
        raise ValueError(f"cls: expected one of {', '.join(CLASSES)}, found {cls!r}")
    return _matrices(cls, n)


@st.composite
def lcps(draw: Draw, cls: str = "any", n: Order = ORDERS) -> LCP:
    """Problems with a matrix of the class and any integer q, feasible or not."""
    A = draw(matrices(cls, n))
    return LCP(A, np.array([draw(st.integers(-4, 4)) for _ in A], dtype=float))


@st.composite
def feasible_lcps(draw: Draw, cls: str = "any", n: Order = ORDERS) -> tuple[LCP, Array]:
    """A problem and a strictly feasible start: x0 > 0 and A x0 + q > 0, exactly (all are integers)."""
    A = draw(matrices(cls, n))
    x0, w0 = (np.array([draw(_POSITIVE) for _ in A], dtype=float) for _ in range(2))
    return LCP(A, w0 - A @ x0), x0


def planted_lcps(kind: str = "strict", cls: str = "any", n: Order = ORDERS) -> st.SearchStrategy[tuple[LCP, Array]]:
    """A problem and one of its solutions x, exactly (all are integers).

    Parameters
    ----------
    kind : str
        "strict": the planted solution is strictly complementary. "degenerate": x_i = w_i = 0 for at least one i.
        "many": the problem has at least two solutions; its matrix is of no class (`two_solution_lcps` gives both).
    cls : str
        The matrix, for the first two kinds.
    n : int or strategy of int

    Raises
    ------
    ValueError
        If the kind is none of these, or "many" is asked with a class.
    """
    if kind == "strict":
        return _planted(cls, n, degenerate=False)
    if kind == "degenerate":
        return _planted(cls, n, degenerate=True)
    if kind != "many":
        raise ValueError(f"kind: expected strict, degenerate or many, found {kind!r}")
    if cls != "any":
        raise ValueError(f"cls: expected any for kind many, found {cls!r}")
    return two_solution_lcps(n).map(lambda triple: triple[:2])


@st.composite
def _planted(draw: Draw, cls: str, n: Order, degenerate: bool) -> tuple[LCP, Array]:
    A = draw(matrices(cls, n))
    x, w = _complementary_pair(draw, len(A))
    if degenerate:
        i = draw(st.integers(0, len(A) - 1))
        x[i] = w[i] = 0
    return LCP(A, w - A @ x), x


def _complementary_pair(draw: Draw, n: int) -> tuple[Array, Array]:
    """X and w with exactly one of x_i, w_i positive."""
    values = [draw(_POSITIVE) for _ in range(n)]
    basic = [draw(st.booleans()) for _ in range(n)]
    x = np.array([v if b else 0 for v, b in zip(values, basic, strict=True)], dtype=float)
    return x, np.array(values, dtype=float) - x


@st.composite
def two_solution_lcps(draw: Draw, n: Order = ORDERS) -> tuple[LCP, Array, Array]:
    """A problem and two distinct solutions x and y, exactly.

    They differ by one in some coordinate j, so the column j of A can be chosen to give A (x - y) = w(x) - w(y).
    """
    order = draw(_orders(n))
    x, w = _complementary_pair(draw, order)
    y, v = _complementary_pair(draw, order)
    j = draw(st.integers(0, order - 1))
    y[j], v[j] = x[j] + 1, 0
    A = np.array(_square(draw, order), dtype=float)
    A[:, j] = 0
    A[:, j] = v - w - A @ (y - x)
    return LCP(A, w - A @ x), x, y


@st.composite
def near_singular_lcps(draw: Draw, n: Order = ORDERS) -> tuple[LCP, Array]:
    """A strictly feasible problem whose matrix is a power of two away from a singular one, with its start.

    One row is an integer combination of the others (zero for n = 1), then one entry moves by 2^-k, k from 10 to 40.
    """
    order = draw(_orders(n))
    A = np.array(_square(draw, order), dtype=float)
    i = draw(st.integers(0, order - 1))
    A[i] = sum(draw(st.integers(-1, 1)) * A[j] for j in range(order) if j != i)
    A[i, draw(st.integers(0, order - 1))] += 2.0 ** -draw(st.integers(10, 40))
    x0, w0 = (np.array([draw(_POSITIVE) for _ in A], dtype=float) for _ in range(2))
    return LCP(A, w0 - A @ x0), x0


@st.composite
def badly_scaled_lcps(draw: Draw, cls: str = "any", n: Order = ORDERS) -> tuple[LCP, Array]:
    """A strictly feasible problem in units between 2^-26 and 2^26 (ratios beyond 1e15), with its start.

    The scaling D A E, D q, x0 / E by powers of two is exact and keeps the solutions one to one.
    """
    problem, x0 = draw(feasible_lcps(cls, n))
    powers = st.integers(-26, 26)
    left, right = (np.array([2.0 ** draw(powers) for _ in x0]) for _ in range(2))
    return LCP(left[:, None] * problem.A * right, left * problem.q), x0 / right
