"""Arrays of truncated series, which numpy accepts; kinds (`Jet`, `Interval`) differ in coefficients and algebra."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from scipy.sparse import issparse

from continuation.arrays import Array
from continuation.linear.silence import without_warnings
from continuation.numbers import ufuncs
from continuation.numbers.algebra import Algebra, Coefficients, lengthened
from continuation.numbers.ends import Ends, moved, sparse_product
from continuation.numbers.series import ELEMENTARY

FUNCTIONS: dict[Any, Callable[..., Any]] = {}
"""Rules by numpy function, filled by the package, as `functions` imports `Truncated`."""


ARRAY_METHODS = (np.sum, np.mean, np.prod, np.squeeze, np.dot)


class Truncated(NDArrayOperatorsMixin):
    """An array of truncated series."""

    __slots__ = ("algebra", "c")

    OWN: ClassVar[int]
    WHO: ClassVar[str]
    ONE: ClassVar[str]
    NAME: ClassVar[str]
    LOST: ClassVar[str]
    """Number of axes before the shape; words of error messages."""

    c: Coefficients
    algebra: Algebra

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape."""
        return tuple(self.c.shape[self.OWN :])

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return int(self.c.ndim - self.OWN)

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(np.prod(self.shape))

    @property
    def dtype(self) -> np.dtype[np.float64]:
        """Always float64."""
        return np.dtype(np.float64)

    def __bool__(self) -> bool:
        return bool(self != 0.0)

    def __float__(self) -> float:
        raise TypeError(
            f"{self.NAME} cannot become a float, which would drop its {self.LOST}: for assignment into a float array "
            "use np.stack, np.concatenate or an array made by np.zeros_like(y); for math.* use the numpy function"
        )

    def __getattr__(self, name: str) -> Any:
        # numpy's object loops call a method of the function's name.
        function = getattr(np, name, None)
        if function not in ELEMENTARY and function not in ARRAY_METHODS:
            raise AttributeError(f"{self.WHO} do not know the attribute {name!r} of arrays")
        return partial(function, self)

    def __reduce__(self) -> tuple[Any, ...]:
        return wrap, (self.c.copy(), self.algebra)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        if method == "__call__" and not keywords:  # fast, since each operator comes here
            return self._call(ufunc, inputs)
        name = f"numpy.{ufunc.__name__}"
        if method != "__call__":
            raise self.unknown(f"{name}.{method}")
        (out,) = keywords.pop("out", (None,))
        if keywords:
            raise self.unknown(f"{name} with {', '.join(keywords)}")
        result = self._call(ufunc, inputs)
        if out is None or (isinstance(out, Truncated) and out.ndim == 0):  # numpy scalars never change
            return result
        if not isinstance(out, Truncated):
            raise TypeError(
                f"{name} cannot write {self.NAME} into a plain array, which would drop its {self.LOST}; write "
                "a = a + b instead of a += b, or begin with np.zeros_like(y)"
            )
        out[...] = result
        return out

    @without_warnings(all="ignore")
    def __array_function__(self, function: Any, types: Any, args: Any, keywords: Any) -> Any:
        name, rule = f"{function.__module__}.{function.__name__}", FUNCTIONS.get(function)
        if rule is None:
            raise self.unknown(name)
        try:
            return rule(*args, **keywords)
        except TypeError:
            try:
                inspect.signature(rule).bind(*args, **keywords)
            except TypeError as mismatch:
                raise self.unknown(f"{name} with these arguments ({mismatch})") from None
            raise

    @property
    def T(self) -> Any:
        """The transpose."""
        return self.transpose()

    def copy(self) -> Any:
        """A copy."""
        return wrap(self.c.copy(), self.algebra)

    def reshape(self, *shape: Any) -> Any:
        """Entries in another shape; a view if possible."""
        (shape,) = shape if len(shape) == 1 else (shape,)
        return self.moved(lambda x: x.reshape(*x.shape[: self.OWN], *np.atleast_1d(shape)))

    def ravel(self) -> Any:
        """Entries along one axis."""
        return self.reshape(-1)

    def flatten(self) -> Any:
        """A copy along one axis."""
        return self.ravel().copy()

    def transpose(self, *axes: Any) -> Any:
        """A view with axes permuted, by default reversed."""
        if len(axes) == 1 and not isinstance(axes[0], int):
            (axes,) = axes
        order = range(self.ndim)[::-1] if not axes else [range(self.ndim)[axis] for axis in axes]
        own = self.OWN
        return self.moved(lambda x: x.transpose(*range(own), *(axis + own for axis in order)))

    # Not for evaluated functions

    def unknown(self, operation: str) -> TypeError:
        """The error for an unsupported operation."""
        return TypeError(
            f"{self.WHO} do not know {operation}; write it with numpy functions that they know, or give a jacobian"
        )

    def moved(self, move: Callable[[Array], Array]) -> Any:
        """Apply `move`, which selects entries, to arrays (coefficients, *shape) or (coefficients, boxes, *shape)."""
        return wrap(moved(move, self.c), self.algebra)

    def lifted(self, x: Any) -> Any:
        """`x` itself, or numbers as constants."""
        x = x if isinstance(x, Truncated) else gather(x, self.ONE)
        return x if isinstance(x, Truncated) else wrap(self.constant(x), self.algebra)

    @staticmethod
    def constant(x: Array) -> Coefficients:
        """Numbers as coefficients."""
        return x.astype(float, copy=False)[None]

    @without_warnings(all="ignore")
    def _call(self, ufunc: np.ufunc, inputs: tuple[Any, ...]) -> Any:
        """Overflow gives inf; `series.demand` raises if no series exists."""
        if ufunc is np.matmul and any(issparse(x) for x in inputs):
            a, b = inputs
            matrix, x = (b.T, a) if isinstance(a, Truncated) else (a, b)
            if x.ndim != 1:
                raise self.unknown(f"a sparse product with an array of {x.ndim} axes")
            return wrap(sparse_product(matrix, x.c), x.algebra)
        operands, stores = [], []
        for x in inputs:
            x = gather(x, self.ONE)
            if isinstance(x, Truncated):
                operands.append(x)
                stores.append(x.c)
            else:
                stores.append(self.constant(x))
        algebra = common(operands)
        if len(stores) == 2 and ufunc is not np.matmul:
            stores[:] = ufuncs.aligned(*stores)
        if ufunc in ufuncs.UFUNC_RULES:
            return wrap(ufuncs.UFUNC_RULES[ufunc](algebra, *stores), algebra)
        if ufunc in ufuncs.DECIDED:
            return ufuncs.DECIDED[ufunc](*stores)
        raise self.unknown(f"numpy.{ufunc.__name__}")


