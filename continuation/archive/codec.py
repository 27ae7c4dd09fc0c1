"""Objects as JSON and back: attrs classes by class path and fields, arrays put where the caller wants them."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping
from types import BuiltinFunctionType, FunctionType
from typing import Any, Protocol, runtime_checkable

import attrs
import numpy as np
import scipy.sparse as sp

Place = Callable[[str, Any], Any]
"""(name, array) -> the JSON that stands for the array."""


@runtime_checkable
class SupportsArchive(Protocol):
    """A homotopy that says itself what an archive must hold of it; without it attrs fields are stored, if it has them.

    The classmethod ``from_archive(data)`` takes the same mapping and returns an equal homotopy.
    """

    def archive_data(self) -> dict[str, Any]:
        """Arrays, scalars and strings by name."""
        ...

    @classmethod
    def from_archive(cls, data: Mapping[str, Any]) -> Any:
        """The homotopy again.

        Parameters
        ----------
        data : mapping of str to object
            What `archive_data` returned, as the file gives it back.
        """
        ...


class UnstorableError(TypeError):
    """An object that cannot be written as class path and fields; the message says which and why."""


class UnknownError(LookupError):
    """A stored description that cannot be turned into an object again; the message says why."""


def path_of(thing: Any) -> str:
    """``module:name`` of a class or function that can be imported under that name.

    Raises
    ------
    UnstorableError
        For one that is local to a function, made by lambda, or defined in a script.
    """
    module, name = getattr(thing, "__module__", None), getattr(thing, "__qualname__", None)
    if not isinstance(module, str) or not isinstance(name, str):
        raise UnstorableError(f"{thing!r} has no name to import it by")
    if module == "__main__":
        raise UnstorableError(f"{name} is defined in a script, not in a module")
    found: Any = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    if found is not thing:
        raise UnstorableError(f"{module}:{name} is not at the top of a module")
    return f"{module}:{name}"


def resolve(path: str) -> Any:
    """The class or function of ``module:name``; imports the module.

    Raises
    ------
    UnknownError
        If there is none by that name.
    """
    module, _, name = path.partition(":")
    try:
        found: Any = importlib.import_module(module)
        for part in name.split("."):
            found = getattr(found, part)
    except (ImportError, AttributeError, ValueError) as error:
        raise UnknownError(f"{path} cannot be imported ({error})") from None
    return found


def encode(value: Any, place: Place, name: str = "value") -> Any:
    """JSON for a value; see the module's first line.

    Raises
    ------
    UnstorableError
        If some part of it is neither number, text, container, array, attrs class, importable function nor
        `SupportsArchive`.
    """
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value)
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "fiubc":
            raise UnstorableError(f"{name} is an array of {value.dtype}")
        return {"array": place(name, value)}
    if isinstance(value, (tuple, list)):
        items = [encode(item, place, f"{name}_{i}") for i, item in enumerate(value)]
        return {"list" if isinstance(value, list) else "tuple": items}
    if isinstance(value, Mapping):
        return {"dict": {str(key): encode(item, place, str(key)) for key, item in value.items()}}
    if sp.issparse(value):
        return _encode_sparse(value, place, name)
    if isinstance(value, (FunctionType, BuiltinFunctionType, type)):
        return {"function": path_of(value)}
    return _encode_object(value, place, name)


def _encode_sparse(value: Any, place: Place, name: str) -> Any:
    matrix = value if value.format in ("csr", "csc") else value.tocsr()
    parts = {part: place(f"{name}_{part}", getattr(matrix, part)) for part in ("data", "indices", "indptr")}
    return {"sparse": matrix.format, "shape": [int(n) for n in matrix.shape], **parts}


def _encode_object(value: Any, place: Place, name: str) -> Any:
    cls = type(value)
    path = path_of(cls)
    if isinstance(value, SupportsArchive):
        return {"class": path, "data": encode(value.archive_data(), place, name)}
    if attrs.has(cls):
        fields = {a.alias: encode(getattr(value, a.name), place, a.alias) for a in attrs.fields(cls) if a.init}
        return {"class": path, "fields": fields}
    # A plain class without any state of its own; one of C's, which hides its state, has no __dict__ at all.
    if getattr(value, "__dict__", None) == {} and not any(getattr(c, "__slots__", ()) for c in cls.__mro__):
        return {"class": path, "fields": {}}
    raise UnstorableError(f"{path} has neither archive_data nor attrs fields")


def decode(tree: Any, fetch: Callable[[Any], Any]) -> Any:
    """The value again; `fetch` turns what `place` returned back into an array.

    Only attrs classes, classes with ``from_archive`` and classes without state are made; the module is imported for it.

    Raises
    ------
    UnknownError
        If a class or function is not there any more, or does not take its fields.
    """
    if isinstance(tree, list) or tree is None or isinstance(tree, (bool, int, float, str)):
        return tree
    if "array" in tree:
        return fetch(tree["array"])
    if "tuple" in tree:
        return tuple(decode(item, fetch) for item in tree["tuple"])
    if "list" in tree:
        return [decode(item, fetch) for item in tree["list"]]
    if "dict" in tree:
        return {key: decode(item, fetch) for key, item in tree["dict"].items()}
    if "sparse" in tree:
        make = sp.csr_array if tree["sparse"] == "csr" else sp.csc_array
        return make((fetch(tree["data"]), fetch(tree["indices"]), fetch(tree["indptr"])), shape=tuple(tree["shape"]))
    if "function" in tree:
        return resolve(tree["function"])
    if "class" in tree:
        return _decode_object(tree, fetch)
    raise UnknownError(f"cannot read the description {str(tree)[:80]}")


def _decode_object(tree: Any, fetch: Callable[[Any], Any]) -> Any:
    path = tree["class"]
    cls = resolve(path)
    if not isinstance(cls, type):
        raise UnknownError(f"{path} is no class")
    if "data" in tree:
        make = getattr(cls, "from_archive", None)
        if make is None:
            raise UnknownError(f"{path} has no from_archive any more")
        return make(decode(tree["data"], fetch))
    fields = {key: decode(item, fetch) for key, item in tree["fields"].items()}
    if fields and not attrs.has(cls):
        raise UnknownError(f"{path} is no attrs class any more")
    try:
        if hasattr(cls, "__attrs_init__"):
            # A class with a constructor of its own for people, which completes and checks what is complete here.
            made: Any = object.__new__(cls)
            made.__attrs_init__(**fields)
            return made
        return cls(**fields)
    except (TypeError, ValueError) as error:
        raise UnknownError(f"{path} does not take its stored fields ({error})") from None


def order(array: Any) -> str:
    """How a matrix lies in memory: "F" or "C". BLAS sums in another order for the one than for the other."""
    return "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"


def inline(name: str, array: Any) -> Any:
    """Place an array in the JSON itself: small ones with their values, to be read by people, large ones by shape."""
    if array.size <= 64 and array.dtype.kind != "c":
        return {"dtype": array.dtype.str, "values": array.tolist()}
    return {"dtype": array.dtype.str, "shape": list(array.shape)}
