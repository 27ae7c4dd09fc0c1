"""The file itself: made with its whole structure at once, grown by blocks, committed in two phases.

A kill leaves a file whose committed rows are whole: data, flush, counters, flush. SWMR keeps the structure readable at
every moment, the counters say how much of it means something.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from os import PathLike
from pathlib import Path as File
from typing import Any

import h5py
import numpy as np
from h5py import h5s

from continuation.archive.errors import ArchiveError, ArchiveExistsError
from continuation.archive.problem import write_problem
from continuation.archive.schema import COMPONENT, EVENT_NAME, NAME, Column, Layout, text

LIBVER = ("v110", "v110")
SLOTS = 2
RESUME = "resume"

_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"
_CHUNK_BYTES = 1 << 19
_ROWS, _PATHS = 1024, 64

Block = Mapping[str, np.ndarray[Any, Any]]


def chunk_rows(unknowns: int) -> int:
    """Rows a chunk of y: 512 KiB at most, a power of two."""
    fitting = max(_CHUNK_BYTES // (8 * unknowns), 1)
    return int(min(_ROWS, 1 << (fitting.bit_length() - 1)))


class Store:
    """An open file for writing.

    Parameters
    ----------
    file : path
        Must not exist; made with mode "x", since a writer under SWMR holds no lock and "w" would truncate a live file.
    layout : Layout
    attributes : mapping
        Of the root group.
    problem : tuple of (str, dict), optional
        What `problem_data` returned.
    compression : int
        Level of gzip; 0 for none.
    swmr : bool
        Whether the file is to be readable while it grows.

    Raises
    ------
    ArchiveError
        If the file exists or cannot be made.
    """

    def __init__(
        self,
        file: str | PathLike[str],
        layout: Layout,
        attributes: Mapping[str, Any],
        problem: tuple[str, dict[str, Any]] | None = None,
        *,
        compression: int = 0,
        swmr: bool = True,
        durable: bool = False,
    ) -> None:
        self.file = File(file)
        self.layout = layout
        self.durable = durable
        self.events: list[str] = []
        self._h5 = _create(self.file)
        try:
            self._h5.attrs.update(attributes)
            self._build(compression)
            if problem is not None:
                write_problem(self._h5, *problem)
            self._data = {name: self._h5[name] for name in self._names()}
            self._counters = {name: self._h5[f"committed_{name}"] for name in ("points", "paths")}
            self._slots = self._h5[RESUME]["slots"]
            if swmr:
                self.share()
        except BaseException:
            self._h5.close()
            self.file.unlink()
            raise

    def share(self) -> None:
        """From now on the file can be read while it grows, and survives a kill."""
        self._h5.swmr_mode = True

    # -- structure --------------------------------------------------------------------------------------------

    def _build(self, compression: int) -> None:
        file, layout = self._h5, self.layout
        filters = {"compression": "gzip", "compression_opts": compression, "shuffle": True} if compression else {}
        rows = chunk_rows(layout.unknowns)
        self._scale("point", None, _ROWS)
        self._variable(Column("path", "i8", "1", ""), (), _PATHS, {}).make_scale("path")
        self._scale("event", None, 16)
        self._scale("controller", layout.controller)
        component = file.create_dataset("component", data=np.arange(layout.unknowns, dtype=COMPONENT.dtype))
        component.attrs.update(COMPONENT.attributes)
        component.make_scale("component")
        for column in layout.point_columns:
            self._variable(column, layout.width(column), rows if column.dimensions[1:] else _ROWS, filters)
        for column in layout.path_columns:
            self._variable(column, layout.width(column), _PATHS, filters if not column.length else {})
        self._variable(EVENT_NAME, (), 16, {})
        for name, what in (("points", "rows of the point table"), ("paths", "rows of the path table")):
            counter = file.create_dataset(f"committed_{name}", (), "i8")
            counter.attrs.update({"units": "1", "long_name": f"valid {what}"})
        group = file.create_group(RESUME)
        slots = group.create_dataset("slots", (SLOTS, 0), "u1", maxshape=(SLOTS, None), chunks=(1, 1 << 14))
        slots.attrs["long_name"] = "two alternating checkpoints: sequence u8, length u8, CRC-32 u4, JSON, JSON, arrays"

    def _scale(self, name: str, length: int | None, chunk: int = 0) -> None:
        """A dimension without a variable, as netCDF knows it; `length` None if it grows."""
        grows = {"maxshape": (None,), "chunks": (chunk,)} if length is None else {}
        scale = self._h5.create_dataset(name, (length or 0,), ">f4", **grows)
        scale.make_scale(_NO_VARIABLE.format(length or 0))

    def _variable(self, column: Column, width: tuple[int, ...], chunk: int, filters: Mapping[str, Any]) -> Any:
        if column.name in self._h5:
            dataset = self._h5[column.name]
            dataset.attrs.update(column.attributes)
            return dataset
        dtype = h5py.string_dtype("utf-8", column.length) if column.length else column.dtype
        dataset = self._h5.create_dataset(
            column.name, (0, *width), dtype, maxshape=(None, *width), chunks=(chunk, *width), **filters
        )
        if column.name not in column.dimensions and column.name != "path":
            dataset.attrs.update(column.attributes)
            for axis, dimension in enumerate(column.dimensions):
                dataset.dims[axis].attach_scale(self._h5[dimension])
        return dataset

    def _names(self) -> tuple[str, ...]:
        """Of the datasets that grow."""
        columns = (*self.layout.point_columns, *self.layout.path_columns, EVENT_NAME)
        return (*(column.name for column in columns), "point", "event")

    # -- writing ----------------------------------------------------------------------------------------------

    def commit(
        self,
        points: Block | None = None,
        point: int = 0,
        paths: Block | None = None,
        path: int = 0,
        checkpoints: Mapping[int, bytes] | None = None,
    ) -> None:
        """Write rows from `point` and from `path` on, and checkpoints by slot; then, and only then, make them valid.

        Writing the same again does the same, so a commit that was interrupted is simply repeated.
        """
        try:
            for block, start, dimension in ((points, point, "point"), (paths, path, "path")):
                for name, values in (block or {}).items():
                    self._put(self._data[name], start, values)
                if block and dimension == "point":
                    self._data["point"].id.set_extent((start + len(next(iter(block.values()))),))
            for slot, raw in (checkpoints or {}).items():
                self._put_slot(slot, raw)
            self._flush()
            # Points first: a path whose rows are all there without its own row is one to be finished by resuming it.
            for block, start, name in ((points, point, "points"), (paths, path, "paths")):
                if block:
                    self._counters[name][()] = start + len(next(iter(block.values())))
            self._flush()
        except (OSError, RuntimeError) as error:
            reason = f"could not be written ({_short(error)}); what was committed is safe"
            raise ArchiveError(f"{self.file}: {reason}") from error

    def name_event(self, name: str) -> int:
        """The number of an event's name; a new one is written, and becomes valid with the rows that refer to it."""
        name = text(name, NAME).decode()
        if name not in self.events:
            self._data["event"].id.set_extent((len(self.events) + 1,))
            self._put(self._data["event_name"], len(self.events), np.array([name.encode()], dtype=f"S{NAME}"))
            self.events.append(name)
        return self.events.index(name)

    @staticmethod
    def _put(dataset: Any, start: int, values: np.ndarray[Any, Any]) -> None:
        """Rows from `start` on; h5py's own slicing costs several times as much."""
        identity = dataset.id
        identity.set_extent((start + len(values), *values.shape[1:]))
        space = identity.get_space()
        space.select_hyperslab((start, *(0,) * (values.ndim - 1)), values.shape)
        kind = identity.get_type() if values.dtype.kind == "S" else None
        identity.write(h5s.create_simple(values.shape), space, values, kind)

    def _put_slot(self, slot: int, raw: bytes) -> None:
        values = np.frombuffer(raw, dtype="u1")
        if self._slots.shape[1] < values.size:
            self._slots.resize((SLOTS, 2 * values.size))
        self._slots[slot, : values.size] = values

    def _flush(self) -> None:
        self._h5.flush()
        if self.durable:
            os.fsync(self._h5.id.get_vfd_handle())

    def sync(self) -> None:
        """Wait until all of it is on the disk."""
        self._h5.flush()
        os.fsync(self._h5.id.get_vfd_handle())

    def close(self) -> None:
        """Close the file."""
        self._h5.close()


def _create(file: File) -> Any:
    check_new(file)
    try:
        return h5py.File(file, "x", libver=LIBVER)
    except FileExistsError:
        raise exists(file) from None
    except OSError as error:
        raise ArchiveError(f"{file}: could not be created ({_short(error)})") from error


def check_new(file: File) -> None:
    """Whether a file can be made there, asked before any work is done.

    Raises
    ------
    ArchiveError
        If it exists, or its directory does not, or may not be written.
    """
    if file.exists():
        raise exists(file)
    if not file.parent.is_dir():
        raise ArchiveError(f"{file}: there is no directory {file.parent}")
    if not os.access(file.parent, os.W_OK):
        raise ArchiveError(f"{file}: the directory {file.parent} may not be written")


def exists(file: File) -> ArchiveExistsError:
    """The error for a file that is there already."""
    return ArchiveExistsError(f"{file}: exists already, and is never overwritten; choose another name or remove it")


def _short(error: BaseException) -> str:
    return str(error).splitlines()[0][:200]
