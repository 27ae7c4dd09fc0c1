"""Rules of numpy ufuncs for coefficients."""

from __future__ import annotations

import operator
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from continuation.arrays import Array, Mask
from continuation.numbers import series
from continuation.numbers.algebra import Algebra, Coefficients, compose, lengthened, product, quotient
from continuation.numbers.ends import Ends, bilinear, moved
from continuation.numbers.ranges import PI
from continuation.numbers.series import ELEMENTARY

Binary = Callable[[Algebra, Coefficients, Coefficients], Coefficients]


class UndecidedError(ArithmeticError):
    """A comparison holds for some numbers or boxes only."""


def own_axes(c: Coefficients) -> int:
    """Number of axes before the shape."""
    return 2 if isinstance(c, Ends) else 1


def aligned(a: Coefficients, b: Coefficients) -> tuple[Coefficients, Coefficients]:
    """Both with equally many axes."""
    if a.ndim == b.ndim:
        return a, b
    if a.ndim > b.ndim:
        return aligned(b, a)[::-1]
    own, more = own_axes(a), (1,) * (b.ndim - a.ndim)
    return moved(lambda x: x.reshape(x.shape[:own] + more + x.shape[own:]), a), b


def spread(c: Coefficients, shape: tuple[int, ...]) -> Coefficients:
    """A copy, broadcast to `shape`."""
    return (
        c.copy() if c.shape[1:] == shape else moved(lambda x: np.array(np.broadcast_to(x, (len(x), *shape))), c).copy()
    )


