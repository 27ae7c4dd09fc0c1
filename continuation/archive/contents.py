"""What a file holds, taken from it piece by piece and checked: the one place where an archive is read from HDF5."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from os import PathLike
from pathlib import Path as File
from typing import Any, TypeVar

import h5py
import numpy as np
from attrs import evolve

from continuation.archive.atomic import ArchiveError, as_file, is_held, short
from continuation.archive.checks import (
    GROUP,
    PLACES,
    RECORD_BYTES,
    RECORDS,
    Committed,
    DamageError,
    Ledger,
    digest,
    latest,
    of_attributes,
    width,
)
from continuation.archive.codec import GROUP as PROBLEM
from continuation.archive.codec import read_problem
from continuation.archive.hdf5 import COLUMN_BYTES, Allowance, Image, LimitError, dataset, names, subgroup
from continuation.archive.schema import (
    EVENT_NAME,
    KINK_COLUMNS,
    ORIGIN_COLUMNS,
    RESUME,
    SCHEMA,
    SLOTS,
    TANGENT_COLUMNS,
    UNCHECKED,
    Column,
    Layout,
    check_names,
)

Array = np.ndarray[Any, Any]
_T = TypeVar("_T")

FAULTS = (OSError, RuntimeError, KeyError, ValueError, TypeError, AttributeError, MemoryError, RecursionError)
"""What h5py raises for a file that is not what it should be."""

WRITER_SECONDS, _PAUSE = 2.0, 0.02
"""Seconds for which a file that is being written may seem to be damaged, since its writer is in the middle of
something, and between two looks at it."""


class Contents:
    """An open file.

    `limit`: Bytes that all which is read may take, as `Allowance` has it. `salvage`: Whether to go on where the end of
    the file is missing, or its attributes, names or problem are not what was written: rows are checked all the same.
    `checked`: Whether it has checksums; files of the schema `continuation-path-1` have none. `flaws`: What was passed
    over. `cut_off`: Committed rows of each table whose checksums are missing. Raises `ArchiveError` for anything wrong
    with it, here and in the methods.
    """

    def __init__(self, file: str | PathLike[str], *, limit: int | None = None, salvage: bool = False) -> None:
        self.file, self._limit, self._salvage = as_file("file", file), limit, salvage
        self.flaws: list[str] = []
        self.closed_by_writer = True
        self._image: Image | None = None
        self._h5: Any = None
        try:
            self._guarded(self._read_structure)
        except BaseException:
            self.close()
            raise

    def _open(self) -> Image:
        self._image = image = Image(self.file)
        self.closed_by_writer, self.size, self.descriptor = image.closed_by_writer, image.length, image.descriptor
        if image.missing and not self._salvage:
            what = f"{self.file}: truncated or damaged, its last {image.missing} bytes are missing"
            raise ArchiveError(f"{what}; `recover` keeps the rows that are sound")
        try:
            self._h5, self._datasets = h5py.File(image, "r", rdcc_nbytes=COLUMN_BYTES), dict[str, Any]()
            schema, writer = (self._h5.attrs.get(name) for name in ("schema", "library_version"))
            complete = all(part in self._h5 for part in ("committed_points", "committed_paths"))
            complete &= schema == UNCHECKED or (GROUP in self._h5 and RECORDS in self._h5[GROUP]) or schema is None
        except FAULTS as error:
            what = f"truncated or damaged, HDF5 cannot open it ({short(error)})"
            raise ArchiveError(f"{self.file}: {what}") from None
        _check_schema(self.file, schema, writer, complete)
        return image

    @property
    def root(self) -> Any:
        """The root of the file, for groups that only some files have."""
        return self._h5

    def close(self) -> None:
        """Close the file."""
        for held in (self._h5, self._image):
            if held is not None:
                held.close()

    def _guarded(self, read: Callable[[], _T]) -> _T:
        """What `read` returns; a file that is being written is given time to be read right."""
        end = time.monotonic() + WRITER_SECONDS
        while True:
            try:
                self._image = self._image or self._open()
                return read()
            except FAULTS as error:
                if self.closed_by_writer or time.monotonic() > end or not is_held(self.file):
                    if isinstance(error, ArchiveError):
                        raise
                    raise self.damaged(error) from error
            self.close()
            self._h5 = self._image = None
            time.sleep(_PAUSE)

    def damaged(self, error: BaseException) -> ArchiveError:
        """The error for a file that cannot be read."""
        if self._image is not None and self._image.failure:
            return ArchiveError(f"{self.file}: could not be read ({self._image.failure})")
        if isinstance(error, LimitError):
            return ArchiveError(f"{self.file}: {short(error)}; say limit=")
        hint = "; `recover` keeps what is sound" if isinstance(error, DamageError) else ""
        return ArchiveError(f"{self.file}: truncated or damaged ({short(error)}){hint}")

    def _or_else(self, what: str, read: Callable[[], _T], lost: _T) -> _T:
        """What `read` returns, or what stands for it where it is to be salvaged and cannot be read."""
        try:
            return read()
        except FAULTS as error:
            self._pass_over(error)
            self.flaws.append(f"{what} cannot be read")
            return lost

    def _pass_over(self, error: Exception) -> None:
        """Go on without what cannot be read, if that is the file's fault: a disk that fails may read it soon."""
        if not self._salvage or (self._image is not None and self._image.failure):
            raise self.damaged(error) from error

    def _flaw(self, text: str) -> None:
        if not self._salvage:
            raise DamageError(text)
        self.flaws.append(text)

    # -- structure --------------------------------------------------------------------------------------------

    def _read_structure(self) -> None:
        file, missing = self._h5, self._image.missing if self._image else 0
        self.allowance = Allowance(self.size - missing, self._limit)
        self.flaws = [f"its last {missing} bytes are missing"] if missing else []
        self.checked = GROUP in file
        self.layout = _layout(file, self.allowance)
        columns = {"point": self.layout.point_columns, "path": self.layout.path_columns}
        self._columns = {table: {column.name: column for column in held} for table, held in columns.items()}
        self._ledgers: dict[str, Ledger] = {}
        self.cut_off = {"point": 0, "path": 0}
        self.committed = self._read_committed()
        if self.checked:
            point, path = (self._read_ledger(table) for table in ("point", "path"))
            self.committed = evolve(self.committed, points=point, paths=path)
        for table, rows in (("point", self.committed.points), ("path", self.committed.paths)):
            held = columns[table]
            row = sum(column.storage.itemsize * math.prod(self.layout.width(column)) for column in held)
            self.allowance.take(f"the table of {table}s", rows * row + len(held) * COLUMN_BYTES)
        self.attributes: dict[str, Any] = self._or_else("its attributes", lambda: dict(file.attrs), {})
        if self.checked and of_attributes(self.attributes) != int(subgroup(file, GROUP).attrs["attributes"]):
            self._flaw("its attributes are not what was written")
        self.event_names = self._read_names()

    def _read_committed(self) -> Committed:
        if self.checked:
            kind, shape = np.dtype("u1"), (2 * PLACES, RECORD_BYTES)
            return latest(dataset(subgroup(self._h5, GROUP), RECORDS, kind, shape, self.allowance)[()])
        # Paths first: their rows are counted after the points they need, so this order sees no path without its points.
        paths, points = (
            int(dataset(self._h5, f"committed_{name}", np.dtype("i8"), (), self.allowance)[()])
            for name in ("paths", "points")
        )
        if points < 0 or paths < 0:
            raise DamageError(f"it has {points} points and {paths} paths")
        return Committed(points=points, paths=paths)

    def _read_ledger(self, table: str) -> int:
        """The checksums of a table; how many of its rows they cover, which is all but where the file is cut off."""
        columns, rows = list(self._columns[table]), getattr(self.committed, f"{table}s")
        blocks = getattr(self.committed, f"{table}_blocks")
        checks, shape = subgroup(self._h5, GROUP), (None, width(columns))
        sums = self._leading(dataset(checks, table, np.dtype("u4"), shape, self.allowance, blocks), blocks)
        self._ledgers[table] = ledger = Ledger(sums, columns, None if self._salvage else rows)
        self.cut_off[table] = rows - ledger.rows
        if ledger.rows != rows:
            self.flaws.append(f"the checksums of {rows - ledger.rows} {table}s are missing")
        return ledger.rows

    def _leading(self, found: Any, count: int, kind: Any = None) -> Array:
        """The first rows of a dataset; of a file that is cut off those chunks that HDF5 can still find."""
        view = found if kind is None else found.astype(kind)
        try:
            values: Array = view[:count]
            return values
        except FAULTS as error:
            self._pass_over(error)
        parts, step = [np.empty((0, *found.shape[1:]), kind or found.dtype)], found.chunks[0] if found.chunks else count
        with suppress(*FAULTS):
            parts.extend(view[start : min(start + step, count)] for start in range(0, count, step))
        return np.concatenate(parts)

    def _read_names(self) -> tuple[str, ...]:
        # Raw bytes: h5netcdf, netCDF4 and h5py each decode text in their own way, HDF5 only stores it.
        count = self.committed.names if self.checked else self._h5[EVENT_NAME.name].shape[0]
        stored = dataset(self._h5, EVENT_NAME.name, EVENT_NAME.storage, (None,), self.allowance, count)
        raw = self._leading(stored, count, EVENT_NAME.storage)
        if self.checked:
            sums = dataset(subgroup(self._h5, GROUP), "event", np.dtype("u4"), (None,), self.allowance, count)
            found = [digest(raw[k : k + 1]) for k in range(len(raw))]
            if len(raw) < count or found != self._leading(sums, count).tolist():
                self._flaw("the names of its events are not what was written")
        names = [name.decode(errors="replace") for name in raw]
        return (*names, *(f"event {k}, whose name is lost" for k in range(len(names), count)))

    # -- tables -----------------------------------------------------------------------------------------------

    def read(self, table: str, name: str, rows: slice) -> Array:
        """Committed rows of a column of the table ``"point"`` or ``"path"``, checked."""
        fetch = partial(self._fetch, table, name)
        ledger = self._ledgers.get(table)
        return self._guarded(lambda: fetch(rows) if ledger is None else ledger.read(name, rows, fetch))

    def unsound(self, table: str) -> list[tuple[int, int]]:
        """The blocks of rows of which some column is not what was written, or cannot be read at all."""
        if not self.checked:
            return []
        bounds, found = self._ledgers[table].bounds.tolist(), []

        def look(first: int, last: int) -> None:
            """Look for them among some blocks; those that are not sound together are looked at in halves."""
            rows, middle = slice(bounds[first], bounds[last]), (first + last) // 2
            try:
                for name in self._columns[table]:
                    self._ledgers[table].read(name, rows, partial(self._fetch, table, name))
            except FAULTS as error:
                self._pass_over(error)
                if last - first == 1:
                    found.append((rows.start, rows.stop))
                else:
                    look(first, middle)
                    look(middle, last)

        for first in range(0, len(bounds) - 1, _BLOCKS):
            look(first, min(first + _BLOCKS, len(bounds) - 1))
        return found

    def _fetch(self, table: str, name: str, rows: slice) -> Array:
        column = self._columns[table][name]
        found = self._dataset(column)
        if found.shape[0] < rows.stop:
            raise DamageError(f"{name} has fewer rows than were committed")
        values: Array = (found.astype(column.storage) if column.length else found)[rows]
        return values

    def _dataset(self, column: Column) -> Any:
        if column.name not in self._datasets:
            shape = (None, *self.layout.width(column))
            # Its rows are counted with the table's.
            self._datasets[column.name] = dataset(self._h5, column.name, column.storage, shape, self.allowance, 0)
        return self._datasets[column.name]

    # -- for resuming -----------------------------------------------------------------------------------------

    def slots(self) -> list[bytes]:
        """The two checkpoints, as far as they are there; each says itself whether it is whole."""

        def read() -> list[bytes]:
            shape = (SLOTS, None)
            found = dataset(subgroup(self._h5, RESUME), "slots", np.dtype("u1"), shape, self.allowance)
            return [slot.tobytes() for slot in found[()]]

        return self._guarded(read) if RESUME in self._h5 else []

    def problem(self) -> tuple[str, Mapping[str, Any]]:
        """The first homotopy's description (JSON), and its arrays."""

        def read() -> tuple[str, Mapping[str, Any]]:
            group = subgroup(self._h5, PROBLEM) if PROBLEM in self._h5 else None
            return read_problem(group, self.checked, self.allowance)

        return self._guarded(lambda: self._or_else("its problem", read, read_problem(None, False, self.allowance)))


