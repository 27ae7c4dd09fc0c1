"""Objects as JSON: attrs classes by class path and fields; and objects from JSON, of trusted classes only.

Trusted are the library's parts, homotopies that packages register (entry points `continuation.homotopies`), classes in
annotations of their fields, and the caller's `trust`, which functions need.
"""

from __future__ import annotations

import json
import sys
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from importlib import metadata
from types import BuiltinFunctionType, FunctionType
from typing import Any, Protocol, runtime_checkable

import attrs
import numpy as np
import scipy.sparse as sp

from continuation import budget, controllers, correctors, events, metric, predictors, stability, tolerance
from continuation.curves import curve, family
from continuation.evaluation import functions
from continuation.events import box, branch_point


def problem_data(homotopy: Any) -> tuple[str, dict[str, Any]]:
    """JSON and arrays of the homotopy, or why it is "unstorable"."""
    arrays: dict[str, Any] = {}
    names: dict[int, str] = {}

    def place(name: str, array: Any) -> str:
        if id(array) not in names:
            names[id(array)] = name if name not in arrays else f"{name}_{len(arrays)}"
            arrays[names[id(array)]] = array
        return names[id(array)]

    return json.dumps(described(homotopy, place)), arrays


def described(value: Any, place: Place) -> Any:
    """JSON for a value, or why it is "unstorable"."""
    try:
        return encode(value, place)
    except UnstorableError as error:
        return {"unstorable": str(error)}


Place = Callable[[str, Any], Any]
"""Stores an array by name; returns JSON in its place."""


@runtime_checkable
class SupportsArchive(Protocol):
    """A homotopy that chooses its stored data; otherwise attrs fields are stored.

    ``from_archive(data)`` returns an equal homotopy.
    """

    def archive_data(self) -> dict[str, Any]:
        """Arrays, scalars and strings by name."""
        ...

    @classmethod
    def from_archive(cls, data: Mapping[str, Any]) -> Any:
        """Rebuild the homotopy.

        Parameters
        ----------
        data : mapping of str to object
            As `archive_data` returned it.
        """
        ...


class UnstorableError(TypeError):
    """An object that JSON cannot describe."""


def path_of(thing: Any) -> str:
    """``module:name`` of a class or function."""
    module, name = str(getattr(thing, "__module__", None)), str(getattr(thing, "__qualname__", repr(thing)))
    found: Any = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    if module == "__main__" or found is not thing:
        where = "is defined in a script" if module == "__main__" else f"is not found in {module}"
        raise UnstorableError(f"{name} has no name to import it by: it {where}")
    return f"{module}:{name}"


def encode(value: Any, place: Place, name: str = "value") -> Any:
    """JSON for a value; `place` stores arrays.

    Raises `UnstorableError` except for numbers, texts, containers, arrays, attrs classes, importable functions and
    `SupportsArchive`.
    """
    value = value.item() if isinstance(value, np.generic) else value
    match value:
        case None | str() | bool() | int() | float():
            return value
        case np.ndarray() if value.dtype.kind in "fiubc":
            return {"array": place(name, value)}
        case np.ndarray():
            raise UnstorableError(f"{name} is an array of {value.dtype}")
        case tuple() | list():
            items = [encode(item, place, f"{name}_{i}") for i, item in enumerate(value)]
            return {"list" if isinstance(value, list) else "tuple": items}
        case Mapping():
            return {"dict": {str(key): encode(item, place, str(key)) for key, item in value.items()}}
        case FunctionType() | BuiltinFunctionType() | type():
            return {"function": path_of(value)}
        case _ if sp.issparse(value):
            matrix = value if value.format in ("csr", "csc") else value.tocsr()
            parts = {part: place(f"{name}_{part}", getattr(matrix, part)) for part in ("data", "indices", "indptr")}
            return {"sparse": matrix.format, "shape": [int(n) for n in matrix.shape], **parts}
    return _encode_object(value, place, name)


