"""What a log holds in memory: rows that wait for a commit, the path being written; a finished path as a row."""

from __future__ import annotations

import math
from collections.abc import Mapping
from operator import attrgetter
from typing import Any

import numpy as np
from attrs import define, field, frozen

from continuation.archive.provenance import class_path, scalars
from continuation.archive.rows import Row
from continuation.archive.schema import COUNT_NAMES, Layout, text
from continuation.arguments.checks import integer, number
from continuation.path import Path, Step
from continuation.step.state import State
from continuation.step.tracer import Tracer


@frozen(eq=False)
class Mark:
    """A point to resume from: the state, the counters there, and how many rows of the path come before it."""

    state: State
    counts: tuple[int, ...]
    rows: int


@define(eq=False)
class Buffer:
    """Rows not yet committed, and the number of the first: one object, so that a commit is one assignment."""

    start: int
    rows: list[Row] = field(factory=list)
    nbytes: int = 0


@define(eq=False)
class OpenPath:
    """The path being written."""

    tracer: Tracer
    number: int
    rows: int = 0
    seconds: float = 0.0
    run: bytes | None = None
    last: Mark | None = None
    resume: Mark | None = None
    skipped: Step | None = None


@frozen
class Limits:
    """When buffered rows are committed: at so many rows, bytes of points, or seconds since the last commit."""

    rows: int = field(default=256, validator=integer(1))
    nbytes: int = field(default=4 << 20, validator=integer(1))
    seconds: float = field(default=1.0, validator=number("at least 0", lambda x: x >= 0.0))


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
