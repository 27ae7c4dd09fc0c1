"""The problem's own arrays in the group `/problem`, so that a file can be resumed without anything else."""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from continuation.archive.checks import DamageError, digest
from continuation.archive.codec import UnstorableError, encode, order
from continuation.archive.datasets import Allowance, dataset, names

GROUP = "problem"


def problem_data(homotopy: Any) -> tuple[str, dict[str, Any]]:
    """The homotopy's description as JSON, and its arrays by name.

    One that cannot be stored is described by the reason, under "unstorable".
    """
    arrays: dict[str, Any] = {}
    names: dict[int, str] = {}

    def place(name: str, array: Any) -> str:
        # What occurs twice, as the matrix of a problem that two parts refer to, is stored once.
        if id(array) not in names:
            names[id(array)] = name if name not in arrays else f"{name}_{len(arrays)}"
            arrays[names[id(array)]] = array
        return names[id(array)]

    try:
        tree = encode(homotopy, place)
    except UnstorableError as error:
        return json.dumps({"unstorable": str(error)}), {}
    return json.dumps(tree), arrays


def write_problem(file: Any, description: str, arrays: Mapping[str, Any]) -> None:
    """Put them into a new file."""
    group = file.create_group(GROUP)
    group.attrs["description"] = description
    group.attrs["checksum"] = np.uint32(zlib.crc32(description.encode()))
    for name, array in arrays.items():
        stored = group.create_dataset(name, data=array)
        stored.attrs["order"] = order(array)
        stored.attrs["checksum"] = np.uint32(digest(array))


def read_problem(group: Any, checked: bool, allowance: Allowance) -> tuple[str, Mapping[str, Any]]:
    """The same two things, from a file; no description where it has none; `ValueError` where they were changed."""
    if group is None:
        return json.dumps({"unstorable": "the file holds no problem"}), {}
    description = str(group.attrs["description"])
    if checked and zlib.crc32(description.encode(errors="replace")) != group.attrs["checksum"]:
        raise DamageError("the description of its problem is not what was written")
    arrays = {}
    for name in names(group):
        found = dataset(group, name, None, None, allowance)
        lying: Literal["C", "F"] = "F" if found.attrs["order"] == "F" else "C"
        arrays[name] = np.asarray(found[()], order=lying)
        if checked and digest(arrays[name]) != found.attrs["checksum"]:
            raise DamageError(f"the array {name} of its problem is not what was written")
    return description, arrays
