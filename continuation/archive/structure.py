"""The structure of a file: its datasets, made all at once, as every netCDF-4 tool reads them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np

from continuation.archive.checks import GROUP, RECORDS, blank, width
from continuation.archive.schema import COMPONENT, EVENT_NAME, Column, Layout

SLOTS = 2
RESUME = "resume"

_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"
_ROWS, _PATHS = 64, 8
_CHUNK_BYTES = 1 << 13
"""A chunk takes its whole room from its first row on: with 512 KiB eight points of 100 unknowns take 600 KB."""


def chunk_rows(width: tuple[int, ...], most: int = _ROWS) -> int:
    """Rows a chunk, each of so many numbers: 8 KiB at most, a power of two."""
    fitting = max(_CHUNK_BYTES // (8 * max(math.prod(width), 1)), 1)
    return int(min(most, 1 << (fitting.bit_length() - 1)))


def build(file: Any, layout: Layout, compression: int) -> None:
    """Make all the datasets of a new file, without rows.

    `compression`: Level of gzip; 0 for none.
    """
    filters = {"compression": "gzip", "compression_opts": compression, "shuffle": True} if compression else {}
    _scale(file, "point", None, _ROWS)
    _variable(file, Column("path", "i8", "1", ""), (), _PATHS, {}).make_scale("path")
    _scale(file, "event", None, 16)
    _scale(file, "controller", layout.controller)
    component = file.create_dataset("component", data=np.arange(layout.unknowns, dtype=COMPONENT.dtype))
    component.attrs.update(COMPONENT.attributes)
    component.make_scale("component")
    for column in layout.point_columns:
        _variable(file, column, layout.width(column), chunk_rows(layout.width(column)), filters)
    for column in layout.path_columns:
        chunk = chunk_rows(layout.width(column), _PATHS)
        _variable(file, column, layout.width(column), chunk, {} if column.length else filters)
    _variable(file, EVENT_NAME, (), 16, {})
    for name, what in (("points", "rows of the point table"), ("paths", "rows of the path table")):
        counter = file.create_dataset(f"committed_{name}", (), "i8")
        counter.attrs.update({"units": "1", "long_name": f"valid {what}"})
    checks = file.create_group(GROUP)
    for table, columns, chunk in (("point", layout.point_columns, 16), ("path", layout.path_columns, _PATHS)):
        words = width([column.name for column in columns])
        checks.create_dataset(table, (0, words), "u4", maxshape=(None, words), chunks=(chunk, words))
    checks.create_dataset("event", (0,), "u4", maxshape=(None,), chunks=(16,))
    checks.create_dataset(RECORDS, data=blank())
    group = file.create_group(RESUME)
    slots = group.create_dataset("slots", (SLOTS, 0), "u1", maxshape=(SLOTS, None), chunks=(1, 1 << 12))
    slots.attrs["long_name"] = "two alternating checkpoints: sequence u8, length u8, CRC-32 u4, JSON, JSON, arrays"


def _scale(file: Any, name: str, length: int | None, chunk: int = 0) -> None:
    """A dimension without a variable, as netCDF knows it; `length` None if it grows."""
    grows = {"maxshape": (None,), "chunks": (chunk,)} if length is None else {}
    scale = file.create_dataset(name, (length or 0,), ">f4", **grows)
    scale.make_scale(_NO_VARIABLE.format(length or 0))


def _variable(file: Any, column: Column, width: tuple[int, ...], chunk: int, filters: Mapping[str, Any]) -> Any:
    if column.name in file:
        dataset = file[column.name]
        dataset.attrs.update(column.attributes)
        return dataset
    dtype = h5py.string_dtype("utf-8", column.length) if column.length else column.dtype
    dataset = file.create_dataset(
        column.name, (0, *width), dtype, maxshape=(None, *width), chunks=(chunk, *width), **filters
    )
    if column.name not in column.dimensions and column.name != "path":
        dataset.attrs.update(column.attributes)
        for axis, dimension in enumerate(column.dimensions):
            dataset.dims[axis].attach_scale(file[dimension])
    return dataset
