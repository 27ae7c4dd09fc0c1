"""The problem's own arrays in the group `/problem`, so that a file can be resumed without anything else."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from continuation.archive.codec import UnstorableError, encode, order

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


def write_problem(file: Any, description: str, arrays: dict[str, Any]) -> None:
    """Put them into a new file."""
    group = file.create_group(GROUP)
    group.attrs["description"] = description
    for name, array in arrays.items():
        group.create_dataset(name, data=array).attrs["order"] = order(array)


def read_problem(file: Any) -> tuple[str, dict[str, Any]]:
    """The same two things, from a file; no description where it has none."""
    if GROUP not in file:
        return json.dumps({"unstorable": "the file holds no problem"}), {}
    group = file[GROUP]
    arrays = {name: np.asarray(group[name][()], order=group[name].attrs["order"]) for name in group}
    return str(group.attrs["description"]), arrays
