"""The schema `continuation-path-2`: columns with types, units and meanings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import cached_property, lru_cache
from io import BytesIO
from typing import Any

import h5py
import numpy as np
from attrs import field, frozen

from continuation.archive.hdf5 import GROUP, PLACES, RECORDS, blank
from continuation.counts import Counts
from continuation.status import Kind, Status

SCHEMA = "continuation-path-2"
"""Additions keep the name; a changed meaning needs a new one."""

TABLES = ("point", "path")
ROLES = ("accepted_step", "located_event", "kink_part")
ACCEPTED, LOCATED, KINK_PART = range(len(ROLES))


@frozen
class Column:
    """A variable of the file; bytes are UTF-8 text."""

    name: str
    storage: np.dtype[Any] = field(converter=np.dtype)
    units: str
    long_name: str
    dimensions: tuple[str, ...] = ("point",)
    more: Mapping[str, Any] = field(factory=dict)

    @property
    def length(self) -> int:
        """Bytes of a text, else 0."""
        return self.storage.itemsize if self.storage.kind == "S" else 0

    @property
    def attributes(self) -> dict[str, Any]:
        """The attributes in the file."""
        return {"units": self.units, "long_name": self.long_name, **self.more}

    @property
    def missing(self) -> Any:
        """NaN, -1 or empty text."""
        if self.length:
            return b""
        return np.nan if self.storage.kind == "f" else -1


def _flags(names: tuple[str, ...], values: tuple[int, ...] | None = None) -> dict[str, Any]:
    numbers = range(len(names)) if values is None else values
    return {"flag_values": np.array(tuple(numbers), dtype="i1"), "flag_meanings": " ".join(names)}


COUNT_NAMES = {name: {"residuals": "evaluations"}.get(name, name) for name in Counts().as_dict()}
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
        more=_flags(ROLES),
    ),
    Column("event_index", "i2", "1", "number of the event in event_name; -1 where there is none"),
    Column("event_monitor", "f8", "1", "value of the event's monitor at the located point; NaN where there is none"),
    Column("corrector_iterations", "i2", "1", "iterations of the corrector; -1 at located events"),
    Column("rejections", "i2", "1", "rejected attempts before the accepted one; -1 at located events"),
    Column("contraction", "f8", "1", "ratio of the corrector's increments; NaN at located events"),
    Column("distance", "f8", "1", "length of the correction; NaN at located events"),
    Column("angle", "f8", "radian", "angle between this tangent and the one before; NaN at located events"),
    Column("parameter_share", "f8", "1", "the parameter's share of the tangent; NaN at located events"),
    Column("tangent_y", "f8", "1", "unit tangent, components of the unknowns", ("point", "component")),
    Column("tangent_parameter", "f8", "1", "unit tangent, component of the parameter"),
    Column("switch", "i4", "1", "number of a switching function that vanishes at the kink; -1 where there is none"),
)
"""Rows `kink_part` have rays as tangents."""

MESSAGE = Column("message", "S240", "1", "how the path ended, in words", ("path",))

SOURCE = Column(
    "source",
    "S160",
    "1",
    "identifier of the file that the path was written to, its number there, and the file's name then",
    ("path",),
)

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
    MESSAGE,
    Column("member", "i8", "1", "index of the homotopy in its sweep; the number of the path outside of one", ("path",)),
    Column("seed", "i8", "1", "seed of the homotopy's random numbers; -1 where there are none", ("path",)),
    Column("n_points", "i8", "1", "rows of this path in the point table", ("path",)),
    Column("wall_time", "f8", "s", "wall-clock time", ("path",)),
    *(Column(COUNT_NAMES[name], "i8", "1", _COUNT_MEANINGS.get(name, name), ("path",)) for name in COUNT_NAMES),
    Column("end_error", "f8", "1", "error estimate of the end point; NaN where there is none", ("path",)),
    Column("winding_number", "i4", "1", "winding number of a singular end; 0 where there is none", ("path",)),
    Column("controller_state", "f8", "1", "state of the step controller at the end", ("path", "controller")),
    Column("homotopy", "S160", "1", "class of the homotopy", ("path",)),
    SOURCE,
)

LATER = frozenset({"tangent_y", "tangent_parameter", "switch", "homotopy", "source"})
"""Columns that older files lack."""

EVENT_NAME = Column("event_name", "S64", "1", "name of the event", ("event",))
COMPONENT = Column("component", "i4", "1", "number of the unknown", ("component",))


OBSERVED, PARAMETER = "observed_", "homotopy_"
"""Prefixes of points' scalars and paths' parameters."""


@frozen
class Layout:
    """Contents of a file: N, cells of `controller_state`, optional columns."""

    unknowns: int
    controller: int = 4
    more: frozenset[str] = LATER

    def columns(self, table: str) -> tuple[Column, ...]:
        """A table's columns."""
        return _columns(self.more, table)

    def own(self, prefix: str) -> tuple[str, ...]:
        """The homotopy's columns, without prefix."""
        return tuple(sorted(name.removeprefix(prefix) for name in self.more if name.startswith(prefix)))

    def width(self, column: Column) -> tuple[int, ...]:
        """The column's dimensions beyond the first."""
        return tuple(self.unknowns if name == "component" else self.controller for name in column.dimensions[1:])

    @cached_property
    def row_bytes(self) -> dict[str, int]:
        """Bytes of a row, by table."""
        return {
            table: sum(column.storage.itemsize * math.prod(self.width(column)) for column in self.columns(table))
            for table in TABLES
        }

    def filled(self, block: Mapping[str, Any], table: str, rows: int) -> dict[str, Any]:
        """All columns of a table; missing columns and cells are filled."""
        whole = {}
        for column in self.columns(table):
            values, shape = block.get(column.name), (rows, *self.width(column))
            if values is None or values.shape != shape:
                missing = np.full(shape, column.missing, dtype=column.storage)
                if values is not None:
                    missing[:, : values.shape[1]] = values
                values = missing
            whole[column.name] = np.ascontiguousarray(values)
        return whole


