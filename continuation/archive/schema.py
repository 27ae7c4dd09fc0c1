"""The schema `continuation-path-2`: names, types, units and meanings of everything in the two tables, and the datasets
that hold them, made all at once, as every netCDF-4 tool reads them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import h5py
import numpy as np
from attrs import field, frozen

from continuation.archive.checks import GROUP, RECORDS, blank
from continuation.archive.checks import width as width_of_sums
from continuation.counts import Counts
from continuation.status import Kind, Status

SCHEMA = "continuation-path-2"
"""Additions keep the name; a change of meaning would be `continuation-path-3`, which this reader refuses."""

UNCHECKED = "continuation-path-1"
"""The same tables without checksums: read as they are, since nothing tells what was written."""

TEXT = 240
"""Bytes (UTF-8) of a path's message."""

NAME = 64
"""Bytes (UTF-8) of an event's name."""

ACCEPTED, LOCATED, KINK_PART = 0, 1, 2
"""Roles of a row: an accepted step, an event located between two of them, or what belongs to the kink before it."""

NO_EVENT = -1
CONTROLLER_STATE = 4
"""Numbers kept of a controller's state at the end of a path, at least."""


@frozen
class Column:
    """A variable of the archive.

    `dtype` is numpy's; ``utf8:n`` is text of at most n bytes.
    """

    name: str
    dtype: str
    units: str
    long_name: str
    dimensions: tuple[str, ...] = ("point",)
    more: Mapping[str, Any] = field(factory=dict)

    @property
    def attributes(self) -> dict[str, Any]:
        """Units, long name and the rest, as the file has them."""
        return {"units": self.units, "long_name": self.long_name, **self.more}

    @property
    def length(self) -> int:
        """Bytes of a text; 0 for numbers."""
        return int(self.dtype.removeprefix("utf8:")) if self.dtype.startswith("utf8:") else 0

    @property
    def storage(self) -> np.dtype[Any]:
        """The type of an array that holds the column."""
        return np.dtype(f"S{self.length}" if self.length else self.dtype)

    @property
    def missing(self) -> Any:
        """What stands for a value that is not there: NaN, the empty text, -1."""
        if self.length:
            return b""
        return np.nan if self.storage.kind == "f" else -1


def _flags(names: tuple[str, ...], values: tuple[int, ...] | None = None) -> dict[str, Any]:
    numbers = range(len(names)) if values is None else values
    return {"flag_values": np.array(tuple(numbers), dtype="i1"), "flag_meanings": " ".join(names)}


COUNT_NAMES = {name: {"residuals": "evaluations"}.get(name, name) for name in Counts().as_dict()}
"""Counter of `Counts` -> column of the path table."""

_COUNT_MEANINGS = {
    "residuals": "evaluations of the residual",
    "jacobians": "evaluations of the derivative",
    "factorizations": "factorisations of a bordered matrix",
    "solves": "solves with a factorisation",
    "accepted": "accepted steps",
    "rejected": "rejected attempts at a step",
}

POINT_COLUMNS = (
    Column("path_index", "i4", "1", "number of the path of this point", more={"instance_dimension": "path"}),
    Column("arclength", "f8", "1", "arclength from the start, in the metric of the trace"),
    Column("parameter", "f8", "1", "continuation parameter lambda"),
    Column("y", "f8", "1", "unknowns", ("point", "component")),
    Column("step_length", "f8", "1", "step length of the predictor; NaN at located events"),
    Column("residual_norm", "f8", "1", "largest component of the residual"),
    Column("orientation", "i1", "1", "sign of the determinant of [H'; tangent']; 0 where it is unknown"),
    Column("kind", "i1", "1", "what the point is", more=_flags(tuple(kind.flag for kind in Kind))),
    Column(
        "role",
        "i1",
        "1",
        "accepted step, or event located between two steps",
        more=_flags(("accepted_step", "located_event", "kink_part"), (ACCEPTED, LOCATED, KINK_PART)),
    ),
    Column("event_index", "i2", "1", "number of the event in event_name; -1 where there is none"),
    Column("event_monitor", "f8", "1", "value of the event's monitor at the located point; NaN where there is none"),
    Column("corrector_iterations", "i2", "1", "iterations of the corrector; -1 at located events"),
    Column("rejections", "i2", "1", "rejected attempts before the accepted one; -1 at located events"),
    Column("contraction", "f8", "1", "ratio of the corrector's increments; NaN at located events"),
    Column("distance", "f8", "1", "length of the correction; NaN at located events"),
    Column("angle", "f8", "radian", "angle between this tangent and the one before; NaN at located events"),
    Column("parameter_share", "f8", "1", "the parameter's share of the tangent; NaN at located events"),
)

