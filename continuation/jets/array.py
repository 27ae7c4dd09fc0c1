"""Jets: arrays whose entries are truncated power series, accepted by numpy as arrays."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from scipy.sparse import issparse

from continuation.arrays import Array, asked_by_sparse
from continuation.jets import ufuncs
from continuation.jets.algebra import TAYLOR, Algebra
from continuation.jets.dispatch import call, unknown


def _operator(ufunc: np.ufunc, *, swapped: bool = False) -> Callable[[Jet, Any], Any]:
    def method(self: Jet, other: Any) -> Any:
        return _call(ufunc, (other, self) if swapped else (self, other))

    return method


def _in_place(ufunc: np.ufunc) -> Callable[[Jet, Any], Any]:
    def method(self: Jet, other: Any) -> Any:
        result = _call(ufunc, (self, other))
        if self.ndim == 0:  # as numpy's scalars, which never change
            return result
        self.c[...] = result.c
        return self

    return method


def _method(function: Any) -> Callable[..., Any]:
    def method(self: Jet, *args: Any, **keywords: Any) -> Any:
        return function(self, *args, **keywords)

    parameters = "Parameters\n----------\n*args, **keywords\n    As for that function."
    method.__doc__ = f"`numpy.{function.__name__}` of this jet.\n\n{parameters}"
    return method


class Jet:
    """An array of truncated power series, sum_k c[k] s**k.

    It has the shape of one coefficient and goes through numpy as an array of that shape would: operators, indexing,
    assignment, ufuncs and the common numpy functions. Comparisons look at the leading coefficient. An operation that
    jets do not know raises TypeError and names itself; one without a series at that coefficient `JetDomainError`.

    Parameters
    ----------
    c : array_like, (K + 1, *shape)
        The coefficients, s**0 first.
    """

    __slots__ = ("algebra", "c")
    __hash__ = None  # type: ignore[assignment]

    c: Array
    algebra: Algebra

    def __new__(cls, c: Any) -> Jet:
        """Check the coefficients and copy them."""
        coefficients = np.array(c, dtype=float)
        if coefficients.ndim == 0 or len(coefficients) == 0:
            raise ValueError(f"c has shape {coefficients.shape}; expected (order + 1, *shape) with order >= 0")
        return wrap(coefficients, TAYLOR)

    @property
    def order(self) -> int:
        """The highest power of s that is kept."""
        return len(self.c) - 1

    def coefficient(self, k: int) -> Array:
        """The coefficient of s**k, an array of the jet's shape.

        Parameters
        ----------
        k : int
            From 0 to `order`.

        Raises
        ------
        ValueError
            For another k.
        """
        if not 0 <= operator.index(k) <= self.order:
            raise ValueError(f"k is {k}; expected 0 <= k <= {self.order}, the order of this jet")
        return np.asarray(self.c[k])

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array."""
        return self.c.shape[1:]

    @property
    def ndim(self) -> int:
        """Number of axes."""
        return self.c.ndim - 1

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(self.c[0].size)

    @property
    def dtype(self) -> np.dtype[np.float64]:
        """That of the coefficients."""
        return self.c.dtype

    def __repr__(self) -> str:
        return f"Jet(shape={self.shape}, order={self.order}, leading={self.c[0]!r})"

    def __float__(self) -> float:
        raise TypeError(
            "a Jet cannot become a float, which would drop its series: for assignment into a float array use "
            "np.stack, np.concatenate or an array made by np.zeros_like(y); for math.* use the numpy function"
        )

    def __bool__(self) -> bool:
        return bool(self.c[0])

    def __getattr__(self, name: str) -> Any:
        # numpy's loops over object arrays call a method of the function's name on each entry.
        rule = ufuncs.ELEMENTARY.get(name)
        if rule is None:
            raise AttributeError(f"jets do not know the attribute {name!r} of arrays")
        return lambda: _call(getattr(np, name), (self,))

    def __reduce__(self) -> tuple[Any, ...]:
        return wrap, (self.c.copy(), self.algebra)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:
        name = f"numpy.{ufunc.__name__}"
        if method != "__call__":
            raise unknown(f"{name}.{method}")
        (out,) = keywords.pop("out", (None,))
        if keywords:
            raise unknown(f"{name} with {', '.join(keywords)}")
        if out is None:
            return _call(ufunc, inputs)
        if not isinstance(out, Jet):
            raise TypeError(
                f"{name} cannot write a Jet into a plain array, which would drop its series; write a = a + b "
                "instead of a += b, or begin with np.zeros_like(y)"
            )
        out.c[...] = _call(ufunc, inputs).c
        return out

    def __array_function__(self, function: Any, types: Any, args: Any, keywords: Any) -> Any:
        return call(function, args, keywords)

    __add__, __radd__, __iadd__ = _operator(np.add), _operator(np.add, swapped=True), _in_place(np.add)
    __sub__, __rsub__ = _operator(np.subtract), _operator(np.subtract, swapped=True)
    __isub__ = _in_place(np.subtract)
    __mul__, __rmul__ = _operator(np.multiply), _operator(np.multiply, swapped=True)
    __imul__ = _in_place(np.multiply)
    __truediv__, __rtruediv__ = _operator(np.divide), _operator(np.divide, swapped=True)
    __itruediv__ = _in_place(np.divide)
    __pow__, __rpow__ = _operator(np.power), _operator(np.power, swapped=True)
    __ipow__ = _in_place(np.power)
    __matmul__, __rmatmul__ = _operator(np.matmul), _operator(np.matmul, swapped=True)
    __lt__, __le__ = _operator(np.less), _operator(np.less_equal)
    __gt__, __ge__ = _operator(np.greater), _operator(np.greater_equal)
    __eq__, __ne__ = _operator(np.equal), _operator(np.not_equal)

    def __neg__(self) -> Jet:
        return wrap(-self.c, self.algebra)

    def __pos__(self) -> Jet:
        return self.copy()

    def __abs__(self) -> Any:
        return _call(np.absolute, (self,))

    @property
    def T(self) -> Jet:
        """The axes in reverse order, as a view."""
        return self.transpose()

    def copy(self) -> Jet:
        """A jet of its own memory."""
        return wrap(self.c.copy(), self.algebra)

    def reshape(self, *shape: Any) -> Jet:
        """The same entries in another shape; a view where that is possible.

        Parameters
        ----------
        *shape : int
            Or one tuple of them.
        """
        (shape,) = shape if len(shape) == 1 else (shape,)
        return wrap(self.c.reshape(len(self.c), *np.atleast_1d(shape)), self.algebra)

    def ravel(self) -> Jet:
        """One axis."""
        return self.reshape(-1)

    def flatten(self) -> Jet:
        """One axis, in memory of its own."""
        return self.ravel().copy()

    def transpose(self, *axes: Any) -> Jet:
        """The axes in another order (reversed unless given), as a view.

        Parameters
        ----------
        *axes : int
            Or one tuple of them.
        """
        if len(axes) == 1 and not isinstance(axes[0], int):
            (axes,) = axes
        order = range(self.ndim)[::-1] if not axes else [range(self.ndim)[axis] for axis in axes]
        return wrap(self.c.transpose(0, *(axis + 1 for axis in order)), self.algebra)

    sum, mean, prod = _method(np.sum), _method(np.mean), _method(np.prod)
    cumsum, dot = _method(np.cumsum), _method(np.dot)


