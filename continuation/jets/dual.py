"""Dual numbers over arrays of any kind: a function's derivative along a vector, where both are jets or intervals.

A dual number is value + slope s, with s^2 = 0. Its parts are arrays of whatever goes through numpy, and keep what they
carry: of intervals with first derivatives come the ranges of H' v and of its derivatives.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from functools import reduce
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from scipy.sparse import issparse

from continuation.arrays import asked_by_sparse, clipped
from continuation.jets.dispatch import unknown


class Dual(NDArrayOperatorsMixin):
    """A number value + slope s that goes through numpy as a number would; the slope of a constant is None."""

    __slots__ = ("slope", "value")
    __hash__ = None  # type: ignore[assignment]

    value: Any
    slope: Any

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the value."""
        return np.shape(self.value)

    def __getattr__(self, name: str) -> Any:
        if name in PROPERTIES:
            return PROPERTIES[name](self)
        if name in SLOPES:  # numpy's loops over object arrays call a method of the function's name on each entry
            return lambda: getattr(np, name)(self)
        if name in ("sum", "mean", "prod", "cumsum", "dot", "squeeze", "copy", "ravel", "reshape", "transpose"):
            return lambda *args, **keywords: _method(name, self, args, keywords)
        raise AttributeError(f"dual numbers do not know the attribute {name!r} of arrays")

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        (out,) = keywords.pop("out", (None,))
        if method != "__call__" or keywords:
            raise unknown(f"numpy.{ufunc.__name__} as {method} with {', '.join(keywords) or 'no keywords'}")
        result = _call(ufunc, [x if issparse(x) else as_dual(x) for x in inputs])
        if out is None or (isinstance(out, Dual) and out.ndim == 0):
            return result
        if not isinstance(out, Dual):
            raise TypeError("dual numbers cannot be written into a plain array; write a = a + b instead of a += b")
        out.value, out.slope = result.value, result.slope
        return out

    def __array_function__(self, function: Any, types: Any, args: Any, keywords: Any) -> Any:
        rule = FUNCTIONS.get(function)
        if rule is None:
            raise unknown(f"{function.__module__}.{function.__name__}")
        return rule(*args, **keywords)


PROPERTIES: dict[str, Callable[[Any], Any]] = {
    "T": np.transpose,
    "ndim": lambda x: len(x.shape),
    "size": lambda x: int(np.prod(x.shape)),
}


class DualArray(Dual):
    """An array of them. Single ones are no sequences, so that np.array([y[0], ...]) holds them as entries."""

    __slots__ = ()

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        if asked_by_sparse():
            return np.array(None, dtype=object)
        raise TypeError("an array of dual numbers cannot become a plain one: use np.stack and np.zeros_like(y)")

    def __len__(self) -> int:
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, key: Any) -> Any:
        return dual(self.value[key], None if self.slope is None else self.slope[key])

    def __setitem__(self, key: Any, value: Any) -> None:
        value = as_dual(value)
        self.value[key] = value.value
        if value.slope is not None or self.slope is not None:
            self.slope = _slope(self)
            self.slope[key] = _slope(value)


def dual(value: Any, slope: Any) -> Dual:
    """The dual number, or array, with these parts, not copied."""
    number: Dual = object.__new__(DualArray if np.ndim(value) else Dual)
    number.value, number.slope = value, slope
    return number


def as_dual(x: Any) -> Dual:
    """`x` as it is; lists and object arrays that hold dual numbers are stacked, others are constants."""
    if isinstance(x, Dual):
        return x
    if isinstance(x, list | tuple) or (isinstance(x, np.ndarray) and x.dtype == object):
        if isinstance(x, np.ndarray) and x.ndim == 0:
            return as_dual(x[()])
        parts = [as_dual(part) for part in x]
        if any(part.slope is not None for part in parts):
            return _joined(np.stack, parts)
        x = np.stack([part.value for part in parts]) if isinstance(x, list | tuple) else x
    return dual(x, None)


def _slope(x: Dual) -> Any:
    return np.zeros_like(x.value) if x.slope is None else x.slope


def derivative_along(f: Callable[[Any], Any], x: Any, v: Any) -> tuple[Any, Any]:
    """f(x) and f'(x) v, for x and v of whatever kind of array f runs on; a TypeError names an unknown operation."""
    image = as_dual(f(dual(x, v)))
    return image.value, _slope(image)


# --- functions of one and of two numbers ------------------------------------------------------------------


def _complement(u: Any) -> Any:
    return (1.0 - u) * (1.0 + u)


