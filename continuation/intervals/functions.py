"""What numpy's functions (as opposed to its ufuncs) make of interval arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.lib.array_utils import normalize_axis_index, normalize_axis_tuple

from continuation.arrays import Array, clipped
from continuation.intervals.array import Interval, alike, as_interval, unknown, wrap
from continuation.intervals.ends import TINIEST, Ends, accumulated, bilinear, up_sum
from continuation.intervals.operations import broadcast_to, product_of

# --- reductions -------------------------------------------------------------------------------------------


def _axes(axis: Any, ndim: int) -> tuple[int, ...]:
    return tuple(range(ndim)) if axis is None else normalize_axis_tuple(axis, ndim)


def _added(add: Callable[[Array], Array], ends: Ends, count: int) -> Ends:
    """Sums of up to `count` entries, in whatever order `add` takes them."""
    if count <= 1:
        return Ends(add(ends.lo), add(ends.hi))
    error = accumulated(count) * add(ends.magnitude())
    return Ends(-up_sum(error - add(ends.lo)), up_sum(add(ends.hi) + error))


def _sum(a: Any, axis: Any = None, *, keepdims: bool = False) -> Interval:
    a = as_interval(a)
    axes = _axes(axis, a.ndim)
    count = int(np.prod([a.shape[k] for k in axes]))
    places = tuple(k + 2 for k in axes)
    return wrap(_added(lambda x: np.asarray(x.sum(axis=places, keepdims=keepdims)), a.ends, count), a.algebra)


def _mean(a: Any, axis: Any = None, *, keepdims: bool = False) -> Any:
    a = as_interval(a)
    count = int(np.prod([a.shape[k] for k in _axes(axis, a.ndim)]))
    if count == 0:
        raise ValueError(f"numpy.mean of an array of shape {a.shape} along axis {axis}: there is nothing to average")
    return _sum(a, axis, keepdims=keepdims) / count


def _prod(a: Any, axis: Any = None, *, keepdims: bool = False) -> Any:
    a = as_interval(a)
    axes = _axes(axis, a.ndim)
    kept = [k for k in range(a.ndim) if k not in axes]
    out: Any = as_interval(np.ones([a.shape[k] for k in kept]))
    for factor in a.transpose(*axes, *kept).reshape(-1, *(a.shape[k] for k in kept)) if a.ndim else (a,):
        out = out * factor
    return out.reshape([1 if k in axes else a.shape[k] for k in range(a.ndim)]) if keepdims else out


def _norm(x: Any, ord: Any = None, axis: Any = None, *, keepdims: bool = False) -> Any:
    if not (ord is None or ord == 2 or ord == "fro"):
        raise unknown(f"numpy.linalg.norm with ord={ord!r}")
    return np.sqrt(_sum(np.square(as_interval(x)), axis, keepdims=keepdims))


def _cumsum(a: Any, axis: Any = None) -> Interval:
    a = as_interval(a) if axis is not None else as_interval(a).ravel()
    along = normalize_axis_index(axis or 0, a.ndim)
    return wrap(_added(lambda x: np.cumsum(x, axis=along + 2), a.ends, a.shape[along]), a.algebra)


def _diff(a: Any, n: int = 1, axis: int = -1) -> Any:
    a = as_interval(a)
    rows = np.arange(a.shape[axis])
    for _ in range(n):
        a = np.take(a, rows[1:], axis) - np.take(a, rows[:-1], axis)
        rows = rows[:-1]
    return a


# --- products ---------------------------------------------------------------------------------------------


def _dot(a: Any, b: Any) -> Any:
    a, b = as_interval(a), as_interval(b)
    if a.ndim == 0 or b.ndim == 0:
        return a * b
    return a @ b if b.ndim <= 2 else _tensordot(a, b, axes=(-1, -2))


def _inner(a: Any, b: Any) -> Any:
    a, b = as_interval(a), as_interval(b)
    return a * b if a.ndim == 0 or b.ndim == 0 else _tensordot(a, b, axes=(-1, -1))


def _tensordot(a: Any, b: Any, axes: Any = 2) -> Any:
    a, b = as_interval(a), as_interval(b)
    if isinstance(axes, int):
        axes = (range(a.ndim - axes, a.ndim), range(axes))
    left, right = normalize_axis_tuple(axes[0], a.ndim), normalize_axis_tuple(axes[1], b.ndim)
    if [a.shape[k] for k in left] != [b.shape[k] for k in right]:
        raise ValueError(f"numpy.tensordot: axes {axes} of shapes {a.shape} and {b.shape} do not pair")
    rows, columns = ([k for k in range(x.ndim) if k not in used] for x, used in ((a, left), (b, right)))
    length = int(np.prod([a.shape[k] for k in left]))
    first, second = a.transpose(*rows, *left).reshape(-1, length), b.transpose(*right, *columns).reshape(length, -1)
    return (first @ second).reshape(*(a.shape[k] for k in rows), *(b.shape[k] for k in columns))


def _einsum(subscripts: Any, *operands: Any, optimize: Any = False) -> Interval:
    if not isinstance(subscripts, str) or len(operands) not in (1, 2) or set("YZ") & set(subscripts):
        raise unknown("numpy.einsum unless it has subscripts (without Y and Z) and one or two operands")
    inputs, arrow, output = subscripts.replace(" ", "").partition("->")
    if not arrow:
        labels = inputs.replace(",", "").replace("...", "")
        output = "..." * ("..." in inputs) + "".join(x for x in sorted(set(labels)) if labels.count(x) == 1)
    arrays = [as_interval(x) for x in operands]
    # Y and Z label the coefficients and the boxes.
    spec = ",".join("YZ" + part for part in inputs.split(",")) + "->YZ" + output
    if len(arrays) == 1:
        count = arrays[0].size
        return wrap(_added(lambda x: np.einsum(spec, x), arrays[0].ends, count), arrays[0].algebra)
    a, b = arrays
    algebra = max(a.algebra, b.algebra)
    return wrap(
        product_of(lambda p, q: bilinear(lambda x, y: np.einsum(spec, x, y), p, q), a.ends, b.ends, algebra), algebra
    )


def _sparse(a: Any, b: Any) -> Interval:
    """A sparse matrix of numbers times a vector of intervals, from either side."""
    matrix, x = (b.T, a) if isinstance(a, Interval) else (a, b)
    if x.ndim != 1:
        raise unknown(f"a sparse product with an array of {x.ndim} axes")
    rows = matrix.tocsr()
    count = int(np.diff(rows.indptr).max(initial=1))

    def times(entries: Any, v: Array) -> Array:
        return np.ascontiguousarray((entries @ v.reshape(-1, v.shape[-1]).T).T).reshape(*v.shape[:2], -1)

    middle = x.ends.middle()
    size = abs(rows)
    radius = times(size, x.ends.radius(middle)) + accumulated(count) * times(size, np.abs(middle))
    radius = radius * (1.0 + accumulated(count)) + 4.0 * count * TINIEST
    centre = times(rows, middle)
    return wrap(Ends(-up_sum(radius - centre), up_sum(centre + radius)), x.algebra)


# --- selection and assembly -------------------------------------------------------------------------------


def _gathered(parts: list[Interval], places: Any) -> Any:
    """Entries by number: 0 is a zero, the others count through the parts."""
    if isinstance(places, list | tuple):
        return [_gathered(parts, part) for part in places]
    arrays = alike(parts)

    def flat(ends: list[Array]) -> Array:
        rows = [x.reshape(*x.shape[:2], -1) for x in ends]
        return np.concatenate([np.zeros_like(rows[0][..., :1], shape=(*rows[0].shape[:2], 1)), *rows], axis=-1)[
            ..., places
        ]

    algebra = max(x.algebra for x in arrays)
    return wrap(Ends(flat([x.ends.lo for x in arrays]), flat([x.ends.hi for x in arrays])), algebra)


def _numbers(parts: list[Interval]) -> list[Any]:
    """The entries of all parts, numbered from 1, in the shapes of the parts."""
    first, out = 1, []
    for part in parts:
        out.append(np.arange(first, first + part.size).reshape(part.shape))
        first += part.size
    return out


def _selecting(function: Any) -> Callable[..., Any]:
    """The rule of a function of one array that only moves entries, found by applying it to their numbers."""

    def rule(a: Any, *args: Any, **keywords: Any) -> Any:
        if keywords.get("constant_values", 0) != 0:
            raise unknown("numpy.pad with constants other than 0")
        parts = [as_interval(a)]
        return _gathered(parts, function(_numbers(parts)[0], *args, **keywords))

    return rule


def _joining(function: Any) -> Callable[..., Any]:
    """The rule of a function that puts a sequence of arrays together."""

    def rule(arrays: Any, *args: Any, **keywords: Any) -> Any:
        parts = [as_interval(x) for x in arrays]
        return _gathered(parts, function(_numbers(parts), *args, **keywords))

    return rule


def _where(condition: Any, x: Any, y: Any) -> Any:
    if isinstance(condition, Interval):
        raise unknown("numpy.where with intervals for a condition (compare them first)")
    parts = [as_interval(x), as_interval(y)]
    return _gathered(parts, np.where(condition, *_numbers(parts)))


def _append(arr: Any, values: Any, axis: Any = None) -> Any:
    return RULES[np.concatenate]([arr, values], axis)


def _bincount(x: Any, weights: Any, minlength: int = 0) -> Any:
    places = np.arange(max(minlength, int(np.max(x, initial=-1)) + 1))
    return (places[:, None] == x).astype(float) @ as_interval(weights)


def _like(a: Interval, value: Any, dtype: Any, shape: Any) -> Interval:
    if dtype is not None and np.dtype(dtype) != np.float64:
        raise unknown(f"arrays like themselves of dtype {np.dtype(dtype)}")
    shape = a.shape if shape is None else (shape,) if isinstance(shape, int) else tuple(shape)
    return broadcast_to(as_interval(value), shape)


RULES: dict[Any, Callable[..., Any]] = {
    "sparse": _sparse,
    np.sum: _sum,
    np.mean: _mean,
    np.prod: _prod,
    np.linalg.norm: _norm,
    np.cumsum: _cumsum,
    np.trace: lambda a, offset=0, axis1=0, axis2=1: _sum(np.diagonal(a, offset, axis1, axis2), -1),
    np.diff: _diff,
    np.dot: _dot,
    np.inner: _inner,
    np.vdot: lambda a, b: as_interval(a).ravel() @ as_interval(b).ravel(),
    np.outer: lambda a, b: as_interval(a).reshape(-1, 1) * as_interval(b).reshape(1, -1),
    np.tensordot: _tensordot,
    np.einsum: _einsum,
    np.append: _append,
    np.bincount: _bincount,
    np.where: _where,
    np.clip: clipped,
    np.zeros_like: lambda a, dtype=None, *, shape=None: _like(a, 0.0, dtype, shape),
    np.ones_like: lambda a, dtype=None, *, shape=None: _like(a, 1.0, dtype, shape),
    np.empty_like: lambda prototype, dtype=None, *, shape=None: _like(prototype, 0.0, dtype, shape),
    np.full_like: lambda a, fill_value, dtype=None, *, shape=None: _like(a, fill_value, dtype, shape),
    np.copy: lambda a: a.copy(),
    np.shape: lambda a: a.shape,
    np.ndim: lambda a: a.ndim,
    np.size: lambda a, axis=None: a.size if axis is None else a.shape[axis],
    **{f: _joining(f) for f in (np.concatenate, np.stack, np.hstack, np.vstack, np.column_stack)},
    **{
        f: _selecting(f)
        for f in (
            *(np.roll, np.flip, np.flipud, np.fliplr, np.rot90, np.take, np.tile, np.repeat, np.delete, np.split),
            *(np.diag, np.diagonal, np.tril, np.triu, np.moveaxis, np.swapaxes, np.reshape, np.ravel, np.transpose),
            *(np.squeeze, np.expand_dims, np.broadcast_to, np.atleast_1d, np.atleast_2d, np.pad),
        )
    },
}
"""Every numpy function that interval arrays know."""
