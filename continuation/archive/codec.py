"""Objects as JSON: attrs classes by class path and fields; `trust` is the inverse."""

from __future__ import annotations

import json
import sys
import zlib
from collections.abc import Callable, Mapping
from types import BuiltinFunctionType, FunctionType
from typing import Any, Literal, Protocol, runtime_checkable

import attrs
import h5py
import numpy as np
import scipy.sparse as sp
from h5py import h5a, h5s, h5t

from continuation.archive.checks import DamageError, digest
from continuation.archive.hdf5 import Allowance, dataset

GROUP = "problem"


def problem_data(homotopy: Any) -> tuple[str, dict[str, Any]]:
    """JSON and arrays of the homotopy, or why it is "unstorable"."""
    arrays: dict[str, Any] = {}
    names: dict[int, str] = {}

    def place(name: str, array: Any) -> str:
        # An array that occurs twice is stored once.
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


def set_attributes(thing: Any, attributes: Mapping[str, Any]) -> None:
    """Create attributes, several times faster than h5py."""
    kind, one = h5t.py_create(h5py.string_dtype(), logical=True), h5s.create(h5s.SCALAR)
    for name, value in attributes.items():
        if isinstance(value, str):
            h5a.create(thing.id, name.encode(), kind, one).write(np.array(value.encode(), dtype=object))
        else:
            thing.attrs[name] = value


def write_problem(file: Any, description: str, arrays: Mapping[str, Any]) -> None:
    """Write the problem group."""
    group = file.create_group(GROUP)
    set_attributes(group, {"description": description, "checksum": np.uint32(zlib.crc32(description.encode()))})
    write_arrays(group, arrays)


def write_arrays(group: Any, arrays: Mapping[str, Any]) -> None:
    """Write arrays with checksums."""
    for name, array in arrays.items():
        stored = group.create_dataset(name, data=array)
        set_attributes(stored, {"order": order(array), "checksum": np.uint32(digest(array))})


def read_arrays(group: Any, allowance: Allowance) -> dict[str, Any]:
    """Arrays, checked."""
    arrays = {}
    for name in group:
        found = dataset(group, name, None, None, allowance)
        lying: Literal["C", "F"] = "F" if found.attrs.get("order") == "F" else "C"
        arrays[name] = np.asarray(found[()], order=lying)
        if digest(arrays[name]) != found.attrs["checksum"]:
            raise DamageError(f"the array {name} of its {group.name} is not what was written")
    return arrays


def read_problem(group: Any, allowance: Allowance) -> tuple[str, Mapping[str, Any]]:
    """Description and arrays, checked."""
    if group is None:
        return json.dumps({"unstorable": "the file holds no problem"}), {}
    description = str(group.attrs["description"])
    if zlib.crc32(description.encode(errors="replace")) != group.attrs["checksum"]:
        raise DamageError("the description of its problem is not what was written")
    return description, read_arrays(group, allowance)


Place = Callable[[str, Any], Any]
"""JSON in place of an array, from name and array."""


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


def order(array: Any) -> str:
    """Memory order, "F" or "C": it decides BLAS's round-off."""
    return "F" if array.flags.f_contiguous and not array.flags.c_contiguous else "C"


def inline(name: str, array: Any) -> Any:
    """A small array as JSON with values, a large one as its shape."""
    if array.size <= 64 and array.dtype.kind != "c":
        return {"dtype": array.dtype.str, "values": array.tolist()}
    return {"dtype": array.dtype.str, "shape": list(array.shape)}