def _encode_object(value: Any, place: Place, name: str) -> Any:
    cls = type(value)
    path = path_of(cls)
    if isinstance(value, SupportsArchive):
        return {"class": path, "data": encode(value.archive_data(), place, name)}
    if attrs.has(cls):
        fields = {a.alias: encode(getattr(value, a.name), place, a.alias) for a in attrs.fields(cls) if a.init}
        return {"class": path, "fields": fields}
    # Extension classes may hide state, but have no __dict__.
    if getattr(value, "__dict__", None) == {} and not any(getattr(c, "__slots__", ()) for c in cls.__mro__):
        return {"class": path, "fields": {}}
    raise UnstorableError(f"{path} has neither archive_data nor attrs fields")


def inline(name: str, array: Any) -> Any:
    """A small array as JSON with values, a large one as its shape."""
    if array.size <= 64 and array.dtype.kind != "c":
        return {"dtype": array.dtype.str, "values": array.tolist()}
    return {"dtype": array.dtype.str, "shape": list(array.shape)}


ENTRY_POINTS = "continuation.homotopies"

_MODULES = (
    *(budget, controllers, correctors, curve, events, box, branch_point),
    *(family, functions, metric, predictors, stability, tolerance),
)


class UnknownError(LookupError):
    """A description that yields no object."""


def registry(trust: Iterable[Any] = ()) -> dict[str, Any]:
    """Objects that may be made, by path; `TypeError` for other than importable classes and functions."""
    things = [thing for module in _MODULES for thing in vars(module).values()]
    parts = [thing for thing in things if isinstance(thing, type) and attrs.has(thing)]
    found: dict[str, Any] = {class_path(part): part for part in parts}
    for thing in trust:
        try:
            found[path_of(thing)] = thing
        except UnstorableError as error:
            raise TypeError(f"trust: expected classes and functions that an archive can name; {error}") from None
    return found


@lru_cache
def _registered(path: str) -> type | None:
    points = metadata.entry_points(group=ENTRY_POINTS)
    for point in sorted(points, key=lambda point: point.value != path):
        try:
            thing = point.load()
        except Exception:
            continue
        made = _options(thing if isinstance(thing, type) else _hints(thing).get("return"))
        classes = [typing.get_origin(option) or option for option in made]
        for found in (*classes, *(type(getattr(cls, "metric", None)) for cls in classes)):
            if isinstance(found, type) and class_path(found) == path:
                return found
    return None


def class_path(cls: type) -> str:
    """``module:class``."""
    return f"{cls.__module__}:{cls.__qualname__}"


def decode(tree: Any, fetch: Callable[[Any], Any], known: Mapping[str, Any] | None = None, hint: Any = Any) -> Any:
    """The value described by `encode`.

    `fetch`: from what `place` returned to the array. `known`: the `registry`. `hint`: the expected type, whose classes
    are trusted. Raises `UnknownError` if a class is not trusted or a value has another type.
    """
    try:
        return _decode(tree, fetch, known or {}, hint, "")
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, OverflowError, RecursionError) as error:
        raise UnknownError(f"the description makes no sense ({type(error).__name__}: {error})") from None


def _decode(tree: Any, fetch: Callable[[Any], Any], known: Mapping[str, Any], hint: Any, name: str) -> Any:
    value: Any
    match tree:
        case None | bool() | int() | float() | str():
            value = tree
        case {"array": place}:
            value = fetch(place)
        case {"tuple": items}:
            value = tuple(_decode(item, fetch, known, of, name) for item, of in zip(items, _items(hint, len(items))))
        case {"list": items}:
            value = [_decode(item, fetch, known, of, name) for item, of in zip(items, _items(hint, len(items)))]
        case {"dict": items}:
            value = {key: _decode(item, fetch, known, Any, name) for key, item in items.items()}
        case {"sparse": form}:
            parts = tuple(fetch(tree[part]) for part in ("data", "indices", "indptr"))
            value = (sp.csr_array if form == "csr" else sp.csc_array)(parts, shape=tuple(tree["shape"]))
            # Indices outside the shape would corrupt memory.
            value.check_format(full_check=True)
        case {"function": path}:
            if path not in known:
                raise UnknownError(f"{path} is a function, which is not trusted: pass it in trust=[...]")
            value = known[path]
        case _:
            value = _object(tree, fetch, known, hint)
    if not _fits(value, hint):
        shown = hint.__name__ if isinstance(hint, type) else str(hint)
        raise UnknownError(f"{name}expected {shown}, found {type(value).__name__}")
    return value


