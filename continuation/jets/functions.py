"""What numpy's functions (as opposed to its ufuncs) do to jets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.lib.array_utils import normalize_axis_index, normalize_axis_tuple

from continuation.arrays import Array, clipped
from continuation.jets.array import Jet, as_jet, common, gather, operand, wrap
from continuation.jets.dispatch import unknown

# --- reductions -------------------------------------------------------------------------------------------


def _axes(axis: Any, ndim: int) -> tuple[int, ...]:
    return tuple(range(ndim)) if axis is None else normalize_axis_tuple(axis, ndim)


def _sum(a: Any, axis: Any = None, *, keepdims: bool = False) -> Jet:
    a = gather(a)
    axes = tuple(k + 1 for k in _axes(axis, a.ndim))
    return wrap(np.asarray(a.c.sum(axis=axes, keepdims=keepdims)), a.algebra)


def _mean(a: Any, axis: Any = None, *, keepdims: bool = False) -> Any:
    a = gather(a)
    count = int(np.prod([a.shape[k] for k in _axes(axis, a.ndim)]))
    if count == 0:
        raise ValueError(f"numpy.mean of an array of shape {a.shape} along axis {axis}: there is nothing to average")
    return _sum(a, axis, keepdims=keepdims) / count


def _prod(a: Any, axis: Any = None, *, keepdims: bool = False) -> Any:
    a = gather(a)
    axes = _axes(axis, a.ndim)
    kept = [k for k in range(a.ndim) if k not in axes]
    rest = a.transpose([*axes, *kept]).reshape(-1, *(a.shape[k] for k in kept)) if a.ndim else a.reshape(1)
    while len(rest) > 1:
        half = len(rest) // 2
        rest = np.concatenate([rest[:half] * rest[half : 2 * half], rest[2 * half :]])
    out = rest[0] if len(rest) else _like(rest, rest.shape[1:], 1.0)
    return out.reshape([1 if k in axes else a.shape[k] for k in range(a.ndim)]) if keepdims else out


def _norm(x: Any, ord: Any = None, axis: Any = None, *, keepdims: bool = False) -> Any:
    x = gather(x)
    euclidean = ord is None or (ord == 2 and (x.ndim if axis is None else np.size(axis)) == 1)
    if not (euclidean or (isinstance(ord, str) and ord == "fro")):
        raise unknown(f"numpy.linalg.norm with ord={ord!r}")
    return np.sqrt(_sum(x * x, axis, keepdims=keepdims))


def _cumsum(a: Any, axis: Any = None) -> Jet:
    a = gather(a) if axis is not None else gather(a).ravel()
    return wrap(np.cumsum(a.c, axis=normalize_axis_index(axis or 0, a.ndim) + 1), a.algebra)


def _trace(a: Any, offset: int = 0, axis1: int = 0, axis2: int = 1) -> Jet:
    a = gather(a)
    first, second = normalize_axis_tuple((axis1, axis2), a.ndim)
    return wrap(np.trace(a.c, offset, first + 1, second + 1), a.algebra)


def _diff(a: Any, n: int = 1, axis: int = -1) -> Any:
    a = gather(a)
    return wrap(np.diff(a.c, n, axis=normalize_axis_index(axis, a.ndim) + 1), a.algebra)


# --- products ---------------------------------------------------------------------------------------------


def _dot(a: Any, b: Any) -> Any:
    a, b = gather(a), gather(b)
    if a.ndim == 0 or b.ndim == 0:
        return a * b
    return a @ b if b.ndim <= 2 else _tensordot(a, b, axes=(-1, -2))


def _inner(a: Any, b: Any) -> Any:
    a, b = gather(a), gather(b)
    return a * b if a.ndim == 0 or b.ndim == 0 else _tensordot(a, b, axes=(-1, -1))


def _tensordot(a: Any, b: Any, axes: Any = 2) -> Jet:
    a, b = gather(a), gather(b)
    if isinstance(axes, int):
        axes = (range(a.ndim - axes, a.ndim), range(axes))
    left, right = normalize_axis_tuple(axes[0], a.ndim), normalize_axis_tuple(axes[1], b.ndim)
    if len(left) != len(right):
        raise ValueError(f"numpy.tensordot: axes {axes} do not pair")
    letters = iter("abcdefghijklmnopqrstuvwxyABCDEFGHIJKLMNOPQRSTUVWXY")
    first = [next(letters) for _ in range(a.ndim)]
    paired = {axis: first[partner] for axis, partner in zip(right, left)}
    second = [paired.get(axis) or next(letters) for axis in range(b.ndim)]
    free = [x for k, x in enumerate(first) if k not in left] + [x for k, x in enumerate(second) if k not in right]
    return _einsum(f"{''.join(first)},{''.join(second)}->{''.join(free)}", a, b)


def _einsum(subscripts: str, *operands: Any, optimize: Any = False) -> Jet:
    if not isinstance(subscripts, str) or len(operands) not in (1, 2) or "Z" in subscripts:
        raise unknown("numpy.einsum unless it has subscripts (without Z) and one or two operands")
    inputs, arrow, output = subscripts.replace(" ", "").partition("->")
    if not arrow:
        labels = inputs.replace(",", "").replace("...", "")
        output = "..." * ("..." in inputs) + "".join(x for x in sorted(set(labels)) if labels.count(x) == 1)
    jets = [gather(x) for x in operands]
    algebra = common(jets)
    # Z labels the coefficients; it is one long in a single coefficient, which einsum broadcasts.
    spec = ",".join("Z" + part for part in inputs.split(",")) + "->Z" + output
    if len(jets) == 1:
        return wrap(np.einsum(spec, jets[0].c), algebra)
    return wrap(algebra.product(lambda a, b: np.einsum(spec, a, b), *map(operand, jets)), algebra)


# --- assembly ---------------------------------------------------------------------------------------------


def _pieces(arrays: Any) -> list[Jet]:
    parts = [gather(x) for x in arrays]
    like = next(x for x in parts if isinstance(x, Jet))
    return [as_jet(x, like) for x in parts]


def _concatenate(arrays: Any, axis: int | None = 0) -> Jet:
    parts = [x.ravel() for x in _pieces(arrays)] if axis is None else _pieces(arrays)
    along = normalize_axis_index(axis or 0, parts[0].ndim) + 1
    return wrap(np.concatenate([x.c for x in parts], axis=along), parts[0].algebra)


def _stack(arrays: Any, axis: int = 0) -> Jet:
    parts = _pieces(arrays)
    along = normalize_axis_index(axis, parts[0].ndim + 1) + 1
    return wrap(np.stack([x.c for x in parts], axis=along), parts[0].algebra)


def _hstack(tup: Any) -> Jet:
    parts = [np.atleast_1d(x) for x in _pieces(tup)]
    return _concatenate(parts, 0 if parts[0].ndim == 1 else 1)


def _where(condition: Any, x: Any, y: Any) -> Jet:
    if isinstance(condition, Jet):
        raise unknown("numpy.where with a jet for a condition (compare it first)")
    x, y = _pieces([x, y])
    a, b = np.broadcast_arrays(*(_entries_first(jet) for jet in (x, y)))
    chosen = np.where(np.asarray(condition)[..., None], a, b)
    return wrap(np.moveaxis(chosen, -1, 0), x.algebra)


def _entries_first(jet: Jet) -> Array:
    return np.moveaxis(jet.c, 0, -1)


def _like(a: Jet, shape: Any, value: Any) -> Jet:
    shape = a.shape if shape is None else (shape,) if isinstance(shape, int) else tuple(shape)
    out = wrap(np.zeros((len(a.c), *shape)), a.algebra)
    out.c[...] = np.moveaxis(np.broadcast_to(_entries_first(as_jet(value, a)), (*shape, len(a.c))), -1, 0)
    return out


def _full_like(a: Jet, fill_value: Any, dtype: Any = None, *, shape: Any = None) -> Jet:
    if dtype is not None and np.dtype(dtype) != np.float64:
        raise unknown(f"arrays like themselves of dtype {np.dtype(dtype)}")
    return _like(a, shape, fill_value)


# --- shape ------------------------------------------------------------------------------------------------


def _squeeze(a: Jet, axis: Any = None) -> Jet:
    axes = [k for k in range(a.ndim) if a.shape[k] == 1] if axis is None else _axes(axis, a.ndim)
    return wrap(np.squeeze(a.c, axis=tuple(k + 1 for k in axes)), a.algebra)


def _expand_dims(a: Jet, axis: Any) -> Jet:
    count = a.ndim + np.size(axis)
    return wrap(np.expand_dims(a.c, tuple(k + 1 for k in normalize_axis_tuple(axis, count))), a.algebra)


def _broadcast_to(array: Jet, shape: Any) -> Jet:
    shape = (shape,) if isinstance(shape, int) else tuple(shape)
    return wrap(np.moveaxis(np.broadcast_to(_entries_first(array), (*shape, len(array.c))), -1, 0), array.algebra)


def _at_least(ndim: int) -> Callable[..., Any]:
    def rule(*arys: Any) -> Any:
        parts = [x.reshape((1,) * (ndim - x.ndim) + x.shape) if x.ndim < ndim else x for x in map(gather, arys)]
        return parts[0] if len(parts) == 1 else tuple(parts)

    return rule


def _reshape(a: Jet, /, shape: Any, order: str = "C") -> Jet:
    if order != "C":
        raise unknown(f"numpy.reshape with order={order!r}")
    return a.reshape(shape)


def _moved(function: Any) -> Callable[..., Jet]:
    """The rule of a function that only selects entries or zeros, found by applying it to the indices of the entries."""

    def rule(a: Any, *args: Any, **keywords: Any) -> Jet:
        if not isinstance(a, Jet):
            raise unknown(f"{function.__module__}.{function.__name__} with a jet for any argument but the first")
        places = function(np.arange(1, a.size + 1).reshape(a.shape), *args, **keywords)
        entries = np.zeros((len(a.c), a.size + 1))
        entries[:, 1:] = a.c.reshape(len(a.c), -1)
        return wrap(entries[:, places], a.algebra)

    return rule


def _pad(array: Jet, pad_width: Any, mode: str = "constant", **keywords: Any) -> Any:
    if mode not in ("constant", "edge", "wrap", "reflect", "symmetric"):
        raise unknown(f"numpy.pad with mode={mode!r}")
    values = keywords.pop("constant_values", 0)
    out = _moved(np.pad)(array, pad_width, mode, **keywords)
    return out + np.pad(np.zeros(array.shape), pad_width, constant_values=values) if mode == "constant" else out


def _split(ary: Jet, indices_or_sections: Any, axis: int = 0) -> list[Jet]:
    places = np.array_split(np.arange(ary.shape[axis]), indices_or_sections)
    if isinstance(indices_or_sections, int) and ary.shape[axis] % indices_or_sections:
        raise ValueError(f"numpy.split: {ary.shape[axis]} entries do not divide into {indices_or_sections} equal parts")
    return [_moved(np.take)(ary, part, axis) for part in places]


RULES: dict[Any, Callable[..., Any]] = {
    np.sum: _sum,
    np.mean: _mean,
    np.prod: _prod,
    np.linalg.norm: _norm,
    np.cumsum: _cumsum,
    np.trace: _trace,
    np.diff: _diff,
    np.dot: _dot,
    np.inner: _inner,
    np.vdot: lambda a, b: gather(a).reshape(-1) @ gather(b).reshape(-1),
    np.outer: lambda a, b: gather(a).reshape(-1, 1) * gather(b).reshape(1, -1),
    np.tensordot: _tensordot,
    np.einsum: _einsum,
    np.concatenate: _concatenate,
    np.stack: _stack,
    np.hstack: _hstack,
    np.vstack: lambda tup: _concatenate([np.atleast_2d(x) for x in _pieces(tup)]),
    np.column_stack: lambda tup: _concatenate([x.reshape(-1, 1) if x.ndim < 2 else x for x in _pieces(tup)], 1),
    np.append: lambda arr, values, axis=None: _concatenate([arr, values], axis),
    np.where: _where,
    np.clip: clipped,
    np.zeros_like: lambda a, dtype=None, *, shape=None: _full_like(a, 0.0, dtype, shape=shape),
    np.ones_like: lambda a, dtype=None, *, shape=None: _full_like(a, 1.0, dtype, shape=shape),
    np.empty_like: lambda prototype, dtype=None, *, shape=None: _full_like(prototype, 0.0, dtype, shape=shape),
    np.full_like: _full_like,
    np.copy: lambda a: a.copy(),
    np.shape: lambda a: a.shape,
    np.ndim: lambda a: a.ndim,
    np.size: lambda a, axis=None: a.size if axis is None else a.shape[axis],
    np.reshape: _reshape,
    np.ravel: lambda a, order="C": _reshape(a, -1, order),
    np.transpose: lambda a, axes=None: a.transpose(*(axes or ())),
    np.squeeze: _squeeze,
    np.expand_dims: _expand_dims,
    np.broadcast_to: _broadcast_to,
    np.atleast_1d: _at_least(1),
    np.atleast_2d: _at_least(2),
    np.pad: _pad,
    np.split: _split,
    **{
        function: _moved(function)
        for function in (
            *(np.roll, np.flip, np.flipud, np.fliplr, np.rot90, np.take, np.tile, np.repeat, np.delete),
            *(np.diag, np.diagonal, np.tril, np.triu, np.moveaxis, np.swapaxes),
        )
    },
}
"""Every numpy function that jets know."""
