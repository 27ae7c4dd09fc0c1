"""Arrays of intervals, accepted by numpy as arrays: many boxes at once, alone or with derivatives.

Behind the shape that a function sees, an array has two axes of its own in front: the coefficients, and the boxes. The
coefficients are the value alone; or the value and its derivatives in many directions (`GRADIENT`); or value, first and
half the second derivative along a curve (`CURVE`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from continuation.arrays import Array, asked_by_sparse
from continuation.intervals.elementary import RULES
from continuation.intervals.ends import Ends, thin

GRADIENT, CURVE = 1, 2
"""How coefficients multiply: products of derivatives are dropped, or make the second one."""

FUNCTIONS: dict[Any, Callable[..., Any]] = {}
"""Rules by numpy function, and "ufunc" for the rest. The package fills it, as the rules are built on `Interval`."""


class UndecidedError(ArithmeticError):
    """A comparison that holds for some numbers of an interval and not for others, or not for all boxes alike."""


def unknown(operation: str) -> TypeError:
    """The error for what interval arrays cannot do."""
    return TypeError(f"interval arrays do not know {operation}; write it with numpy functions that they know")


class Interval(NDArrayOperatorsMixin):
    """An array of intervals that goes through numpy as an array of its shape would.

    Every operation gives intervals that hold all values of the operation on numbers of its operands, round-off
    included; plain arrays that it meets are taken as the numbers that they are. Where an operation is not defined on
    part of an interval the result is nan. A comparison that is not decided raises `UndecidedError`.

    Parameters
    ----------
    lo, hi : array_like
        The ends, of one shape.

    Raises
    ------
    ValueError
        If an end is nan, or lo above hi.
    """

    __slots__ = ("algebra", "ends")
    __hash__ = None  # type: ignore[assignment]

    ends: Ends
    algebra: int

    def __new__(cls, lo: Any, hi: Any = None) -> Interval:
        """Check the ends and copy them."""
        low = np.array(lo, dtype=float)
        high = low if hi is None else np.array(hi, dtype=float)
        if low.shape != high.shape or not (low <= high).all():
            raise ValueError(f"lo, hi: expected arrays of one shape with lo <= hi, found {lo!r} and {hi!r}")
        return wrap(Ends(low[None, None], high[None, None]), GRADIENT)

    @staticmethod
    def of(ends: Ends, algebra: int) -> Interval:
        """The array with these ends, of shape (coefficients, boxes, ...), neither checked nor copied.

        Parameters
        ----------
        ends : Ends
        algebra : int
            `GRADIENT` or `CURVE`.
        """
        return wrap(ends, algebra)

    @property
    def lo(self) -> Array:
        """Lower ends of the value; where there are many boxes their number comes first in its shape."""
        return self._values(self.ends.lo)

    @property
    def hi(self) -> Array:
        """Upper ends of the value."""
        return self._values(self.ends.hi)

    def _values(self, ends: Array) -> Array:
        return np.asarray(ends[0, 0] if ends.shape[1] == 1 else ends[0])

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array."""
        return self.ends.lo.shape[2:]

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return len(self.shape)

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(np.prod(self.shape))

    @property
    def dtype(self) -> np.dtype[np.float64]:
        """Of the ends."""
        return self.ends.lo.dtype

    @property
    def T(self) -> Interval:
        """The axes in reverse order."""
        return self.transpose()

    def __repr__(self) -> str:
        return f"Interval(lo={self.lo!r}, hi={self.hi!r})"

    def __float__(self) -> float:
        raise TypeError("an Interval cannot become a float, which would drop its width: use numpy functions")

    def __getattr__(self, name: str) -> Any:
        # Numpy's loops over object arrays call a method of the function's name on each entry.
        if name in RULES:
            return lambda: getattr(np, name)(self)
        if name in ("sum", "mean", "prod", "cumsum", "dot", "squeeze"):
            return lambda *args, **keywords: getattr(np, name)(self, *args, **keywords)
        raise AttributeError(f"interval arrays do not know the attribute {name!r} of arrays")

    def copy(self) -> Interval:
        """An array of its own memory."""
        return wrap(Ends(self.ends.lo.copy(), self.ends.hi.copy()), self.algebra)

    def reshape(self, *shape: Any) -> Interval:
        """The same entries in another shape; a view where that is possible.

        Parameters
        ----------
        *shape : int
            Or one tuple of them.
        """
        (shape,) = shape if len(shape) == 1 else (shape,)
        return self.linear(lambda x: x.reshape(*x.shape[:2], *np.atleast_1d(shape)))

    def ravel(self) -> Interval:
        """One axis."""
        return self.reshape(-1)

    def flatten(self) -> Interval:
        """One axis, in memory of its own."""
        return self.ravel().copy()

    def transpose(self, *axes: Any) -> Interval:
        """The axes in another order (reversed unless given), as a view.

        Parameters
        ----------
        *axes : int
            Or one tuple of them.
        """
        if len(axes) == 1 and not isinstance(axes[0], int):
            (axes,) = axes
        order = range(self.ndim)[::-1] if not axes else [range(self.ndim)[axis] for axis in axes]
        return self.linear(lambda x: x.transpose(0, 1, *(axis + 2 for axis in order)))

    def linear(self, select: Callable[[Array], Array]) -> Interval:
        """What an operation that only selects entries makes of it: the same with either end.

        Parameters
        ----------
        select : callable
            Of an array of shape (coefficients, boxes, *shape).
        """
        return wrap(Ends(select(self.ends.lo), select(self.ends.hi)), self.algebra)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        name = f"numpy.{ufunc.__name__}"
        (out,) = keywords.pop("out", (None,))
        if method != "__call__" or keywords:
            raise unknown(f"{name} as {method} with {', '.join(keywords) or 'no keywords'}")
        result = FUNCTIONS["ufunc"](ufunc, inputs)
        if out is None or not isinstance(out, Interval):
            if out is not None:
                raise TypeError(f"{name} cannot write intervals into a plain array; write a = a + b instead of a += b")
            return result
        if out.ndim == 0:  # as numpy's scalars, which never change
            return result
        out[...] = result
        return out

    def __array_function__(self, function: Any, types: Any, args: Any, keywords: Any) -> Any:
        rule = FUNCTIONS.get(function)
        if rule is None:
            raise unknown(f"{function.__module__}.{function.__name__}")
        with np.errstate(all="ignore"):
            return rule(*args, **keywords)