TANGENT_COLUMNS = (
    Column("tangent_y", "f8", "1", "unit tangent, components of the unknowns", ("point", "component")),
    Column("tangent_parameter", "f8", "1", "unit tangent, component of the parameter"),
)

KINK_COLUMNS = (
    Column("switch", "i4", "1", "number of a switching function that vanishes at the kink; -1 where there is none"),
)
"""In files of homotopies with pieces, which hold tangents too: those of the rows `kink_part` are the kink's rays."""

PATH_COLUMNS = (
    Column("path", "i8", "1", "number of the path", ("path",), {"cf_role": "trajectory_id"}),
    Column(
        "status",
        "i1",
        "1",
        "how the path ended",
        ("path",),
        _flags(tuple(s.flag for s in Status), tuple(int(s) for s in Status)),
    ),
    Column("message", f"utf8:{TEXT}", "1", "how the path ended, in words", ("path",)),
    Column("member", "i8", "1", "index of the homotopy in its sweep; the number of the path outside of one", ("path",)),
    Column("seed", "i8", "1", "seed of the homotopy's random numbers; -1 where there are none", ("path",)),
    Column("n_points", "i8", "1", "rows of this path in the point table", ("path",)),
    Column("wall_time", "f8", "s", "wall-clock time", ("path",)),
    *(Column(COUNT_NAMES[name], "i8", "1", _COUNT_MEANINGS.get(name, name), ("path",)) for name in COUNT_NAMES),
    Column("end_error", "f8", "1", "error estimate of the end point; NaN where there is none", ("path",)),
    Column("winding_number", "i4", "1", "winding number of a singular end; 0 where there is none", ("path",)),
    Column("controller_state", "f8", "1", "state of the step controller at the end", ("path", "controller")),
)

ORIGIN_COLUMNS = (
    Column("homotopy", "utf8:160", "1", "class of the homotopy", ("path",)),
    Column(
        "source",
        "utf8:160",
        "1",
        "identifier of the file that the path was written to, its number there, and the file's name then",
        ("path",),
    ),
)
"""A merged file keeps them for each path; files of before have none."""

EVENT_NAME = Column("event_name", f"utf8:{NAME}", "1", "name of the event", ("event",))
COMPONENT = Column("component", "i4", "1", "number of the unknown", ("component",))


@frozen
class Layout:
    """What one file holds besides the fixed columns.

    `unknowns`: N, one number a file. `controller`: Numbers in `controller_state`. `observed`: The homotopy's own
    scalars at each point: columns ``observed_<name>``. `scalars`: The homotopy's numeric parameters: columns
    ``homotopy_<name>``, one value a path. `pieces`: Whether kinks are held with their switches and rays. `origins`:
    Whether each path has its homotopy and its source.
    """

    unknowns: int
    controller: int = CONTROLLER_STATE
    observed: tuple[str, ...] = ()
    scalars: tuple[str, ...] = ()
    tangents: bool = False
    pieces: bool = False
    origins: bool = True

    @property
    def point_columns(self) -> tuple[Column, ...]:
        """The columns of the point table."""
        tangents = TANGENT_COLUMNS if self.tangents else ()
        kinks = KINK_COLUMNS if self.pieces else ()
        own = (Column(f"observed_{name}", "f8", "1", f"{name}, observed by the homotopy") for name in self.observed)
        return (*POINT_COLUMNS, *tangents, *kinks, *own)

    @property
    def path_columns(self) -> tuple[Column, ...]:
        """The columns of the path table."""
        own = (Column(f"homotopy_{s}", "f8", "1", f"parameter {s} of the homotopy", ("path",)) for s in self.scalars)
        return (*PATH_COLUMNS, *(ORIGIN_COLUMNS if self.origins else ()), *own)

    def width(self, column: Column) -> tuple[int, ...]:
        """The lengths of the column's dimensions beyond the first."""
        lengths = {"component": self.unknowns, "controller": self.controller}
        return tuple(lengths[name] for name in column.dimensions[1:])