@lru_cache(maxsize=64)
def _columns(more: frozenset[str], table: str) -> tuple[Column, ...]:
    own = Layout(1, more=more).own
    seen = [Column(OBSERVED + name, "f8", "1", f"{name}, observed by the homotopy") for name in own(OBSERVED)]
    said = [
        Column(PARAMETER + name, "f8", "1", f"parameter {name} of the homotopy", ("path",)) for name in own(PARAMETER)
    ]
    known = (*POINT_COLUMNS, *PATH_COLUMNS, *seen, *said)
    return tuple(c for c in known if c.dimensions[0] == table and (c.name not in LATER or c.name in more))


def check_names(prefix: str, names: Iterable[str]) -> None:
    """Raise a `ValueError` about `prefix` unless names have 1 to 100 printable bytes, no slash."""
    for name in names:
        plain = isinstance(name, str) and name.isprintable() and "/" not in name and name == name.strip()
        # netCDF allows 256 bytes, prefix included.
        if not plain or not 1 <= len(name.encode()) <= 100:
            wanted = "names of 1 to 100 bytes, of printable characters without a slash"
            raise ValueError(f"{prefix}: expected {wanted}, found {name!r:.60}")


def text(value: str, length: int) -> bytes:
    """UTF-8 of at most `length` bytes, cut between characters."""
    raw = value.encode(errors="replace")
    return raw if len(raw) <= length else raw[:length].decode(errors="ignore").encode()


RESUME = "resume"
LIBVER = ("v110", "v110")

_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"
_CHUNK_BYTES = 1 << 13
"""Bytes of a chunk, allocated by its first row: with 512 KiB eight points of 100 unknowns take 600 KB."""


@lru_cache(maxsize=16)
def empty(layout: Layout, compressed: bool) -> bytes:
    """Bytes of a file without rows."""
    made = BytesIO()
    with h5py.File(made, "w", libver=LIBVER) as file:
        _build(file, layout, compressed)
    return made.getvalue()


def _build(file: Any, layout: Layout, compressed: bool) -> None:
    filters = {"compression": "gzip", "shuffle": True} if compressed else {}

    def grows(name: str, dtype: Any, table: str, width: tuple[int, ...] = (), **more: Any) -> Any:
        fitting = max(_CHUNK_BYTES // (8 * max(math.prod(width), 1)), 1)
        chunks = (min(64 if table == "point" else 8, 1 << (fitting.bit_length() - 1)), *width)
        return file.create_dataset(name, (0, *width), dtype, maxshape=(None, *width), chunks=chunks, **more)

    for name in ("point", "event"):
        grows(name, ">f4", name).make_scale(_NO_VARIABLE.format(0))
    file.create_dataset("controller", (layout.controller,), ">f4").make_scale(_NO_VARIABLE.format(layout.controller))
    grows("path", "i8", "path").make_scale("path")
    component = file.create_dataset("component", data=np.arange(layout.unknowns, dtype=COMPONENT.storage))
    component.attrs.update(COMPONENT.attributes)
    component.make_scale("component")
    for column in (*layout.columns("point"), *layout.columns("path"), EVENT_NAME):
        if column.name not in file:
            dtype = h5py.string_dtype("utf-8", column.length) if column.length else column.storage
            own = {} if column.length else filters
            made = grows(column.name, dtype, column.dimensions[0], layout.width(column), **own)
            for axis, dimension in enumerate(column.dimensions):
                made.dims[axis].attach_scale(file[dimension])
        file[column.name].attrs.update(column.attributes)
    for name, what in (("points", "rows of the point table"), ("paths", "rows of the path table")):
        counter = file.create_dataset(f"committed_{name}", (), "i8")
        counter.attrs.update({"units": "1", "long_name": f"valid {what}"})
    for table in ("point", "path"):
        grows(f"{GROUP}/{table}", "u4", GROUP, (2 + len(layout.columns(table)),))
    grows(f"{GROUP}/event", "u4", GROUP)
    file[GROUP].create_dataset(RECORDS, data=blank())
    slots = file.create_dataset(f"{RESUME}/slots", (PLACES, 0), "u1", maxshape=(PLACES, None), chunks=(1, 1 << 12))
    slots.attrs["long_name"] = "two alternating checkpoints: sequence u8, length u8, CRC-32 u4, JSON, JSON, arrays"
