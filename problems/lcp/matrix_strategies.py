"""Hypothesis strategies for matrices of a class, from integers, so that they shrink."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from hypothesis import strategies as st

from continuation.arguments.checks import expect
from continuation.arrays import Array

Order = int | st.SearchStrategy[int]
Entries = st.SearchStrategy[int] | st.SearchStrategy[float]
Draw = st.DrawFn

ORDERS = st.integers(1, 4)
"""Default orders."""

_ENTRY = st.integers(-3, 3)
POSITIVE = st.integers(1, 4)


def orders_of(n: Order) -> st.SearchStrategy[int]:
    """A strategy of orders."""
    return st.just(n) if isinstance(n, int) else n


def vector(draw: Draw, n: int, entry: Entries = _ENTRY) -> Array:
    """Any integers, as floats."""
    return np.array([draw(entry) for _ in range(n)], dtype=float)


def square(draw: Draw, n: int, entry: Entries = _ENTRY) -> Array:
    """Any entries."""
    return vector(draw, n * n, entry).reshape(n, n)


def _scaled(draw: Draw, A: Array) -> Array:
    """D A E with positive diagonals: keeps minor signs and sufficiency."""
    left, right = (vector(draw, len(A), st.integers(1, 3)) for _ in range(2))
    return left[:, None] * A * right


def _psd(draw: Draw, n: int) -> Array:
    """B'B plus a skew matrix."""
    rank, upper = draw(st.integers(0, n)), np.zeros((n, n))
    factor = vector(draw, rank * n, st.integers(-2, 2)).reshape(rank, n)
    upper[np.triu_indices(n, 1)] = vector(draw, n * (n - 1) // 2)
    return factor.T @ factor + upper - upper.T


def _z(draw: Draw, n: int) -> Array:
    return square(draw, n, st.integers(-3, 0)) + np.diag(vector(draw, n, st.integers(0, 6)))


def _k(draw: Draw, n: int) -> Array:
    """A Z-matrix with A s > 0 for an s > 0, so K."""
    A = -square(draw, n, st.integers(0, 2))
    np.fill_diagonal(A, 0.0)
    return _scaled(draw, A + np.diag(vector(draw, n, POSITIVE) - A.sum(axis=1)))


def _dominant(draw: Draw, n: int, signs: tuple[int, ...] = (1,)) -> Array:
    """Diagonally dominant: principal submatrices are regular; P if the diagonal is positive."""
    A = square(draw, n)
    np.fill_diagonal(A, 0.0)
    diagonal = np.abs(A).sum(axis=1) + vector(draw, n, POSITIVE)
    return A + np.diag(diagonal * vector(draw, n, st.sampled_from(signs)))


def _triangular(draw: Draw, n: int, diagonal: st.SearchStrategy[int]) -> Array:
    """Principal minors are products of diagonal entries."""
    return np.triu(square(draw, n), 1) + np.diag(vector(draw, n, diagonal))


def _p(draw: Draw, n: int) -> Array:
    kind = draw(st.sampled_from(("definite", "dominant", "triangular")))
    if kind == "dominant":
        return _dominant(draw, n)
    if kind == "triangular":
        return _triangular(draw, n, POSITIVE)
    return _scaled(draw, _psd(draw, n) + np.diag(vector(draw, n, POSITIVE)))


def _p0(draw: Draw, n: int) -> Array:
    return _triangular(draw, n, st.integers(0, 3)) if draw(st.booleans()) else _scaled(draw, _psd(draw, n))


def _nondegenerate(draw: Draw, n: int) -> Array:
    entries = st.sampled_from((1, -1, 2, -2, 3))
    return _triangular(draw, n, entries) if draw(st.booleans()) else _dominant(draw, n, (1, -1))


def _n(draw: Draw, n: int) -> Array:
    """S (K - u v') S with signs S and u_i v_i > K_ii: det = det K (1 - v' K^-1 u) < 0 on every index set."""
    K, u, more = _k(draw, n), vector(draw, n, st.integers(1, 2)), vector(draw, n, st.integers(0, 2))
    signs = vector(draw, n, st.sampled_from((1, -1)))
    return np.outer(signs, signs) * (K - np.outer(u, more + K.diagonal() // u + 1.0))


def _row_sufficient(draw: Draw, n: int) -> Array:
    """Sufficient (scaled PSD, P), or P above zero rows (not column sufficient)."""
    kind = draw(st.sampled_from(("psd", "p", "zero rows")))
    if kind == "psd":
        return _scaled(draw, _psd(draw, n))
    if kind == "p":
        return _p(draw, n)
    leading, A = draw(st.integers(0, n)), square(draw, n)
    A[:leading, :leading], A[leading:] = _p(draw, leading), 0.0
    return A


def _copositive(draw: Draw, n: int) -> Array:
    """PSD + nonnegative + skew: all copositive matrices for n <= 4 (Diananda 1962)."""
    return _psd(draw, n) + square(draw, n, st.integers(0, 3))


_BUILDERS: Mapping[str, Callable[[Draw, int], Array]] = {
    "any": square, "P": _p, "P0": _p0, "PSD": _psd, "K": _k, "Z": _z, "N": _n, "nondegenerate": _nondegenerate,
    "row_sufficient": _row_sufficient, "copositive": _copositive,
}  # fmt: skip

CLASSES: tuple[str, ...] = tuple(_BUILDERS)
"""Class names for `matrices`."""


@st.composite
def _matrices(draw: Draw, cls: str, n: Order, entries: Entries | None, shrinks: bool) -> Array:
    order = draw(orders_of(n))
    if entries is None:
        A = _BUILDERS[cls](draw, order)
    else:
        A = square(draw, order, entries)
        if cls == "Z":
            A = np.where(np.eye(order, dtype=bool), A, -np.abs(A))
    if not shrinks:
        return A
    # Principal submatrices stay in the class; the last draw shrinks first.
    kept = [i for i in range(order) if draw(st.integers(0, 7))] or [0]
    return A[np.ix_(kept, kept)]


def matrices(cls: str = "any", n: Order = ORDERS, entries: Entries | None = None) -> st.SearchStrategy[Array]:
    """Integer matrices of a class, as floats, shape (n, n).

    Parameters
    ----------
    cls : str
        One of `CLASSES`.
    n : int or strategy of int
        The order, by default 1 to 4.
    entries : strategy of numbers, optional
        Only for "any" and "Z"; also floats.
    """
    expect(cls in CLASSES, "cls", f"one of {', '.join(CLASSES)}", cls)
    free = entries is None or cls in ("any", "Z")
    expect(free, "entries", f"none for the class {cls}, whose members are built from integers", entries)
    return _matrices(cls, n, entries, n is ORDERS)
