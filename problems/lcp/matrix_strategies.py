"""Hypothesis strategies for matrices of a class, from integers, so that they shrink."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from hypothesis import strategies as st

from continuation.arrays import Array

Order = int | st.SearchStrategy[int]
Rows = list[list[int]]
Entries = st.SearchStrategy[int] | st.SearchStrategy[float] | None
Draw = st.DrawFn

ORDERS = st.integers(1, 4)
"""Default orders."""

_ENTRY = st.integers(-3, 3)
POSITIVE = st.integers(1, 4)


def orders_of(n: Order) -> st.SearchStrategy[int]:
    """A strategy of orders."""
    return st.just(n) if isinstance(n, int) else n


def square(draw: Draw, n: int, entry: st.SearchStrategy[int] = _ENTRY) -> Rows:
    """Any entries."""
    return [[draw(entry) for _ in range(n)] for _ in range(n)]


def _add(*parts: Rows) -> Rows:
    return [[sum(values) for values in zip(*rows, strict=True)] for rows in zip(*parts, strict=True)]


def _gram(draw: Draw, n: int) -> Rows:
    factor = [[draw(st.integers(-2, 2)) for _ in range(n)] for _ in range(draw(st.integers(0, n)))]
    return [[sum(row[i] * row[j] for row in factor) for j in range(n)] for i in range(n)]


def _skew(draw: Draw, n: int) -> Rows:
    upper = {(i, j): draw(_ENTRY) for i in range(n) for j in range(i + 1, n)}
    return [[upper.get((i, j), 0) - upper.get((j, i), 0) for j in range(n)] for i in range(n)]


def _diagonal(draw: Draw, n: int, entry: st.SearchStrategy[int]) -> Rows:
    return [[draw(entry) if i == j else 0 for j in range(n)] for i in range(n)]


def _scaled(draw: Draw, rows: Rows) -> Rows:
    """D A E with positive diagonals: keeps minor signs and sufficiency."""
    left, right = ([draw(st.integers(1, 3)) for _ in rows] for _ in range(2))
    return [[d * e * v for e, v in zip(right, row, strict=True)] for d, row in zip(left, rows, strict=True)]


def _signed(draw: Draw, rows: Rows) -> Rows:
    """S A S with signs S: keeps principal minors."""
    signs = [draw(st.sampled_from((1, -1))) for _ in rows]
    return [[s * t * v for t, v in zip(signs, row, strict=True)] for s, row in zip(signs, rows, strict=True)]


def _psd(draw: Draw, n: int) -> Rows:
    return _add(_gram(draw, n), _skew(draw, n))


def _z(draw: Draw, n: int) -> Rows:
    rows = square(draw, n, st.integers(-3, 0))
    return _add(rows, _diagonal(draw, n, st.integers(0, 6)))


def _k(draw: Draw, n: int) -> Rows:
    """Z with A s > 0 for an s > 0, so K."""
    rows = [[-draw(st.integers(0, 2)) if i != j else 0 for j in range(n)] for i in range(n)]
    for i, row in enumerate(rows):
        row[i] = draw(POSITIVE) - sum(row)
    return _scaled(draw, rows)


def _dominant(draw: Draw, n: int, signed: bool) -> Rows:
    """Diagonally dominant: principal submatrices are regular; P if the diagonal is positive."""
    rows = square(draw, n)
    for i, row in enumerate(rows):
        row[i] = sum(abs(value) for j, value in enumerate(row) if j != i) + draw(POSITIVE)
        row[i] *= draw(st.sampled_from((1, -1))) if signed else 1
    return rows


def _triangular(draw: Draw, n: int, diagonal: st.SearchStrategy[int]) -> Rows:
    """Principal minors are products of diagonal entries."""
    rows = square(draw, n)
    return [[draw(diagonal) if j == i else row[j] if j > i else 0 for j in range(n)] for i, row in enumerate(rows)]


def _p(draw: Draw, n: int) -> Rows:
    kind = draw(st.sampled_from(("definite", "dominant", "triangular")))
    if kind == "dominant":
        return _dominant(draw, n, False)
    if kind == "triangular":
        return _triangular(draw, n, POSITIVE)
    return _scaled(draw, _add(_psd(draw, n), _diagonal(draw, n, POSITIVE)))


def _p0(draw: Draw, n: int) -> Rows:
    return _triangular(draw, n, st.integers(0, 3)) if draw(st.booleans()) else _scaled(draw, _psd(draw, n))


def _nondegenerate(draw: Draw, n: int) -> Rows:
    entries = st.sampled_from((1, -1, 2, -2, 3))
    return _triangular(draw, n, entries) if draw(st.booleans()) else _dominant(draw, n, True)


def _n(draw: Draw, n: int) -> Rows:
    """K - u v' with u_i v_i > K_ii: det = det K (1 - v' K^-1 u) < 0 on every index set."""
    rows = _k(draw, n)
    u, v = [draw(st.integers(1, 2)) for _ in rows], [draw(st.integers(0, 2)) for _ in rows]
    weights = [extra + rows[i][i] // u[i] + 1 for i, extra in enumerate(v)]
    shifted = [[value - u[i] * weights[j] for j, value in enumerate(row)] for i, row in enumerate(rows)]
    return _signed(draw, shifted)


def _row_sufficient(draw: Draw, n: int) -> Rows:
    """Sufficient (scaled PSD, P), or P above zero rows (not column sufficient)."""
    kind = draw(st.sampled_from(("psd", "p", "zero rows")))
    if kind == "psd":
        return _scaled(draw, _psd(draw, n))
    if kind == "p":
        return _p(draw, n)
    leading = draw(st.integers(0, n))
    block = _p(draw, leading)
    return [[*block[i], *(draw(_ENTRY) for _ in range(n - leading))] if i < leading else [0] * n for i in range(n)]


def _copositive(draw: Draw, n: int) -> Rows:
    """PSD + nonnegative + skew: all copositive matrices for n <= 4 (Diananda 1962)."""
    return _add(_psd(draw, n), square(draw, n, st.integers(0, 3)))


_BUILDERS: Mapping[str, Callable[[Draw, int], Rows]] = {
    "any": square, "P": _p, "P0": _p0, "PSD": _psd, "K": _k, "Z": _z, "N": _n, "nondegenerate": _nondegenerate,
    "row_sufficient": _row_sufficient, "copositive": _copositive,
}  # fmt: skip

CLASSES: tuple[str, ...] = tuple(_BUILDERS)
"""Class names for `matrices`."""


@st.composite
def _matrices(draw: Draw, cls: str, n: Order, entries: Entries, shrinks: bool) -> Array:
    order = draw(orders_of(n))
    if entries is None:
        A = np.array(_BUILDERS[cls](draw, order), dtype=float)
    else:
        A = np.array([draw(entries) for _ in range(order * order)], dtype=float).reshape(order, order)
        if cls == "Z":
            A = np.where(np.eye(order, dtype=bool), A, -np.abs(A))
    if not shrinks:
        return A
    # Principal submatrices stay in the class; the last draw shrinks first.
    kept = [i for i in range(order) if draw(st.integers(0, 7))] or [0]
    return A[np.ix_(kept, kept)]


def matrices(cls: str = "any", n: Order = ORDERS, entries: Entries = None) -> st.SearchStrategy[Array]:
    """Integer matrices of a class, as floats, shape (n, n).

    Parameters
    ----------
    cls : str
        One of `CLASSES`.
    n : int or strategy of int
        The order, by default 1 to 4.
    entries : strategy of numbers, optional
        Only for "any" and "Z"; also floats.

    Raises
    ------
    ValueError
        For an unknown class, or entries that cannot be chosen.
    """
    if cls not in _BUILDERS:
        raise ValueError(f"cls: expected one of {', '.join(CLASSES)}, found {cls!r}")
    if entries is not None and cls not in ("any", "Z"):
        raise ValueError(f"entries: expected none for the class {cls}, whose members are built from integers")
    return _matrices(cls, n, entries, n is ORDERS)