def check_names(prefix: str, names: Iterable[str]) -> None:
    """Whether names can be those of columns ``<prefix><name>`` in a file that every tool reads.

    Raises `ValueError` if one is empty, longer than 100 bytes, not text, or holds a slash, a NUL or another control
    character.
    """
    for name in names:
        plain = isinstance(name, str) and name.isprintable() and "/" not in name and name == name.strip()
        if not plain or not 1 <= len(name.encode()) <= _COLUMN_NAME:
            wanted = f"names of 1 to {_COLUMN_NAME} bytes, of printable characters without a slash"
            raise ValueError(f"{prefix}: expected {wanted}, found {name!r:.60}")


_COLUMN_NAME = 100
"""netCDF allows 256 bytes a name, the prefix included."""


def text(value: str, length: int) -> bytes:
    """UTF-8 of at most `length` bytes, cut between characters."""
    raw = value.encode(errors="replace")
    return raw if len(raw) <= length else raw[:length].decode(errors="ignore").encode()


# -- datasets --------------------------------------------------------------------------------------------------


SLOTS = 2
RESUME = "resume"

_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"
_CHUNKS = {"point": 64, "path": 8, "event": 16}
_CHUNK_BYTES = 1 << 13
"""A chunk, of so many rows or bytes at most, takes its whole room from its first row on: with 512 KiB eight points of
100 unknowns take 600 KB."""


def chunk_rows(width: tuple[int, ...], most: int) -> int:
    """Rows a chunk, each of so many numbers: 8 KiB at most, a power of two."""
    fitting = max(_CHUNK_BYTES // (8 * max(math.prod(width), 1)), 1)
    return int(min(most, 1 << (fitting.bit_length() - 1)))


def build(file: Any, layout: Layout, compression: int) -> None:
    """Make all the datasets of a new file, without rows.

    `compression`: Level of gzip; 0 for none.
    """
    filters = {"compression": "gzip", "compression_opts": compression, "shuffle": True} if compression else {}

    def grows(name: str, dtype: Any, chunk: int, width: tuple[int, ...] = (), **more: Any) -> Any:
        shapes = {"shape": (0, *width), "maxshape": (None, *width), "chunks": (chunk, *width)}
        return file.create_dataset(name, dtype=dtype, **shapes, **more)

    # Dimensions without a variable, as netCDF knows them, and the two that have one.
    for name in ("point", "event"):
        grows(name, ">f4", _CHUNKS[name]).make_scale(_NO_VARIABLE.format(0))
    file.create_dataset("controller", (layout.controller,), ">f4").make_scale(_NO_VARIABLE.format(layout.controller))
    grows("path", "i8", _CHUNKS["path"]).make_scale("path")
    component = file.create_dataset("component", data=np.arange(layout.unknowns, dtype=COMPONENT.dtype))
    component.attrs.update(COMPONENT.attributes)
    component.make_scale("component")
    for column in (*layout.point_columns, *layout.path_columns, EVENT_NAME):
        width, length, own = layout.width(column), column.length, column.name in file
        if not own:
            dtype = h5py.string_dtype("utf-8", length) if length else column.dtype
            chunk = chunk_rows(width, _CHUNKS[column.dimensions[0]])
            grows(column.name, dtype, chunk, width, **({} if length else filters))
        file[column.name].attrs.update(column.attributes)
        for axis, dimension in enumerate(() if own else column.dimensions):
            file[column.name].dims[axis].attach_scale(file[dimension])
    for name, what in (("points", "rows of the point table"), ("paths", "rows of the path table")):
        counter = file.create_dataset(f"committed_{name}", (), "i8")
        counter.attrs.update({"units": "1", "long_name": f"valid {what}"})
    for table, columns, chunk in (("point", layout.point_columns, 16), ("path", layout.path_columns, _CHUNKS["path"])):
        grows(f"{GROUP}/{table}", "u4", chunk, (width_of_sums([column.name for column in columns]),))
    grows(f"{GROUP}/event", "u4", _CHUNKS["event"])
    file[GROUP].create_dataset(RECORDS, data=blank())
    slots = file.create_dataset(f"{RESUME}/slots", (SLOTS, 0), "u1", maxshape=(SLOTS, None), chunks=(1, 1 << 12))
    slots.attrs["long_name"] = "two alternating checkpoints: sequence u8, length u8, CRC-32 u4, JSON, JSON, arrays"