SLOPES: dict[str, Callable[[Any, Any], Any]] = {
    "positive": lambda u, v: 1.0,
    "negative": lambda u, v: -1.0,
    "absolute": lambda u, v: np.where(u >= 0.0, 1.0, -1.0),
    "fabs": lambda u, v: np.where(u >= 0.0, 1.0, -1.0),
    "square": lambda u, v: 2.0 * u,
    "sqrt": lambda u, v: 0.5 / v,
    "cbrt": lambda u, v: v / (3.0 * u),
    "reciprocal": lambda u, v: -np.square(v),
    "exp": lambda u, v: v,
    "expm1": lambda u, v: np.exp(u),
    "exp2": lambda u, v: np.log(np.full_like(u, 2.0)) * v,
    "log": lambda u, v: 1.0 / u,
    "log1p": lambda u, v: 1.0 / (1.0 + u),
    "log2": lambda u, v: 1.0 / (np.log(np.full_like(u, 2.0)) * u),
    "log10": lambda u, v: 1.0 / (np.log(np.full_like(u, 10.0)) * u),
    "sin": lambda u, v: np.cos(u),
    "cos": lambda u, v: -np.sin(u),
    "tan": lambda u, v: 1.0 + np.square(v),
    "arcsin": lambda u, v: 1.0 / np.sqrt(_complement(u)),
    "arccos": lambda u, v: -1.0 / np.sqrt(_complement(u)),
    "arctan": lambda u, v: 1.0 / (1.0 + np.square(u)),
    "sinh": lambda u, v: np.cosh(u),
    "cosh": lambda u, v: np.sinh(u),
    "tanh": lambda u, v: _complement(v),
    "arcsinh": lambda u, v: 1.0 / np.sqrt(1.0 + np.square(u)),
    "arccosh": lambda u, v: 1.0 / np.sqrt((u - 1.0) * (u + 1.0)),
    "arctanh": lambda u, v: 1.0 / _complement(u),
}
"""The derivative at u, where the value is v, by numpy's names."""

COMPARISONS = (np.less, np.less_equal, np.greater, np.greater_equal, np.equal, np.not_equal, np.isfinite, np.isnan)
"""Decided by the values."""


def _call(ufunc: np.ufunc, operands: list[Any]) -> Any:
    values = [x.value if isinstance(x, Dual) else x for x in operands]
    if ufunc in COMPARISONS:
        return ufunc(*values)
    if ufunc in BINARY:
        return BINARY[ufunc](*operands)
    if ufunc.__name__ not in SLOPES:
        raise unknown(f"numpy.{ufunc.__name__}")
    (u,) = operands
    value = ufunc(u.value)
    return dual(value, None if u.slope is None else SLOPES[ufunc.__name__](u.value, value) * u.slope)


def _sum_of(a: Any, b: Any) -> Any:
    return b if a is None else a if b is None else a + b


def _product(multiply: Callable[[Any, Any], Any], a: Any, b: Any) -> Any:
    """A bilinear function of two arrays, of which one may be a sparse matrix."""
    if issparse(a) or issparse(b):
        a, b = (dual(x, None) if issparse(x) else x for x in (a, b))
    value = multiply(a.value, b.value)
    first = None if a.slope is None else multiply(a.slope, b.value)
    # Of a square both are the same, and intervals know a square by that.
    second = first if a is b and multiply is operator.mul else None if b.slope is None else multiply(a.value, b.slope)
    return dual(value, _sum_of(first, second))


def _added(a: Dual, b: Dual) -> Dual:
    value, slope = a.value + b.value, _sum_of(a.slope, b.slope)
    # One slope alone is spread as the value is.
    return dual(value, slope if slope is None else slope + np.zeros(np.shape(value)))


def _divided(a: Dual, b: Dual) -> Dual:
    value = a.value / b.value
    slope = _sum_of(a.slope, None if b.slope is None else -value * b.slope)
    return dual(value, slope if slope is None else slope / b.value)


def _power(a: Dual, b: Dual) -> Any:
    if b.slope is not None or not isinstance(b.value, float | int | np.ndarray | np.generic):
        return np.exp(b * np.log(a))
    value, exponent = np.power(a.value, b.value), np.asarray(b.value, dtype=float)
    if a.slope is None:
        return dual(value, None)
    if (exponent == np.trunc(exponent)).all():
        less = np.where(exponent == 0.0, 0.0, exponent - 1.0)
        return dual(value, b.value * np.power(a.value, less if less.ndim else float(less)) * a.slope)
    # exponent - 1 would be rounded.
    return dual(value, b.value * value / a.value * a.slope)


def _chosen(surely: np.ufunc) -> Callable[[Dual, Dual], Any]:
    return lambda a, b: np.where(surely(a.value, b.value), a, b)


def _arctan2(a: Dual, b: Dual) -> Dual:
    across = b * dual(a.slope, None) if a.slope is not None else None
    along = a * dual(-b.slope, None) if b.slope is not None else None
    slope = _sum_of(across, along)
    square = np.square(a.value) + np.square(b.value)
    return dual(np.arctan2(a.value, b.value), None if slope is None else slope.value / square)


