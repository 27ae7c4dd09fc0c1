"""What each numpy ufunc does to coefficient arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.jets import series
from continuation.jets.algebra import Algebra

Binary = Callable[[Algebra, Array, Array], Array]


def _add(algebra: Algebra, a: Array, b: Array) -> Array:
    if len(a) == len(b):
        return a + b
    if len(a) < len(b):
        a, b = b, a
    shape = np.broadcast_shapes(a.shape[1:], b.shape[1:])
    out = a.copy() if a.shape[1:] == shape else np.array(np.broadcast_to(a, (len(a), *shape)))
    out[0] += b[0]
    return out


def _subtract(algebra: Algebra, a: Array, b: Array) -> Array:
    return a - b if len(a) == len(b) else _add(algebra, a, -b)


def _power(algebra: Algebra, a: Array, b: Array) -> Array:
    if len(b) == 1:
        return algebra.compose(lambda u: series.power(u, b[0]), a) if len(a) > 1 else series.power(a, b[0])
    series.demand(~(a[0] <= 0), "numpy.power", "a variable exponent needs a base with positive leading coefficient")
    logarithm = algebra.compose(series.log, a) if len(a) > 1 else np.log(a)
    out = algebra.compose(series.exp, algebra.product(np.multiply, logarithm, b))
    out[0] = a[0] ** b[0]
    return out


def _hypot(algebra: Algebra, a: Array, b: Array) -> Array:
    size = np.hypot(a[:1], b[:1])
    series.demand(size != 0, "numpy.hypot", "both leading coefficients are 0")
    a, b = a / size, b / size
    squares = _add(algebra, algebra.product(np.multiply, a, a), algebra.product(np.multiply, b, b))
    return np.asarray(size * algebra.compose(series.sqrt, squares))


def _arctan2(algebra: Algebra, a: Array, b: Array) -> Array:
    size = np.hypot(a[:1], b[:1])
    series.demand(size != 0, "numpy.arctan2", "both leading coefficients are 0")
    # Turned by its leading angle, the point lies on the positive axis, where arctan of the slope is analytic.
    sine, cosine = a[:1] / size, b[:1] / size
    along, across = _add(algebra, cosine * b, sine * a), _subtract(algebra, cosine * a, sine * b)
    out = algebra.compose(series.arctan, algebra.quotient(across, along))
    out[0] = np.arctan2(a[0], b[0])
    return out


def _extremum(name: str, sign: int) -> Binary:
    def rule(algebra: Algebra, a: Array, b: Array) -> Array:
        series.demand(a[0] != b[0], name, "the leading coefficients tie, and the two sides may part")
        length = max(len(a), len(b))
        first = sign * a[0] > sign * b[0]
        return np.where(first, series.extended(a, length), series.extended(b, length))

    return rule


ELEMENTARY: dict[str, series.Rule] = {
    name: getattr(series, name)
    for name in (
        *("absolute", "square", "sqrt", "cbrt", "reciprocal"),
        *("exp", "expm1", "exp2", "log", "log1p", "log2", "log10"),
        *("sin", "cos", "tan", "arcsin", "arccos", "arctan"),
        *("sinh", "cosh", "tanh", "arcsinh", "arccosh", "arctanh"),
    )
}
"""Functions of one argument, by their numpy names."""


def _composed(rule: series.Rule) -> Callable[[Algebra, Array], Array]:
    return lambda algebra, a: algebra.compose(rule, a)


UNARY: dict[np.ufunc, Callable[[Algebra, Array], Array]] = {
    np.positive: lambda algebra, a: a.copy(),
    np.negative: lambda algebra, a: -a,
    np.fabs: _composed(series.absolute),
    **{getattr(np, name): _composed(rule) for name, rule in ELEMENTARY.items()},
}

BINARY: dict[np.ufunc, Binary] = {
    np.add: _add,
    np.subtract: _subtract,
    np.multiply: lambda algebra, a, b: algebra.product(np.multiply, a, b),
    np.divide: lambda algebra, a, b: algebra.quotient(a, b),
    np.power: _power,
    np.float_power: _power,
    np.hypot: _hypot,
    np.arctan2: _arctan2,
    np.maximum: _extremum("numpy.maximum", 1),
    np.minimum: _extremum("numpy.minimum", -1),
}
"""Elementwise functions of two arguments, whose coefficient arrays have been given the same number of axes."""

COMPARISONS: frozenset[np.ufunc] = frozenset(
    (np.less, np.less_equal, np.greater, np.greater_equal, np.equal, np.not_equal)
)
"""Decided by the leading coefficients."""

TESTS: dict[np.ufunc, Callable[[Array], Any]] = {
    np.isfinite: lambda a: np.isfinite(a).all(axis=0),
    np.isnan: lambda a: np.isnan(a).any(axis=0),
}
"""Decided by all coefficients."""


def matmul(algebra: Algebra, a: Array, b: Array) -> Array:
    """The product of series of vectors and matrices, with numpy's rules for vectors and stacks."""
    if a.ndim == 1 or b.ndim == 1:
        raise ValueError("numpy.matmul: a scalar has no matrix product; use *")
    if len(a) == 1 and a.ndim <= 3 and b.ndim == 2:
        return np.asarray(b @ a[0].T)  # a constant matrix: one BLAS product for all coefficients
    if len(b) == 1 and b.ndim <= 3 and a.ndim == 2:
        return np.asarray(a @ b[0])
    row, column = a.ndim == 2, b.ndim == 2
    a, b = aligned(a[:, None] if row else a, b[..., None] if column else b)
    out = algebra.product(np.matmul, a, b)
    out = out[..., 0] if column else out
    return np.squeeze(out, axis=-1 if column else -2) if row else out


def aligned(a: Array, b: Array) -> tuple[Array, Array]:
    """Both arrays with as many axes behind the leading one, as broadcasting wants them."""
    if a.ndim < b.ndim:
        a = a.reshape(len(a), *(1,) * (b.ndim - a.ndim), *a.shape[1:])
    elif b.ndim < a.ndim:
        b = b.reshape(len(b), *(1,) * (a.ndim - b.ndim), *b.shape[1:])
    return a, b
