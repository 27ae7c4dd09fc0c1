"""Arrays of truncated series of numbers, `Jet`, and of intervals, `Interval`."""

from __future__ import annotations

import operator
from collections.abc import Iterator
from typing import Any

import numpy as np

from continuation.arrays import Array, asked_by_sparse
from continuation.numbers.algebra import GRADIENT, TAYLOR, Coefficients
from continuation.numbers.ends import Ends, moved, thin
from continuation.numbers.truncated import KINDS, Truncated, alike, common, wrap


class WithAxes:
    """Array methods. Scalars lack them, so that np.array([y[0], ...]) stores these as entries."""

    __slots__ = ()

    def __array__(self: Any, dtype: Any = None, copy: Any = None) -> Any:
        if asked_by_sparse():
            return np.array(None, dtype=object)  # scipy then declines, and Python calls `__rmatmul__`
        raise TypeError(
            f"{self.NAME} cannot become a plain array, which would drop its {self.LOST}: leave out numpy.asarray, use "
            "np.stack for np.array([...]), np.zeros_like(y) to assign into, and functions of numpy alone; or give a "
            "jacobian"
        )

    def __bool__(self: Any) -> bool:
        raise ValueError("the truth of an array is ambiguous; compare its entries")

    def __len__(self: Any) -> int:
        return int(self.shape[0])

    def __iter__(self: Any) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self: Any, key: Any) -> Any:
        if isinstance(key, int | slice):
            part = self.moved(operator.itemgetter((*(slice(None),) * self.OWN, key)))
        else:
            part = self.moved(lambda x: _own_last(_own_last(x, self.OWN)[_behind(key, self.OWN)], -self.OWN))
        return part if part.ndim else part.copy()  # a scalar must not change with the array

    def __setitem__(self: Any, key: Any, value: Any) -> None:
        value = self.lifted(value)
        self.algebra = common((self, value))
        mine, given = alike((self, value))
        if isinstance(mine, Ends):
            mine = mine.copy()  # both ends may be one array
        part = _behind(key, self.OWN)

        def write(mine: Array, given: Array) -> Array:
            _own_last(mine, self.OWN)[part] = _own_last(given, self.OWN)
            return mine

        self.c = moved(write, mine, given)


def _own_last(x: Array, own: int) -> Array:
    """The first `own` axes behind the others, or the last -`own` before them."""
    return x.transpose(*range(own % x.ndim, x.ndim), *range(own % x.ndim))


def _behind(key: Any, own: int) -> tuple[Any, ...]:
    key = key if isinstance(key, tuple) else (key,)
    if not any(part is Ellipsis for part in key):
        key = (*key, Ellipsis)
    return (*key, *(slice(None),) * own)


class Jet(Truncated):
    """An array of truncated power series, sum_k c[k] s**k.

    numpy treats a jet as an array with the shape of one coefficient; comparisons use the leading one. Unsupported
    operations raise TypeError, functions without a series `JetDomainError`.

    Parameters
    ----------
    c : array_like, (K + 1, *shape)
        Coefficients; ``jet.c[k]`` belongs to s**k.
    """

    __slots__ = ()
    OWN, WHO, ONE, NAME, LOST = 1, "jets", "a jet", "a Jet", "series"

    def __new__(cls, c: Any) -> Jet:
        """Check and copy."""
        coefficients = np.array(c, dtype=float)
        if coefficients.ndim == 0 or len(coefficients) == 0:
            raise ValueError(f"c has shape {coefficients.shape}; expected (order + 1, *shape) with order >= 0")
        jet: Jet = wrap(coefficients, TAYLOR)
        return jet

    @property
    def order(self) -> int:
        """Highest power of s."""
        return len(self.c) - 1

    def __repr__(self) -> str:
        return f"Jet(shape={self.shape}, order={self.order}, leading={self.c[0]!r})"


class ArrayJet(WithAxes, Jet):
    """A jet with axes."""

    __slots__ = ()


class Interval(Truncated):
    """An array of intervals, which numpy treats as an array of its shape.

    Results contain all values of the operation on numbers of its operands, round-off included; nan if it is undefined
    on part of an interval. Plain arrays are exact.

    Parameters
    ----------
    lo, hi : array_like
        The ends, of one shape.

    Raises
    ------
    ValueError
        If an end is nan, or lo > hi.
    """

    __slots__ = ()
    OWN, WHO, ONE, NAME, LOST = 2, "interval arrays", "an interval array", "an Interval", "width"

    def __new__(cls, lo: Any, hi: Any = None) -> Interval:
        """Check and copy."""
        low = np.array(lo, dtype=float)
        high = low if hi is None else np.array(hi, dtype=float)
        if low.shape != high.shape or not (low <= high).all():
            raise ValueError(f"lo, hi: expected arrays of one shape with lo <= hi, found {lo!r} and {hi!r}")
        low = low[None, None]
        interval: Interval = wrap(Ends(low, low if hi is None else high[None, None]), GRADIENT)
        return interval

    @property
    def lo(self) -> Array:
        """Lower ends; the first axis counts boxes, if several."""
        return self._values(self.c.lo)

    @property
    def hi(self) -> Array:
        """Upper ends, likewise."""
        return self._values(self.c.hi)

    def _values(self, ends: Array) -> Array:
        return np.asarray(ends[0, 0] if ends.shape[1] == 1 else ends[0])

    @staticmethod
    def constant(x: Array) -> Coefficients:
        """Numbers as coefficients for one box.

        Parameters
        ----------
        x : ndarray
        """
        if x.dtype.kind in "iu" and x.size and max(abs(int(x.max())), abs(int(x.min()))) > 2**53:
            raise TypeError("an interval array met integers beyond 2**53, which floats do not hold")
        return thin(x.astype(float, copy=False)[None, None])

    def __repr__(self) -> str:
        return f"Interval(lo={self.lo!r}, hi={self.hi!r})"


class ArrayInterval(WithAxes, Interval):
    """An `Interval` with axes."""

    __slots__ = ()


KINDS.update({np.ndarray: (Jet, ArrayJet), Ends: (Interval, ArrayInterval)})
