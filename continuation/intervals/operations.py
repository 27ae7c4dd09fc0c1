"""What each numpy ufunc makes of interval arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import issparse

from continuation.arrays import Array
from continuation.intervals.array import (
    CURVE,
    FUNCTIONS,
    Interval,
    UndecidedError,
    alike,
    as_interval,
    spread,
    unknown,
    wrap,
)
from continuation.intervals.elementary import PI, RULES, Rule, power_rule
from continuation.intervals.ends import Ends, Mask, bilinear, thin


def sum_of(a: Ends, b: Ends) -> Ends:
    """The sum, coefficient by coefficient; one of them may have the value alone."""
    if len(a.lo) < len(b.lo):
        a, b = b, a
    if len(a.lo) == len(b.lo):
        return a + b
    value = a[:1] + b
    return with_value(value, broadcast(a[1:], value.shape[1:]))


def broadcast(a: Ends, shape: tuple[int, ...]) -> Ends:
    """With these axes behind the coefficients."""
    return Ends(*(np.broadcast_to(x, (len(x), *shape)) for x in (a.lo, a.hi)))


def with_value(value: Ends, rest: Ends) -> Ends:
    """Coefficients put together."""
    return Ends(np.concatenate([value.lo, rest.lo]), np.concatenate([value.hi, rest.hi]))


def product_of(multiply: Callable[[Ends, Ends], Ends], a: Ends, b: Ends, algebra: int) -> Ends:
    """A bilinear product, which broadcasts over coefficients and boxes."""
    if len(a.lo) == 1 or len(b.lo) == 1:
        return multiply(a, b)
    value = multiply(a[:1], b[:1])
    slopes = multiply(a[1:], b[:1]) + multiply(a[:1], b[1:])
    if algebra == CURVE:
        second = slopes[1:] + multiply(a[1:2], b[1:2])
        slopes = with_value(slopes[:1], second)
    return with_value(value, slopes)


def compose(rule: Rule, a: Ends, algebra: int) -> Ends:
    """A function of one argument, by the chain rule."""
    u = a[:1]
    value = rule.value(u)
    if len(a.lo) == 1:
        return value
    # Some derivatives have a formula where the function has no value.
    slopes = rule.first(u, value).where(~np.isnan(value.lo) & ~np.isnan(value.hi)) * a[1:]
    if algebra == CURVE:
        half = thin(np.full((1,), 0.5))
        squares = RULES["square"].value(a[1:2])
        slopes = with_value(slopes[:1], slopes[1:] + half * rule.second(u, value) * squares)
    return with_value(value, slopes)


def apply(ufunc: np.ufunc, inputs: tuple[Any, ...]) -> Any:
    """A ufunc of arrays of which one at least holds intervals."""
    if ufunc is np.matmul and any(issparse(x) for x in inputs):
        return FUNCTIONS["sparse"](*inputs)
    operands = [as_interval(x) for x in inputs]
    algebra = max(x.algebra for x in operands)
    with np.errstate(all="ignore"):
        if ufunc is np.negative:
            return wrap(-operands[0].ends, algebra)
        if len(operands) == 1 and ufunc.__name__ in RULES:
            return wrap(compose(RULES[ufunc.__name__], operands[0].ends, algebra), algebra)
        if len(operands) == 2 and ufunc in BINARY:
            if ufunc is np.matmul:
                return BINARY[ufunc](*operands)
            return BINARY[ufunc](*aligned(*operands))
        if ufunc in (np.isfinite, np.isnan):
            finite = np.isfinite(operands[0].ends.lo) & np.isfinite(operands[0].ends.hi)
            good: Any = finite.all(axis=(0, 1))
            return good if ufunc is np.isfinite else ~good
    raise unknown(f"numpy.{ufunc.__name__}")


def aligned(a: Interval, b: Interval) -> tuple[Interval, Interval]:
    """Both with as many axes, as broadcasting wants them."""
    ndim = max(a.ndim, b.ndim)

    def longer(x: Interval) -> Interval:
        missing = (1,) * (ndim - x.ndim)
        return x.linear(lambda e: e.reshape(*e.shape[:2], *missing, *e.shape[2:])) if missing else x

    return longer(a), longer(b)


def _add(a: Interval, b: Interval) -> Interval:
    return wrap(sum_of(a.ends, b.ends), max(a.algebra, b.algebra))


def _subtract(a: Interval, b: Interval) -> Interval:
    return wrap(sum_of(a.ends, -b.ends), max(a.algebra, b.algebra))


def _multiply(a: Interval, b: Interval) -> Interval:
    algebra = max(a.algebra, b.algebra)
    if a is b:  # a square, which is never negative
        return wrap(compose(RULES["square"], a.ends, algebra), algebra)
    return wrap(product_of(Ends.__mul__, a.ends, b.ends, algebra), algebra)


def _divide(a: Interval, b: Interval) -> Interval:
    if len(b.ends.lo) == 1:
        return wrap(a.ends / b.ends, a.algebra)
    inverse = wrap(compose(RULES["reciprocal"], b.ends, b.algebra), b.algebra)
    product = _multiply(a, inverse)
    product.ends.lo[0], product.ends.hi[0] = (x[0] for x in _quotient(a, b))
    return product


def _quotient(a: Interval, b: Interval) -> tuple[Array, Array]:
    """Of the values: one rounding, not two."""
    value = a.ends[:1] / b.ends[:1]
    return value.lo, value.hi


def _power(a: Interval, b: Interval) -> Any:
    if len(b.ends.lo) == 1 and b.ends.lo.shape[1] == 1 and np.array_equal(b.ends.lo, b.ends.hi):
        exponents = np.unique(b.ends.lo)
        if exponents.size == 1:
            shape = np.broadcast_shapes(a.shape, b.shape)
            base = broadcast_to(a, shape)
            return wrap(compose(power_rule(float(exponents[0])), base.ends, base.algebra), base.algebra)
        return _entrywise_power(a, b)
    logarithm: Any = np.log(a)
    return np.exp(logarithm * b)


def _entrywise_power(a: Interval, b: Interval) -> Any:
    shape = np.broadcast_shapes(a.shape, b.shape)
    base: Any = broadcast_to(a, shape)
    out: Any = spread(base, *base.ends.shape[:2])
    exponents = np.broadcast_to(b.ends.lo[0, 0], shape)
    for value in np.unique(exponents):
        entries = exponents == value
        out[entries] = _power(base[entries], as_interval(value))
    return out


def broadcast_to(a: Interval, shape: tuple[int, ...]) -> Interval:
    """In a larger shape, by numpy's rules."""
    a, _ = aligned(a, as_interval(np.zeros(shape)))
    return a.linear(lambda x: np.array(np.broadcast_to(x, (*x.shape[:2], *shape))))


