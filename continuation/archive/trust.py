"""From JSON to objects, of classes that are trusted alone: nothing that a file names is imported, called or made.

Trusted are the parts of this library, the homotopies that installed packages register as entry points of the group
`continuation.homotopies` (classes, and what their functions are annotated to return), the classes that the fields of
those are annotated with, and what the caller passes. Functions are trusted only where the caller passes them.
"""

from __future__ import annotations

import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from importlib import metadata
from typing import Any

import attrs
import numpy as np
import scipy.sparse as sp

from continuation import budget, controllers, correctors, events, metric, predictors, stability, tolerance
from continuation.archive.codec import UnstorableError, path_of
from continuation.curves import curve, family
from continuation.evaluation import functions
from continuation.events import box, branch_point

ENTRY_POINTS = "continuation.homotopies"

_MODULES = (
    *(budget, controllers, correctors, curve, events, box, branch_point),
    *(family, functions, metric, predictors, stability, tolerance),
)


class UnknownError(LookupError):
    """A stored description that is not turned into an object; the message says why."""


def registry(trust: Iterable[Any] = ()) -> dict[str, Any]:
    """What may be made by name: the parts of the library, and what the caller trusts.

    Raises `TypeError` if something else is to be trusted, or a thing that has no name to be found by.
    """
    found = {}
    for module in _MODULES:
        for thing in vars(module).values():
            if isinstance(thing, type) and attrs.has(thing):
                found[f"{thing.__module__}:{thing.__qualname__}"] = thing
    for thing in trust:
        if not callable(thing):
            raise TypeError(f"trust: expected classes and functions, found {thing!r}")
        try:
            found[path_of(thing)] = thing
        except UnstorableError as error:
            raise TypeError(f"trust: expected something that an archive can name; {error}") from None
    return found


def is_registered(path: str) -> bool:
    """Whether an installed package registers ``module:class``, so that it needs no trust of the caller's."""
    return _registered(path) is not None


@lru_cache
def _registered(path: str) -> type | None:
    """The class of that path, if it is a homotopy's that an installed package registers, or of its metric."""
    points = metadata.entry_points(group=ENTRY_POINTS)
    for point in sorted(points, key=lambda point: point.value != path):
        try:
            thing = point.load()
        except Exception:
            continue
        hint = thing if isinstance(thing, type) else _hints(thing).get("return")
        for cls in typing.get_args(hint) if isinstance(hint, types.UnionType) else (typing.get_origin(hint) or hint,):
            # A homotopy's own metric is as much a part of its package as the homotopy.
            for found in (cls, type(getattr(cls, "metric", None))):
                if isinstance(found, type) and f"{found.__module__}:{found.__qualname__}" == path:
                    return found
    return None


def decode(tree: Any, fetch: Callable[[Any], Any], known: Mapping[str, Any] | None = None, hint: Any = Any) -> Any:
    """The value that `continuation.archive.codec.encode` described.

    `tree`: JSON. `fetch`: Turns what `place` returned back into an array. `known`: The `registry`; by default nothing
    but what `hint` names. `hint`: What is expected: the value is checked against it, and the classes in it may be made.
    Raises `UnknownError` if a class or function is not trusted, a value is not of its field's type, or the description
    makes no sense.
    """
    try:
        value = _decode(tree, fetch, known or {}, hint)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError, RecursionError) as error:
        raise UnknownError(f"the description makes no sense ({type(error).__name__}: {error})") from None
    if not _fits(value, hint):
        raise UnknownError(f"expected {_shown(hint)}, found {type(value).__name__}")
    return value


def _decode(tree: Any, fetch: Callable[[Any], Any], known: Mapping[str, Any], hint: Any) -> Any:
    if tree is None or isinstance(tree, (bool, int, float, str)):
        return tree
    if "array" in tree:
        return fetch(tree["array"])
    for kind in ("tuple", "list"):
        if kind in tree:
            inner = _items(hint, len(tree[kind]))
            items = [_decode(item, fetch, known, of) for item, of in zip(tree[kind], inner)]
            return tuple(items) if kind == "tuple" else items
    if "dict" in tree:
        return {key: _decode(item, fetch, known, Any) for key, item in tree["dict"].items()}
    if "sparse" in tree:
        return _sparse(tree, fetch)
    if "function" in tree:
        if tree["function"] not in known:
            raise UnknownError(f"{tree['function']} is a function, which is not trusted: pass it in trust=[...]")
        return known[tree["function"]]
    return _object(tree, fetch, known, hint)