_BLOCKS = 256
"""That are checked at once: of 4 MiB at most each, and of 256 rows mostly."""


def _check_schema(name: File, schema: Any, writer: Any, complete: bool) -> None:
    if schema is None and not complete:
        raise ArchiveError(f"{name}: is an HDF5 file, but not an archive of paths (it has no attribute `schema`)")
    kind, _, version = str(schema).rpartition("-")
    ours, _, newest = SCHEMA.rpartition("-")
    if kind != ours or not (version.isdecimal() and len(version) < 9):
        raise ArchiveError(f"{name}: has the schema {str(schema)[:60]!r}, expected {SCHEMA!r}")
    if int(version) > int(newest):
        raise ArchiveError(
            f"{name}: has the newer schema {schema}, this library reads up to {SCHEMA}; "
            f"upgrade to continuation {str(writer or 'unknown')[:20]} or later, or read it with h5py or xarray"
        )
    if not complete:
        raise ArchiveError(f"{name}: truncated, its writer ended before the structure was complete")


def _layout(file: Any, allowance: Allowance) -> Layout:
    present = names(file)

    def named(prefix: str) -> tuple[str, ...]:
        found = tuple(sorted(name.removeprefix(prefix) for name in present if name.startswith(prefix)))
        check_names(prefix, found)
        return found

    y, state = (dataset(file, name, np.dtype("f8"), (None, None), allowance, 0) for name in ("y", "controller_state"))
    return Layout(
        unknowns=int(y.shape[1]),
        controller=int(state.shape[1]),
        observed=named("observed_"),
        scalars=named("homotopy_"),
        tangents=all(column.name in present for column in TANGENT_COLUMNS),
        pieces=all(column.name in present for column in KINK_COLUMNS),
        origins=all(column.name in present for column in ORIGIN_COLUMNS),
    )
