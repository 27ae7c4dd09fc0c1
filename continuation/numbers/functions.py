"""Rules of numpy functions for series."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from string import ascii_letters
from typing import Any

import numpy as np
from numpy.lib.array_utils import normalize_axis_index, normalize_axis_tuple

from continuation.arrays import Array, clipped
from continuation.numbers.algebra import product
from continuation.numbers.ends import added
from continuation.numbers.truncated import Truncated, combined, common, gather, parts_of, wrap
from continuation.numbers.ufuncs import sums_of_products

# Reductions


def _axes(axis: Any, ndim: int) -> tuple[int, ...]:
    return tuple(range(ndim)) if axis is None else normalize_axis_tuple(axis, ndim)


def _sum(a: Any, axis: Any = None, *, keepdims: bool = False) -> Any:
    a = gather(a)
    axes = _axes(axis, a.ndim)
    count, behind = int(np.prod([a.shape[k] for k in axes])), tuple(k + a.OWN for k in axes)
    return wrap(added(lambda x: np.asarray(x.sum(axis=behind, keepdims=keepdims)), a.c, count), a.algebra)


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
    out = rest[0] if len(rest) else _like(rest, 1.0, None, rest.shape[1:])
    return out.reshape([1 if k in axes else a.shape[k] for k in range(a.ndim)]) if keepdims else out


def _norm(x: Any, ord: Any = None, axis: Any = None, *, keepdims: bool = False) -> Any:
    x = gather(x)
    euclidean = ord is None or (ord == 2 and (x.ndim if axis is None else np.size(axis)) == 1)
    if not (euclidean or (isinstance(ord, str) and ord == "fro")):
        raise x.unknown(f"numpy.linalg.norm with ord={ord!r}")
    return np.sqrt(_sum(np.square(x), axis, keepdims=keepdims))


def _diff(a: Any, n: int = 1, axis: int = -1) -> Any:
    a = gather(a)
    before, c = (slice(None),) * (normalize_axis_index(axis, a.ndim) + a.OWN), a.c
    for _ in range(n):
        c = c[(*before, slice(1, None))] - c[(*before, slice(None, -1))]
    return wrap(c, a.algebra)


def _bincount(x: Any, weights: Any, minlength: int = 0) -> Any:
    places = np.arange(max(minlength, int(np.max(x, initial=-1)) + 1))
    return (places[:, None] == x).astype(float) @ gather(weights)


# Products


def _dot(a: Any, b: Any) -> Any:
    a, b = gather(a), gather(b)
    if b.ndim > 2:
        raise next(x for x in (a, b) if isinstance(x, Truncated)).unknown("numpy.dot with more than two axes")
    return a * b if a.ndim == 0 or b.ndim == 0 else a @ b


def _einsum(subscripts: Any, *operands: Any, optimize: Any = False) -> Any:
    like = next(x for x in map(gather, operands) if isinstance(x, Truncated))
    if not isinstance(subscripts, str):
        raise like.unknown("numpy.einsum without subscripts")
    inputs, arrow, output = subscripts.replace(" ", "").partition("->")
    labels = inputs.replace(",", "").replace("...", "")
    own = "".join([x for x in ascii_letters if x not in labels][: like.OWN])
    if len(own) < like.OWN:
        raise like.unknown("numpy.einsum with every letter of the alphabet")
    if not arrow:
        output = "..." * ("..." in inputs) + "".join(x for x in sorted(set(labels)) if labels.count(x) == 1)
    parts, arrays = inputs.split(","), [like.lifted(x) for x in operands]
    if len(parts) != len(arrays):
        raise ValueError(f"numpy.einsum: {subscripts!r} has {len(parts)} operands, found {len(arrays)}")
    part, total = parts[0], arrays[0]
    for k, (other, array) in enumerate(zip(parts[1:], arrays[1:]), 2):
        later = output + "".join(parts[k:])
        both = "..." * ("..." in part + other) + "".join(
            x for x in dict.fromkeys(part + other) if x in later.replace(".", "")
        )
        kept = both if k < len(parts) else output
        contract = partial(np.einsum, f"{own}{part},{own}{other}->{own}{kept}")
        algebra = common((total, array))
        total, part = wrap(product(algebra, sums_of_products(contract), total.c, array.c), algebra), kept
    if len(parts) == 1:
        spec = f"{own}{part}->{own}{output}"
        return wrap(added(lambda x: np.einsum(spec, x), total.c, total.size), total.algebra)
    return total


# Assembly


def _concatenate(arrays: Any, axis: int | None = 0) -> Any:
    parts = parts_of(arrays)
    return _along(np.concatenate, [x.ravel() for x in parts] if axis is None else parts, axis or 0, parts[0].ndim)


def _along(join: Callable[..., Array], parts: list[Any], axis: int, ndim: int) -> Any:
    along = normalize_axis_index(axis, ndim)
    return combined(lambda arrays, own: join(arrays, axis=along + own), parts)


def _where(condition: Any, x: Any, y: Any) -> Any:
    if isinstance(condition, Truncated):
        raise condition.unknown("numpy.where with such an array for a condition (compare it first)")
    condition, parts = np.asarray(condition), parts_of([x, y])
    ndim = max(condition.ndim, *(part.ndim for part in parts))
    parts = [part.reshape((1,) * (ndim - part.ndim) + part.shape) for part in parts]
    return combined(lambda arrays, own: np.where(condition, *arrays), parts)


def _like(a: Any, value: Any, dtype: Any, shape: Any) -> Any:
    if dtype is not None and np.dtype(dtype) != np.float64:
        raise a.unknown(f"arrays like themselves of dtype {np.dtype(dtype)}")
    shape = a.shape if shape is None else tuple(np.atleast_1d(shape))
    out = a.moved(lambda x: np.zeros((*x.shape[: a.OWN], *shape)))
    if shape:
        out[...] = value
        return out
    return out + value


# Shape


def _moved(function: Any) -> Callable[..., Any]:
    def rule(a: Any, *args: Any, **keywords: Any) -> Any:
        a = gather(a)
        others = [x for x in (*args, *keywords.values()) if isinstance(x, Truncated)]
        if others:
            raise others[0].unknown(f"numpy.{function.__name__} with {others[0].ONE} for any argument but the first")
        if not isinstance(a, Truncated):
            return function(a, *args, **keywords)
        entries = a.moved(
            lambda x: np.concatenate([np.zeros((*x.shape[: a.OWN], 1)), x.reshape(*x.shape[: a.OWN], -1)], -1)
        )
        places = function(np.arange(1, a.size + 1).reshape(a.shape), *args, **keywords)
        return [entries[part] for part in places] if isinstance(places, list) else entries[places]

    return rule


def _each(rule: Callable[[Any], Any], *arys: Any) -> Any:
    return rule(arys[0]) if len(arys) == 1 else tuple(map(rule, arys))


def _pad(array: Any, pad_width: Any, mode: str = "constant", **keywords: Any) -> Any:
    if keywords or mode not in ("constant", "edge", "wrap", "reflect", "symmetric"):
        raise array.unknown(f"numpy.pad with mode={mode!r} and {', '.join(keywords) or 'no keywords'}")
    return _moved(np.pad)(array, pad_width, mode)


FUNCTION_RULES: dict[Any, Callable[..., Any]] = {
    np.sum: _sum,
    np.mean: _mean,
    np.prod: _prod,
    np.linalg.norm: _norm,
    np.bincount: _bincount,
    np.diff: _diff,
    np.dot: _dot,
    np.vdot: lambda a, b: gather(a).reshape(-1) @ gather(b).reshape(-1),
    np.outer: lambda a, b: gather(a).reshape(-1, 1) * gather(b).reshape(1, -1),
    np.einsum: _einsum,
    np.concatenate: _concatenate,
    np.stack: lambda arrays, axis=0: _along(np.stack, parts := parts_of(arrays), axis, parts[0].ndim + 1),
    np.hstack: lambda tup: _concatenate(parts := [np.atleast_1d(x) for x in parts_of(tup)], min(1, parts[0].ndim - 1)),
    np.vstack: lambda tup: _concatenate([np.atleast_2d(x) for x in parts_of(tup)]),
    np.column_stack: lambda tup: _concatenate([x.reshape(-1, 1) if x.ndim < 2 else x for x in parts_of(tup)], 1),
    np.append: lambda arr, values, axis=None: _concatenate([arr, values], axis),
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
    np.transpose: lambda a, axes=None: a.transpose(*(axes or ())),
    np.reshape: lambda a, shape: gather(a).reshape(shape),
    np.ravel: lambda a: gather(a).reshape(-1),
    np.pad: _pad,
    **{f: partial(_each, _moved(f)) for f in (np.atleast_1d, np.atleast_2d, np.atleast_3d)},
    **{
        f: _moved(f)
        for f in (
            *(np.roll, np.flip, np.flipud, np.fliplr, np.rot90, np.take, np.tile, np.repeat, np.delete),
            *(np.diag, np.diagonal, np.tril, np.triu, np.moveaxis, np.swapaxes),
            *(np.squeeze, np.expand_dims, np.broadcast_to, np.split, np.array_split, np.hsplit, np.vsplit),
        )
    },
}
