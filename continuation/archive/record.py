"""A finished path as a row of the path table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from operator import attrgetter
from typing import Any

import numpy as np

from continuation.archive.provenance import class_path, scalars
from continuation.archive.schema import COUNT_NAMES, Layout, text
from continuation.path import Path
from continuation.step.tracer import Tracer

counted = attrgetter(*COUNT_NAMES)
"""The counters of `Counts` as a tuple, in the order of `COUNT_NAMES`."""

Record = dict[str, Any]
"""The cells of a row by column name; the homotopy's scalars are one mapping under "scalars"."""


def of_path(path: Path, homotopy: Any, controller: tuple[float, ...]) -> Record:
    """What the path itself says."""
    return {
        **{COUNT_NAMES[name]: value for name, value in zip(COUNT_NAMES, counted(path.counts))},
        "status": int(path.status),
        "message": path.message,
        "seed": _seed(homotopy),
        "wall_time": path.seconds,
        "end_error": math.nan if path.end_error is None else path.end_error,
        "winding_number": path.winding_number or 0,
        "controller_state": controller,
        "scalars": scalars(homotopy),
        "homotopy": "" if homotopy is None else class_path(homotopy),
        "source": "",
    }


def to_columns(record: Mapping[str, Any], layout: Layout) -> dict[str, Any]:
    """The row as a block: each column an array of length 1."""
    block: dict[str, Any] = {}
    for column in layout.path_columns:
        if column.name == "controller_state":
            state = np.full((1, layout.controller), math.nan)
            kept = record[column.name][: layout.controller]
            state[0, : len(kept)] = kept
            block[column.name] = state
        elif column.name.startswith("homotopy_"):
            value = record["scalars"].get(column.name.removeprefix("homotopy_"), math.nan)
            block[column.name] = np.array([value])
        else:
            value = record[column.name]
            cell = text(value, column.length) if column.length else value
            block[column.name] = np.array([cell], dtype=column.storage)
    return block


def _seed(homotopy: Any) -> int:
    seed = getattr(homotopy, "seed", None)
    return int(seed) if isinstance(seed, (int, np.integer)) and abs(int(seed)) < 2**63 else -1


def unknowns_of(tracer: Tracer | None) -> int:
    """N, asked of the homotopy itself; 1 where it does not even have a start, since then nothing depends on it."""
    try:
        return 1 if tracer is None else int(np.size(tracer.homotopy.start()[0]))
    except Exception:
        return 1