def _larger(a: Interval, b: Interval) -> Interval:
    """The larger of two; where that is not decided, either, with the derivatives of both (no second one)."""
    parts = alike([a, b])
    p, q = (x.ends for x in parts)
    value = Ends(np.maximum(p.lo[:1], q.lo[:1]), np.maximum(p.hi[:1], q.hi[:1]))
    first, second = p.lo[:1] > q.hi[:1], q.lo[:1] > p.hi[:1]
    algebra = max(a.algebra, b.algebra)
    lo = np.where(first, p.lo, np.where(second, q.lo, np.minimum(p.lo, q.lo)))
    hi = np.where(first, p.hi, np.where(second, q.hi, np.maximum(p.hi, q.hi)))
    if algebra == CURVE and len(lo) > 1:
        lo[2:], hi[2:] = (np.where(first | second, x[2:], np.nan) for x in (lo, hi))
    lo[:1], hi[:1] = value.lo, value.hi
    return wrap(Ends(lo, hi), algebra)


def _hypot(a: Interval, b: Interval) -> Any:
    return np.sqrt(np.square(a) + np.square(b))


def _arctan2(a: Interval, b: Interval) -> Any:
    """The angle of a point (b, a), without value across the negative axis."""
    right = np.array((b.ends.lo[0] > 0.0).all(axis=0))
    ahead = np.arctan(a / b)
    quarter = wrap(PI, a.algebra) * 0.5
    above = np.array((a.ends.lo[0] > 0.0).all(axis=0))
    aside = np.where(above, quarter, -quarter) - np.arctan(b / a)
    return np.where(right, ahead, aside)


def _matmul(a: Interval, b: Interval) -> Interval:
    if a.ndim == 0 or b.ndim == 0:
        raise ValueError("numpy.matmul: a scalar has no matrix product; use *")
    row, column = a.ndim == 1, b.ndim == 1
    a, b = a.linear(lambda x: x[..., None, :]) if row else a, b.linear(lambda x: x[..., None]) if column else b
    a, b = aligned(a, b)
    algebra = max(a.algebra, b.algebra)
    out = wrap(product_of(lambda p, q: bilinear(np.matmul, p, q), a.ends, b.ends, algebra), algebra)
    if column:
        out = out.linear(lambda x: x[..., 0])
    return out.linear(lambda x: np.squeeze(x, axis=-1 if column else -2)) if row else out


def _comparison(surely: Callable[[Ends, Ends], Mask], surely_not: Callable[[Ends, Ends], Mask]) -> Any:
    def rule(a: Interval, b: Interval) -> Any:
        yes, no = (test(a.ends[0], b.ends[0]) for test in (surely, surely_not))
        holds = yes.all(axis=0)
        if not (holds | no.all(axis=0)).all():
            raise UndecidedError("a comparison is not decided on a box: it holds for some of its points only")
        return holds

    return rule


def _below(a: Ends, b: Ends) -> Mask:
    return a.hi < b.lo


def _not_above(a: Ends, b: Ends) -> Mask:
    return a.hi <= b.lo


def _equal(a: Ends, b: Ends) -> Mask:
    same: Mask = (a.lo == a.hi) & (b.lo == b.hi) & (a.lo == b.lo)
    return same


def _apart(a: Ends, b: Ends) -> Mask:
    return (a.hi < b.lo) | (b.hi < a.lo)


BINARY: dict[np.ufunc, Callable[..., Any]] = {
    np.add: _add,
    np.subtract: _subtract,
    np.multiply: _multiply,
    np.divide: _divide,
    np.power: _power,
    np.float_power: _power,
    np.maximum: _larger,
    np.minimum: lambda a, b: -_larger(-a, -b),
    np.hypot: _hypot,
    np.arctan2: _arctan2,
    np.matmul: _matmul,
    np.less: _comparison(_below, lambda a, b: _not_above(b, a)),
    np.less_equal: _comparison(_not_above, lambda a, b: _below(b, a)),
    np.greater: _comparison(lambda a, b: _below(b, a), _not_above),
    np.greater_equal: _comparison(lambda a, b: _not_above(b, a), _below),
    np.equal: _comparison(_equal, _apart),
    np.not_equal: _comparison(_apart, _equal),
}