def _add(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
    if len(a) == len(b):
        return a + b
    if len(a) < len(b):
        a, b = b, a
    value = a[:1] + b
    out = spread(a, value.shape[1:])
    out[:1] = value
    return out


def _multiply(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
    if a is b and isinstance(a, Ends):  # a square is not negative
        return compose(algebra, series.square, a)
    return product(algebra, operator.mul, a, b)


def _power(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
    exponents = _exponents(b)
    if exponents is None:
        return _variable_power(algebra, a, b)
    if exponents.size == 1:
        return compose(algebra, partial(series.power, r=exponents.item()), a)
    distinct = np.unique(exponents)
    a = spread(a, np.broadcast_shapes(a.shape[1:], b.shape[1:]))
    if len(distinct) == 1:
        return compose(algebra, partial(series.power, r=float(distinct[0])), a)
    exponents = np.broadcast_to(exponents, a.shape[own_axes(a) :])
    for r in distinct:
        entries = (..., exponents == r)
        a[entries] = compose(algebra, partial(series.power, r=float(r)), a[entries])
    return a


def _exponents(b: Coefficients) -> Array | None:
    if len(b) > 1:
        return None
    if not isinstance(b, Ends):
        return np.asarray(b[0])
    return np.asarray(b.lo[0, 0]) if b.shape[1] == 1 and np.array_equal(b.lo, b.hi) else None


def _variable_power(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
    exp, log = ELEMENTARY[np.exp], ELEMENTARY[np.log]
    if isinstance(a, Ends):
        return compose(algebra, exp, product(algebra, operator.mul, compose(algebra, log, a), b))
    series.demand(~(a[0] <= 0), "numpy.power", "a variable exponent needs a base with positive leading coefficient")
    logarithm = compose(algebra, log, a) if len(a) > 1 else np.log(a)
    out = compose(algebra, exp, product(algebra, operator.mul, logarithm, b))
    out[0] = a[0] ** b[0]
    return out


def _hypot(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
    return compose(algebra, series.sqrt, _add(algebra, *(_multiply(algebra, x, x) for x in (a, b))))


def _arctan2(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
    """arctan(a / b), or a quarter turn less arctan(b / a), whichever is defined; nan across the negative axis."""
    a, b = (lengthened(x, max(len(a), len(b))) for x in (a, b))
    boxes = isinstance(a, Ends)
    if not boxes:
        series.demand((a[0] != 0) | (b[0] != 0), "numpy.arctan2", "both leading coefficients are 0")
    ahead: Mask = b.lo[:1] > 0.0 if boxes else ~(np.abs(b[:1]) < np.abs(a[:1]))

    def chosen(x: Coefficients, y: Coefficients) -> Coefficients:
        return moved(lambda *both: np.asarray(np.where(ahead, *both)), x, y)

    out = compose(algebra, ELEMENTARY[np.arctan], quotient(algebra, chosen(a, -b), chosen(b, a)))
    if not boxes:
        out[0] = np.arctan2(a[0], b[0])
        return out
    above, quarter = a.lo[:1] > 0.0, PI * 0.5
    turned = Ends(np.where(above, quarter.lo, -quarter.hi), np.where(above, quarter.hi, -quarter.lo))
    return chosen(out, _add(algebra, out, turned))


def _extremum(name: str, sign: int) -> Binary:
    def rule(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
        a, b = (lengthened(x, max(len(a), len(b))) for x in (a, b))
        if isinstance(a, Ends):
            return _larger(algebra, a, b) if sign > 0 else -_larger(algebra, -a, -b)
        series.demand(a[0] != b[0], name, "the leading coefficients tie, and the two sides may part")
        return np.where(sign * a[0] > sign * b[0], a, b)

    return rule


def _larger(algebra: Algebra, a: Ends, b: Ends) -> Ends:
    """The maximum; undecided boxes have both slopes, then nan."""
    first, second = a.lo[:1] > b.hi[:1], b.lo[:1] > a.hi[:1]
    lo = np.where(first, a.lo, np.where(second, b.lo, np.minimum(a.lo, b.lo)))
    hi = np.where(first, a.hi, np.where(second, b.hi, np.maximum(a.hi, b.hi)))
    bent = np.array(algebra.degrees(len(lo))) > 1
    lo[bent], hi[bent] = (np.where(first | second, x[bent], np.nan) for x in (lo, hi))
    lo[:1] = np.maximum(a.lo[:1], b.lo[:1])
    return Ends(lo, hi)


def matmul(algebra: Algebra, a: Coefficients, b: Coefficients) -> Coefficients:
    """The matrix product, as numpy's."""
    own = own_axes(a)
    if a.ndim == own or b.ndim == own:
        raise ValueError("numpy.matmul: a scalar has no matrix product; use *")
    if own == 1 and len(a) == 1 and a.ndim <= 3 and b.ndim == 2:
        return np.asarray(b @ a[0].T)  # a constant matrix: one BLAS product for all
    if own == 1 and len(b) == 1 and b.ndim <= 3 and a.ndim == 2:
        return np.asarray(a @ b[0])
    row, column = a.ndim == own + 1, b.ndim == own + 1
    a = moved(lambda x: x[..., None, :], a) if row else a
    b = moved(lambda x: x[..., None], b) if column else b
    out = product(algebra, sums_of_products(np.matmul), *aligned(a, b))
    out = out[..., 0] if column else out
    return moved(lambda x: np.squeeze(x, axis=-1 if column else -2), out) if row else out


def sums_of_products(function: Callable[[Array, Array], Array]) -> Callable[[Any, Any], Any]:
    """Extend a bilinear function to coefficients."""
    return lambda a, b: bilinear(function, a, b) if isinstance(a, Ends) else function(a, b)


def _composed(rule: series.SeriesRule, algebra: Algebra, a: Coefficients) -> Coefficients:
    return compose(algebra, rule, a)


UFUNC_RULES: dict[np.ufunc, Callable[..., Coefficients]] = {
    np.positive: lambda algebra, a: a.copy(),
    np.negative: lambda algebra, a: -a,
    np.fabs: partial(_composed, series.absolute),
    **{f: partial(_composed, rule) for f, rule in ELEMENTARY.items()},
    np.add: _add,
    np.subtract: lambda algebra, a, b: a - b if len(a) == len(b) else _add(algebra, a, -b),
    np.multiply: _multiply,
    np.divide: quotient,
    np.power: _power,
    np.float_power: _power,
    np.hypot: _hypot,
    np.arctan2: _arctan2,
    np.maximum: _extremum("numpy.maximum", 1),
    np.minimum: _extremum("numpy.minimum", -1),
    np.matmul: matmul,
}
"""Rules for an algebra and coefficients; these have equally many axes, but for `matmul`."""


# Comparisons


NEGATION: dict[np.ufunc, np.ufunc] = {np.less: np.greater_equal, np.greater: np.less_equal, np.equal: np.not_equal}
NEGATION |= {other: one for one, other in NEGATION.items()}
"""Negations of comparisons."""


def _surely(ufunc: np.ufunc, a: Ends, b: Ends) -> Mask:
    if ufunc is np.not_equal:
        return _surely(np.less, a, b) | _surely(np.greater, a, b)
    holds: Mask = ufunc(a.lo, b.lo) & ufunc(a.lo, b.hi) & ufunc(a.hi, b.lo) & ufunc(a.hi, b.hi)
    return holds


def compared(ufunc: np.ufunc, a: Coefficients, b: Coefficients) -> Any:
    """A comparison; UndecidedError unless it holds for all numbers of all boxes, or for none."""
    if not isinstance(a, Ends):
        return ufunc(a[0], b[0])
    yes, no = (_surely(f, a[0], b[0]).all(axis=0) for f in (ufunc, NEGATION[ufunc]))
    if not (yes | no).all():
        raise UndecidedError("a comparison is not decided on a box: it holds for some of its points only")
    return yes


def all_finite(c: Coefficients) -> Any:
    """Where all coefficients are finite."""
    if isinstance(c, Ends):
        return (np.isfinite(c.lo) & np.isfinite(c.hi)).all(axis=(0, 1))
    return np.isfinite(c).all(axis=0)


DECIDED: dict[np.ufunc, Callable[..., Any]] = {
    **{f: partial(compared, f) for f in NEGATION},
    np.isfinite: all_finite,
    np.isnan: lambda c: ~all_finite(c) if isinstance(c, Ends) else np.isnan(c).any(axis=0),
}
"""Ufuncs whose results are no series."""