class ArrayJet(Jet):
    """A jet with axes. Scalar jets are no sequences, so that np.array([y[0], ...]) holds them as entries."""

    __slots__ = ()

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        if asked_by_sparse():
            return np.array(None, dtype=object)  # "no" in scipy's terms: Python goes on to `__rmatmul__`
        raise TypeError(
            "a Jet cannot become a plain array, which would drop its series: leave out numpy.asarray, use np.stack for "
            "np.array([jet, ...]), np.zeros_like(y) to assign into, and functions of numpy alone; or give a jacobian"
        )

    def __bool__(self) -> bool:
        raise ValueError("the truth of an array of jets is ambiguous; compare its entries")

    def __len__(self) -> int:
        return int(self.c.shape[1])

    def __iter__(self) -> Iterator[Any]:
        return (self[i] for i in range(len(self)))

    def __getitem__(self, key: Any) -> Any:
        part = self._entries_first()[_behind(key)]
        if part.ndim == 1:
            return wrap(part.copy(), self.algebra)  # a scalar, which does not change with the array
        return wrap(part.transpose(-1, *range(part.ndim - 1)), self.algebra)

    def __setitem__(self, key: Any, value: Any) -> None:
        value = as_jet(value, self)
        self._entries_first()[_behind(key)] = value.c.transpose(*range(1, value.c.ndim), 0)

    def _entries_first(self) -> Array:
        """The coefficients with their own axis last, out of the way of any index."""
        return self.c.transpose(*range(1, self.c.ndim), 0)