def _object(tree: Any, fetch: Callable[[Any], Any], known: Mapping[str, Any], hint: Any) -> Any:
    path = tree["class"]
    name = path.partition(":")[2]
    # A class that a field is annotated with is found by its name: it may have moved to another module since.
    named = (cls for cls in _classes(hint) if cls.__qualname__ == name)
    cls = next(named, None) or known.get(path) or (_registered(path) if known else None)
    if not isinstance(cls, type):
        raise UnknownError(f"{path} is not registered: pass it in trust=[...]")
    if "data" in tree:
        make = getattr(cls, "from_archive", None)
        if make is None:
            raise UnknownError(f"{path} has no from_archive any more")
        return make(_decode(tree["data"], fetch, known, Any))
    hints = _hints(cls)
    kinds = {a.alias: hints.get(a.name, Any) for a in attrs.fields(cls) if a.init} if attrs.has(cls) else {}
    fields = {key: _decode(item, fetch, known, kinds.get(key, Any)) for key, item in tree["fields"].items()}
    for key, value in fields.items():
        if key not in kinds:
            raise UnknownError(f"{path} has no field {key} any more")
        if not _fits(value, kinds[key]):
            raise UnknownError(f"{path}: {key} expected {_shown(kinds[key])}, found {type(value).__name__}")
    if hasattr(cls, "__attrs_init__"):
        # A class with a constructor of its own for people, which completes and checks what is complete here.
        made: Any = object.__new__(cls)
        made.__attrs_init__(**fields)
        return made
    return cls(**fields)


def _sparse(tree: Any, fetch: Callable[[Any], Any]) -> Any:
    make = sp.csr_array if tree["sparse"] == "csr" else sp.csc_array
    matrix = make((fetch(tree["data"]), fetch(tree["indices"]), fetch(tree["indptr"])), shape=tuple(tree["shape"]))
    # Indices outside the shape would corrupt memory at the first product.
    matrix.check_format(full_check=True)
    return matrix


# -- types ----------------------------------------------------------------------------------------------------


def _hints(thing: Any) -> dict[str, Any]:
    """The annotations; none where they cannot be evaluated, as with names imported for type checkers only."""
    try:
        return typing.get_type_hints(thing)
    except (NameError, TypeError, AttributeError):
        return {}


def _items(hint: Any, count: int) -> tuple[Any, ...]:
    """The types of a container's items."""
    for option in _options(hint):
        arguments = typing.get_args(option)
        if typing.get_origin(option) is tuple and len(arguments) == count and ... not in arguments:
            return arguments
        if typing.get_origin(option) in (tuple, list, Sequence):
            return (arguments[0] if arguments else Any,) * count
    return (Any,) * count


def _options(hint: Any) -> tuple[Any, ...]:
    """The members of a union, or the type itself."""
    union = typing.get_origin(hint) in (typing.Union, types.UnionType)
    return tuple(o for a in typing.get_args(hint) for o in _options(a)) if union else (hint,)


def _classes(hint: Any) -> list[type]:
    """The attrs classes among what is expected."""
    found = (typing.get_origin(option) or option for option in _options(hint))
    return [cls for cls in found if isinstance(cls, type) and attrs.has(cls)]


def _fits(value: Any, hint: Any) -> bool:
    return any(_is(value, option) for option in _options(hint))


def _is(value: Any, hint: Any) -> bool:
    origin, arguments = typing.get_origin(hint) or hint, typing.get_args(hint)
    if origin is typing.Literal:
        return value in arguments
    if origin in (typing.ClassVar, typing.Final):
        return _fits(value, arguments[0])
    if origin is np.ndarray:
        return isinstance(value, np.ndarray) and value.dtype.kind in "fiubc"
    if origin in (tuple, list) and arguments:
        if not isinstance(value, origin):
            return False
        fixed = origin is tuple and ... not in arguments
        kinds = _items(hint, len(value))
        return (not fixed or len(value) == len(arguments)) and all(map(_fits, value, kinds))
    if origin in (float, int):
        return isinstance(value, (int, origin)) and not isinstance(value, bool)
    if hint is None:
        return value is None
    if getattr(origin, "_is_protocol", False) and not getattr(origin, "_is_runtime_protocol", False):
        return not isinstance(value, (str, int, float, dict, list, tuple, type(None)))
    # A type variable, or what only a type checker knows: numbers, containers and trusted objects are all there is.
    return not isinstance(origin, type) or origin is Any or isinstance(value, origin)


def _shown(hint: Any) -> str:
    return hint.__name__ if isinstance(hint, type) else str(hint)