class IntervalArray(Interval):
    """One with axes. Scalars are no sequences, so that np.array([y[0], ...]) holds them as entries."""

    __slots__ = ()

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        if asked_by_sparse():
            return np.array(None, dtype=object)  # "no" in scipy's terms: Python goes on to `__rmatmul__`
        raise TypeError(
            "an Interval cannot become a plain array, which would drop its width: leave out numpy.asarray, use "
            "np.stack for np.array([...]), and np.zeros_like(y) to assign into"
        )

    def __len__(self) -> int:
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, key: Any) -> Any:
        part = self.linear(lambda x: np.moveaxis(_entries_first(x)[_behind(key)], (-2, -1), (0, 1)))
        return part if part.ndim else part.copy()  # a scalar does not change with the array

    def __setitem__(self, key: Any, value: Any) -> None:
        value = as_interval(value)
        coefficients, boxes = (max(p, q) for p, q in zip(self.ends.shape[:2], value.ends.shape[:2]))
        whole = spread(self, coefficients, boxes)
        given = spread(value, coefficients, boxes).ends
        for mine, other in ((whole.ends.lo, given.lo), (whole.ends.hi, given.hi)):
            _entries_first(mine)[_behind(key)] = np.moveaxis(other, (0, 1), (-2, -1))
        self.ends, self.algebra = whole.ends, max(self.algebra, value.algebra)


def _entries_first(x: Array) -> Array:
    """Its own axes last, out of the way of any index."""
    return np.moveaxis(x, (0, 1), (-2, -1))


def _behind(key: Any) -> tuple[Any, ...]:
    key = key if isinstance(key, tuple) else (key,)
    if not any(part is Ellipsis for part in key):
        key = (*key, Ellipsis)
    return (*key, slice(None), slice(None))


def wrap(ends: Ends, algebra: int) -> Interval:
    """The array with these ends, of shape (coefficients, boxes, *shape), not copied."""
    array: Interval = object.__new__(IntervalArray if ends.lo.ndim > 2 else Interval)
    array.ends, array.algebra = ends, algebra
    return array


def as_interval(x: Any) -> Interval:
    """`x` as an interval array: lists and object arrays that hold intervals are stacked, numbers are thin."""
    if isinstance(x, Interval):
        return x
    if isinstance(x, np.ndarray) and x.dtype == object and x.ndim == 0:
        return as_interval(x[()])
    if isinstance(x, list | tuple) or (isinstance(x, np.ndarray) and x.dtype == object):
        return stacked([as_interval(part) for part in x])
    plain = np.asarray(x)
    if plain.dtype.kind not in "fiub":
        raise TypeError(f"an interval array met {type(x).__name__} of dtype {plain.dtype}; expected real numbers")
    if plain.dtype.kind in "iu" and plain.size and max(abs(int(plain.max())), abs(int(plain.min()))) > 2**53:
        raise TypeError("an interval array met integers beyond 2**53, which floats do not hold")
    return wrap(thin(plain.astype(float)[None, None]), GRADIENT)


def spread(x: Interval, coefficients: int, boxes: int) -> Interval:
    """With so many coefficients, the further ones zero, and so many boxes, in memory of its own."""
    lo, hi = (np.zeros((coefficients, boxes, *x.shape)) for _ in range(2))
    lo[: len(x.ends.lo)], hi[: len(x.ends.hi)] = x.ends.lo, x.ends.hi
    return wrap(Ends(lo, hi), x.algebra)


def alike(parts: list[Interval]) -> list[Interval]:
    """With as many coefficients and boxes each."""
    coefficients, boxes = (max(x.ends.shape[k] for x in parts) for k in (0, 1))
    return [x if x.ends.shape[:2] == (coefficients, boxes) else spread(x, coefficients, boxes) for x in parts]


def stacked(parts: list[Interval]) -> Interval:
    """Along a new first axis."""
    if not parts:
        return as_interval(np.zeros(0))
    return joined(lambda arrays: np.stack(arrays, axis=2), parts)


def joined(join: Callable[[list[Array]], Array], parts: list[Interval]) -> Interval:
    """What a function that puts arrays together makes of them: the same with either end."""
    parts = alike(parts)
    algebra = max(x.algebra for x in parts)
    return wrap(Ends(join([x.ends.lo for x in parts]), join([x.ends.hi for x in parts])), algebra)