def _behind(key: Any) -> tuple[Any, ...]:
    """The index that leaves the last axis alone."""
    key = key if isinstance(key, tuple) else (key,)
    if not any(part is Ellipsis for part in key):
        key = (*key, Ellipsis)
    return (*key, slice(None))


def wrap(c: Array, algebra: Algebra) -> Jet:
    """The jet with these coefficients, not copied."""
    jet: Jet = object.__new__(ArrayJet if c.ndim > 1 else Jet)
    jet.c = c
    jet.algebra = algebra
    return jet


def gather(x: Any) -> Any:
    """`x` as a Jet or a float64 array: lists and object arrays that hold jets are stacked."""
    if isinstance(x, Jet):
        return x
    if isinstance(x, list | tuple) or (isinstance(x, np.ndarray) and x.dtype == object and x.ndim):
        parts = [gather(part) for part in x]
        jets = [part for part in parts if isinstance(part, Jet)]
        if jets:
            return wrap(np.stack([as_jet(part, jets[0]).c for part in parts], axis=1), jets[0].algebra)
        x = parts
    elif isinstance(x, np.ndarray) and x.dtype == object and isinstance(x[()], Jet):
        return x[()]
    plain = np.asarray(x)
    if plain.dtype.kind not in "fiub":
        raise TypeError(f"a jet met {type(x).__name__} of dtype {plain.dtype}; expected real numbers")
    return plain.astype(float, copy=False)


def as_jet(x: Any, like: Jet) -> Jet:
    """`x` as a jet of the order and algebra of `like`."""
    if isinstance(x := gather(x), Jet):
        common((like, x))
        return x
    c = np.zeros((len(like.c), *x.shape))
    c[0] = x
    return wrap(c, like.algebra)


def common(operands: Any) -> Algebra:
    """The algebra of the jets among the operands, whose orders must agree."""
    first, *others = (x for x in operands if isinstance(x, Jet))
    for jet in others:
        if len(jet.c) != len(first.c) or type(jet.algebra) is not type(first.algebra):
            raise ValueError(f"jets of different kinds meet: orders {first.order} and {jet.order}")
    return first.algebra


def operand(x: Any) -> Array:
    """Coefficients; those of a plain array have length 1."""
    if type(x) is float:
        return np.array([x])
    x = gather(x)
    return x.c if isinstance(x, Jet) else x[None]


def _call(ufunc: np.ufunc, inputs: tuple[Any, ...]) -> Any:
    if ufunc is np.matmul and any(issparse(x) for x in inputs):
        return _sparse_product(*inputs)
    inputs = tuple(gather(x) if isinstance(x, np.ndarray | list | tuple) else x for x in inputs)
    algebra = common(inputs)
    with np.errstate(all="ignore"):  # overflow shows as inf, as in any array; where no series exists, demand() raises
        if len(inputs) == 1:
            if ufunc in ufuncs.TESTS:
                return ufuncs.TESTS[ufunc](inputs[0].c)
            if ufunc in ufuncs.UNARY:
                return wrap(ufuncs.UNARY[ufunc](algebra, inputs[0].c), algebra)
        elif len(inputs) == 2:
            a, b = operand(inputs[0]), operand(inputs[1])
            if ufunc is np.matmul:
                return wrap(ufuncs.matmul(algebra, a, b), algebra)
            if ufunc in ufuncs.COMPARISONS:
                return ufunc(a[0], b[0])
            if ufunc in ufuncs.BINARY:
                return wrap(ufuncs.BINARY[ufunc](algebra, *ufuncs.aligned(a, b)), algebra)
    raise unknown(f"numpy.{ufunc.__name__}")


def _sparse_product(a: Any, b: Any) -> Jet:
    jet = a if isinstance(a, Jet) else b
    if jet.ndim != 1:
        raise unknown(f"a sparse product with an array of {jet.ndim} axes")
    product = (a @ b.c.T).T if jet is b else (b.T @ a.c.T).T
    return wrap(np.ascontiguousarray(product), jet.algebra)