BINARY: dict[np.ufunc, Callable[..., Any]] = {
    np.add: _added,
    np.subtract: lambda a, b: _added(a, -b),
    np.multiply: lambda a, b: _product(operator.mul, a, b),
    np.matmul: lambda a, b: _product(operator.matmul, a, b),
    np.divide: _divided,
    np.power: _power,
    np.float_power: _power,
    np.hypot: lambda a, b: np.sqrt(np.square(a) + np.square(b)),
    np.arctan2: _arctan2,
    np.maximum: _chosen(np.greater_equal),
    np.minimum: _chosen(np.less_equal),
}

# --- functions of arrays ----------------------------------------------------------------------------------


def _method(name: str, x: Dual, args: Any, keywords: Any) -> Any:
    if name in ("reshape", "transpose") and args and not isinstance(args[0], tuple | list):
        args = (args,)
    return getattr(np, name)(x, *args, **keywords)


def _linear(function: Any) -> Callable[..., Any]:
    def rule(a: Any, *args: Any, **keywords: Any) -> Any:
        if np.any(keywords.get("constant_values", 0) != 0):
            raise unknown("numpy.pad with constants other than 0")
        a = as_dual(a)
        value = function(a.value, *args, **keywords)
        slope = None if a.slope is None else function(a.slope, *args, **keywords)
        if isinstance(value, list):  # of split
            return [dual(part, None if slope is None else slope[k]) for k, part in enumerate(value)]
        return dual(value, slope)

    return rule


def _joined(function: Any, arrays: Any, *args: Any, **keywords: Any) -> Dual:
    parts = [as_dual(x) for x in arrays]
    value = function([x.value for x in parts], *args, **keywords)
    if all(x.slope is None for x in parts):
        return dual(value, None)
    return dual(value, function([_slope(x) for x in parts], *args, **keywords))


def _bilinear(function: Any) -> Callable[..., Any]:
    def rule(a: Any, b: Any, *args: Any, **keywords: Any) -> Any:
        return _product(lambda p, q: function(p, q, *args, **keywords), as_dual(a), as_dual(b))

    return rule


def _einsum(subscripts: Any, *operands: Any, **keywords: Any) -> Any:
    if not isinstance(subscripts, str) or len(operands) not in (1, 2):
        raise unknown("numpy.einsum unless it has subscripts and one or two operands")
    known = _linear if len(operands) == 1 else _bilinear
    return known(lambda *arrays: np.einsum(subscripts, *arrays, **keywords))(*operands)


def _where(condition: Any, x: Any, y: Any) -> Any:
    if isinstance(condition, Dual):
        raise unknown("numpy.where with dual numbers for a condition (compare them first)")
    return _joined(lambda parts: np.where(condition, *parts), [x, y])


def _prod(a: Any, axis: Any = None) -> Any:
    return reduce(operator.mul, np.ravel(a) if axis is None else np.moveaxis(a, axis, 0), as_dual(1.0))


FUNCTIONS: dict[Any, Callable[..., Any]] = {
    np.einsum: _einsum,
    np.where: _where,
    np.append: lambda arr, values, axis=None: np.concatenate(
        [np.ravel(arr), np.ravel(values)] if axis is None else [arr, values], axis or 0
    ),
    np.prod: _prod,
    np.linalg.norm: lambda x, axis=None: np.sqrt(np.sum(np.square(x), axis)),
    np.clip: clipped,
    np.bincount: lambda x, weights, minlength=0: _linear(lambda w: np.bincount(x, w, minlength))(weights),
    np.shape: lambda a: a.shape,
    np.ndim: lambda a: a.ndim,
    np.size: lambda a, axis=None: a.size if axis is None else a.shape[axis],
    **{
        f: lambda a, *args, _function=f, **keywords: dual(_function(a.value, *args, **keywords), None)
        for f in (np.zeros_like, np.ones_like, np.empty_like, np.full_like)
    },
    **{f: _bilinear(f) for f in (np.dot, np.inner, np.vdot, np.outer, np.tensordot)},
    **{
        f: lambda arrays, *args, _function=f, **keywords: _joined(_function, arrays, *args, **keywords)
        for f in (np.concatenate, np.stack, np.hstack, np.vstack, np.column_stack)
    },
    **{
        f: _linear(f)
        for f in (
            *(np.sum, np.mean, np.cumsum, np.diff, np.trace, np.copy, np.pad, np.split),
            *(np.roll, np.flip, np.flipud, np.fliplr, np.rot90, np.take, np.tile, np.repeat, np.delete),
            *(np.diag, np.diagonal, np.tril, np.triu, np.moveaxis, np.swapaxes, np.reshape, np.ravel, np.transpose),
            *(np.squeeze, np.expand_dims, np.broadcast_to, np.atleast_1d, np.atleast_2d),
        )
    },
}
"""Every numpy function that dual numbers know: those that jets and interval arrays know."""