KINDS: dict[type, tuple[type[Truncated], type[Truncated]]] = {}


def wrap(c: Coefficients, algebra: Algebra) -> Any:
    """The array with these coefficients."""
    scalar, array = KINDS[type(c)]
    made: Truncated = object.__new__(scalar if c.ndim == scalar.OWN else array)
    made.c, made.algebra = c, algebra
    return made


def gather(x: Any, one: str = "an array of series") -> Any:
    """`x`, an array of numbers, or stacked lists of series."""
    if isinstance(x, Truncated):
        return x
    if type(x) is float:
        return np.asarray(x)
    if isinstance(x, list | tuple) or (isinstance(x, np.ndarray) and x.dtype == object and x.ndim):
        parts = [gather(part, one) for part in x]
        if any(isinstance(part, Truncated) for part in parts):
            return combined(lambda arrays, own: np.stack(arrays, own), parts_of(parts))
        x = parts
    elif isinstance(x, np.ndarray) and x.dtype == object and isinstance(x[()], Truncated):
        return x[()]
    plain = np.asarray(x)
    if plain.dtype.kind not in "fiub":
        raise TypeError(f"{one} met {type(x).__name__} of dtype {plain.dtype}; expected real numbers")
    return plain


def common(operands: Any) -> Algebra:
    """Algebra of all non-constant operands."""
    first = operands[0]
    for x in operands[1:]:
        if len(first.c) == 1:
            first, x = x, first
        constant = len(x.c) == 1 or (len(x.c) == len(first.c) and x.algebra == first.algebra)
        if not constant or x.OWN != first.OWN:
            orders = f"orders {len(first.c) - 1} and {len(x.c) - 1}"
            raise ValueError(f"{first.WHO} of different kinds meet {x.WHO}: {orders}")
    algebra: Algebra = first.algebra
    return algebra


def alike(parts: Any) -> list[Coefficients]:
    """Coefficients, extended to equal numbers of coefficients and boxes."""
    length = max(len(x.c) for x in parts)
    stores = [lengthened(x.c, length) for x in parts]
    if not isinstance(stores[0], Ends):
        return stores
    boxes = max(c.shape[1] for c in stores)
    return [
        c if c.shape[1] == boxes else moved(lambda x: np.broadcast_to(x, (length, boxes, *x.shape[2:])), c)
        for c in stores
    ]


def combined(join: Callable[[list[Array], int], Array], parts: list[Any]) -> Any:
    """Combine arrays by `join(arrays, own)`."""
    own = parts[0].OWN
    return wrap(moved(lambda *arrays: join(list(arrays), own), *alike(parts)), common(parts))


def parts_of(arrays: Any) -> list[Any]:
    """Arrays; numbers are lifted to the kind of the others."""
    parts = [gather(x) for x in arrays]
    like = next(x for x in parts if isinstance(x, Truncated))
    return [like.lifted(x) for x in parts]