def _object(tree: Any, fetch: Callable[[Any], Any], known: Mapping[str, Any], hint: Any) -> Any:
    path = tree["class"]
    expected = (typing.get_origin(option) or option for option in _options(hint))
    # The class may have moved to another module.
    named = (c for c in expected if isinstance(c, type) and attrs.has(c) and c.__qualname__ == path.partition(":")[2])
    cls: type[Any] | None = next(named, None) or known.get(path) or (_registered(path) if known else None)
    if not isinstance(cls, type):
        raise UnknownError(f"{path} is not registered: pass it in trust=[...]")
    if "data" in tree:
        return cls.from_archive(_decode(tree["data"], fetch, known, Any, ""))
    hints = _hints(cls)
    kinds = {a.alias: hints.get(a.name, Any) for a in attrs.fields(cls) if a.init} if attrs.has(cls) else {}
    if set(tree["fields"]) - set(kinds):
        raise UnknownError(f"{path} has no field {', '.join(set(tree['fields']) - set(kinds))} any more")
    fields = {key: _decode(item, fetch, known, kinds[key], f"{path}: {key} ") for key, item in tree["fields"].items()}
    if not hasattr(cls, "__attrs_init__"):
        return cls(**fields)
    # The fields are complete: no constructor.
    made: Any = object.__new__(cls)
    made.__attrs_init__(**fields)
    return made


def _hints(thing: Any) -> dict[str, Any]:
    try:
        return typing.get_type_hints(thing)
    except (NameError, TypeError, AttributeError):
        return {}


def _items(hint: Any, count: int) -> tuple[Any, ...]:
    for option in _options(hint):
        arguments = typing.get_args(option)
        if typing.get_origin(option) is tuple and len(arguments) == count and ... not in arguments:
            return arguments
        if typing.get_origin(option) in (tuple, list, Sequence):
            return (arguments[0] if arguments else Any,) * count
    return (Any,) * count


def _options(hint: Any) -> tuple[Any, ...]:
    union = typing.get_origin(hint) in (typing.Union, types.UnionType)
    return tuple(o for a in typing.get_args(hint) for o in _options(a)) if union else (hint,)


def _fits(value: Any, hint: Any) -> bool:
    return any(_is(value, option) for option in _options(hint))


def _is(value: Any, hint: Any) -> bool:
    origin, arguments = typing.get_origin(hint) or hint, typing.get_args(hint)
    if origin is typing.Literal:
        return value in arguments
    if origin is np.ndarray:
        return isinstance(value, np.ndarray) and value.dtype.kind in "fiubc"
    if origin in (tuple, list) and arguments:
        fixed = origin is tuple and ... not in arguments
        sized = isinstance(value, origin) and (not fixed or len(value) == len(arguments))
        return sized and all(map(_fits, value, _items(hint, len(value))))
    if origin in (float, int, None):
        return value is None if hint is None else isinstance(value, (int, origin)) and not isinstance(value, bool)
    if getattr(origin, "_is_protocol", False) and not getattr(origin, "_is_runtime_protocol", False):
        return not isinstance(value, (str, int, float, dict, list, tuple, type(None)))
    # Types that only a type checker knows accept every value.
    return not isinstance(origin, type) or origin is Any or isinstance(value, origin)
