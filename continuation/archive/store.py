"""The file itself: made with its whole structure at once, grown by blocks, committed in two phases.

A kill leaves a file whose committed rows are whole: data and intent, flush, commit, flush. SWMR keeps the structure
readable at every moment, the records (`continuation.archive.checks`) say how much of it means something.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path as File
from typing import Any

import h5py
import numpy as np
from h5py import h5s

from continuation.archive.atomic import short
from continuation.archive.checkpoint import HEAD
from continuation.archive.checks import (
    GROUP,
    PLACES,
    RECORD_BYTES,
    RECORDS,
    Committed,
    blank,
    digest,
    of_attributes,
    seal,
    width,
)
from continuation.archive.errors import ArchiveError
from continuation.archive.image import HEAD_BYTES, Sink, stated_length
from continuation.archive.locks import Lock
from continuation.archive.problem import write_problem
from continuation.archive.schema import COMPONENT, EVENT_NAME, NAME, Column, Layout, text

LIBVER = ("v110", "v110")
SLOTS = 2
RESUME = "resume"

_NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable.{:10d}"
_CHUNK_BYTES = 1 << 19
_ROWS, _PATHS = 1024, 64

_TABLES = ("point", "path")
_ONE_RECORD = h5s.create_simple((1, RECORD_BYTES))

Block = Mapping[str, np.ndarray[Any, Any]]


def chunk_rows(unknowns: int) -> int:
    """Rows a chunk of y: 512 KiB at most, a power of two."""
    fitting = max(_CHUNK_BYTES // (8 * unknowns), 1)
    return int(min(_ROWS, 1 << (fitting.bit_length() - 1)))


class Store:
    """A file being written. It is made by Python's hand (`Sink`), and either finished so, or goes live under SWMR.

    Parameters
    ----------
    part : pathlib.Path
        Must not exist.
    layout : Layout
    attributes : mapping
        Of the root group.
    problem : tuple of (str, dict), optional
        What `problem_data` returned.
    compression : int
        Level of gzip; 0 for none.
    durable : bool
        Wait for the disk at each commit.

    Attributes
    ----------
    file : pathlib.Path
        Its name, in messages.

    Raises
    ------
    ArchiveError
        If the file cannot be written.
    """

    def __init__(
        self,
        part: File,
        layout: Layout,
        attributes: Mapping[str, Any],
        problem: tuple[str, Mapping[str, Any]] | None = None,
        *,
        compression: int = 0,
        durable: bool = False,
    ) -> None:
        self.file = part
        self.layout = layout
        self.durable = durable
        self.events: list[str] = []
        self._committed = Committed(sequence=1)
        self._lock: Lock | None = None
        self._sink: Sink | None = Sink(part)
        # Without a cache HDF5 writes what it is given; 1 MiB for each column, kept for nothing, would be 25 MiB.
        self._cache = {} if compression else {"rdcc_nbytes": 0}
        self._h5 = h5py.File(self._sink, "w", libver=LIBVER, **self._cache)
        try:
            self._h5.attrs.update(attributes)
            self._build(compression)
            if problem is not None:
                write_problem(self._h5, *problem)
            self._h5[GROUP].attrs["attributes"] = np.uint32(of_attributes(dict(self._h5.attrs)))
            self._bind()
            self._sink.check()
        except BaseException:
            self.close()
            raise

    def _bind(self) -> None:
        self._data = {name: self._h5[name] for name in self._names()}
        self._counters = {name: self._h5[f"committed_{name}"] for name in ("points", "paths")}
        self._checks = {name: self._h5[GROUP][name] for name in (*_TABLES, "event", RECORDS)}
        self._slots = self._h5[RESUME]["slots"]

    def go_live(self) -> None:
        """From now on the file can be read while it grows, survives a kill, and is locked."""
        self.finish(sync=self.durable)
        self._lock = Lock(self.file)
        self._h5 = h5py.File(self.file, "r+", libver=LIBVER, **self._cache)
        self._bind()
        self._h5.swmr_mode = True

    def finish(self, *, sync: bool = True) -> None:
        """Close the file, on the disk when this returns.

        Raises
        ------
        OSError
            If some of it could not be written.
        """
        sink = self._sink
        assert sink is not None
        try:
            self._h5.close()
            sink.check()
            if sync:
                os.fsync(sink.descriptor)
        finally:
            sink.close()
            self._sink = None

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
        checks = file.create_group(GROUP)
        for table, columns, chunk in (("point", layout.point_columns, 16), ("path", layout.path_columns, _PATHS)):
            words = width([column.name for column in columns])
            checks.create_dataset(table, (0, words), "u4", maxshape=(None, words), chunks=(chunk, words))
        checks.create_dataset("event", (0,), "u4", maxshape=(None,), chunks=(16,))
        checks.create_dataset(RECORDS, data=blank())
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

        Writing the same again does the same, so a commit that was interrupted is simply repeated, with the rows beyond
        `committed`.
        """
        before = self._committed
        after = Committed(
            before.sequence + 1,
            max(point + _rows(points), before.points),
            max(path + _rows(paths), before.paths),
            before.point_blocks + bool(points),
            before.path_blocks + bool(paths),
            len(self.events),
            max([before.checkpoint, *(HEAD.unpack_from(raw)[0] for raw in (checkpoints or {}).values())]),
        )
        try:
            for block, start, table, number in (
                (points, point, "point", before.point_blocks), (paths, path, "path", before.path_blocks)
            ):  # fmt: skip
                if not block:
                    continue
                for name, values in block.items():
                    self._put(self._data[name], start, values)
                self._put(self._checks[table], number, seal(block, start)[None])
            if points:
                self._data["point"].id.set_extent((after.points,))
            for slot, raw in (checkpoints or {}).items():
                self._put_slot(slot, raw)
            self._record(after, 0)
            self._flush()
            # All of it is written: whatever interrupts from here on, the next commit goes on after it.
            self._committed = after
            self._record(after, PLACES)
            self._counters["points"][()], self._counters["paths"][()] = after.points, after.paths
            self._flush()
        except (OSError, RuntimeError, ValueError) as error:
            self.abandon()
            reason = f"could not be written ({short(error)}); what was committed is safe"
            raise ArchiveError(f"{self.file}: {reason}") from error

    @property
    def committed(self) -> Committed:
        """What is written, and valid now or with the next commit."""
        return self._committed

    def _record(self, committed: Committed, first: int) -> None:
        """One of the two records of a commit, in the place whose turn it is."""
        records = self._checks[RECORDS].id
        space = records.get_space()
        space.select_hyperslab((first + committed.sequence % PLACES, 0), (1, RECORD_BYTES))
        records.write(_ONE_RECORD, space, committed.pack())

    def name_event(self, name: str) -> int:
        """The number of an event's name; a new one is written, and becomes valid with the rows that refer to it."""
        name = text(name, NAME).decode()
        if name not in self.events:
            self._data["event"].id.set_extent((len(self.events) + 1,))
            stored = np.array([name.encode()], dtype=f"S{NAME}")
            self._put(self._data["event_name"], len(self.events), stored)
            self._put(self._checks["event"], len(self.events), np.array([digest(stored)], dtype="u4"))
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
        if self._sink is not None:
            self._sink.check()
        elif self.durable:
            os.fsync(self._h5.id.get_vfd_handle())

    def close(self) -> None:
        """Close the file."""
        try:
            self._h5.close()
        finally:
            for held in (self._sink, self._lock):
                if held is not None:
                    held.close()

    def abandon(self) -> None:
        """Leave the file as a kill would, and let HDF5 write what it still has to nowhere.

        A write that fails while it closes a file ends the process.
        """
        if self._sink is not None:
            return
        descriptor = self._h5.id.get_vfd_handle()
        with suppress(OSError), self.file.open("rb") as head:
            # The length that the file says it has may be beyond what could be written; zeros do for what is missing.
            stated = stated_length(head.read(HEAD_BYTES))
            if stated > os.fstat(descriptor).st_size:
                os.truncate(self.file, stated)
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, descriptor)
        os.close(nowhere)


def _rows(block: Block | None) -> int:
    return len(next(iter(block.values()))) if block else 0
