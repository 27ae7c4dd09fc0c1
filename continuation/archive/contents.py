"""The open file, read in pieces and checked."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import cached_property, partial
from itertools import pairwise
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
    STOP,
    Committed,
    DamageError,
    Ledger,
    digest,
    latest,
    of_attributes,
)
from continuation.archive.codec import GROUP as PROBLEM
from continuation.archive.codec import read_problem
from continuation.archive.hdf5 import COLUMN_BYTES, Allowance, Image, LimitError, dataset, names, subgroup
from continuation.archive.schema import (
    EVENT_NAME,
    OBSERVED,
    OPTIONAL,
    PARAMETER,
    RESUME,
    SCHEMA,
    SLOTS,
    UNCHECKED,
    Column,
    Layout,
    check_names,
)
from continuation.archive.tables import Table

Array = np.ndarray[Any, Any]
_T = TypeVar("_T")

FAULTS = (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError, MemoryError, ArithmeticError)
"""Exceptions of h5py and of a damaged file's contents."""

WRITER_SECONDS, _PAUSE = 2.0, 0.02
"""Seconds during which a live writer's file may seem damaged, and between retries."""

TABLES = ("point", "path")


class Contents:
    """An open file; any fault raises `ArchiveError`.

    `limit`: bytes of memory. `salvage`: accept damage outside rows. `checked`: the file has checksums.
    `flaws`: accepted damage. `cut_off`: committed rows without checksums, by table.
    """

    root: Any = None
    closed_by_writer = True
    _image: Image | None = None

    def __init__(self, file: str | PathLike[str], *, limit: int | None = None, salvage: bool = False) -> None:
        self.file, self._limit, self._salvage = as_file("file", file), limit, salvage
        try:
            self.guarded(lambda: None)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the file."""
        for held in (self.root, self._image):
            if held is not None:
                held.close()
        self.root = self._image = None

    def guarded(self, read: Callable[[], _T]) -> _T:
        """The result of `read`, retried under a live writer; faults become `ArchiveError`."""
        end = time.monotonic() + WRITER_SECONDS
        while True:
            try:
                if self._image is None:
                    self._open()
                return read()
            except FAULTS as error:
                # Whoever salvages holds the file: nobody writes it.
                if self._salvage or self.closed_by_writer or time.monotonic() > end or not is_held(self.file):
                    raise self.damaged(error) from error
            self.close()
            time.sleep(_PAUSE)

    def damaged(self, error: BaseException) -> ArchiveError:
        """The error for an unreadable file."""
        if self._image is not None and self._image.failure:
            return ArchiveError(f"{self.file}: could not be read ({self._image.failure})")
        if isinstance(error, ArchiveError):
            return error
        if isinstance(error, LimitError):
            return ArchiveError(f"{self.file}: {short(error)}; say limit=")
        hint = "; `recover` keeps the rows that are sound" if isinstance(error, DamageError) else ""
        return ArchiveError(f"{self.file}: truncated or damaged, {short(error)}{hint}")

    def _or_else(self, what: str, read: Callable[[], _T], lost: _T) -> _T:
        """The result of `read`, or `lost` if salvaging and the disk works."""
        try:
            return read()
        except FAULTS as error:
            if not self._salvage or (self._image is not None and self._image.failure):
                raise self.damaged(error) from error
            self.flaws += [what] if what else []
            return lost

    def _flaw(self, text: str) -> None:
        if not self._salvage:
            raise DamageError(text)
        self.flaws.append(text)

    def _open(self) -> None:
        self._image = image = Image(self.file)
        self.closed_by_writer, self.size, self.descriptor = image.closed_by_writer, image.length, image.descriptor
        self.flaws, self._datasets, self._ledgers = list[str](), dict[str, Any](), dict[str, Ledger | None]()
        if image.missing:
            self._flaw(f"its last {image.missing} bytes are missing")
        self.root = file = h5py.File(image, "r", rdcc_nbytes=COLUMN_BYTES)
        self._present = present = names(file)
        self.checked = GROUP in present
        _check_schema(self.file, file.attrs, present)
        self.allowance = Allowance(self.size - image.missing, self._limit)
        self.layout = _layout(file, present, self.allowance)
        self._columns = {table: {column.name: column for column in self.layout.columns(table)} for table in TABLES}
        self._row_bytes = {table: self.layout.row_bytes(table) for table in TABLES}
        for table, size in self._row_bytes.items():
            self.allowance.take(f"a row of {table}s", size)
        self.committed, self.cut_off = self._read_committed(), dict.fromkeys(TABLES, 0)
        if self._salvage:
            for table in TABLES:
                before, ledger = getattr(self.committed, f"{table}s"), self._ledger(table)
                rows = before if ledger is None else ledger.rows
                self.committed, self.cut_off[table] = evolve(self.committed, **{f"{table}s": rows}), before - rows
            _ = self.attributes, self.event_names

    @cached_property
    def attributes(self) -> dict[str, Any]:
        """Root attributes, checked."""
        return self.guarded(self._read_attributes)

    @cached_property
    def event_names(self) -> tuple[str, ...]:
        """Names that `event_index` numbers, checked."""
        return self.guarded(self._read_names)

    def _read_attributes(self) -> dict[str, Any]:
        found: dict[str, Any] = self._or_else("its attributes cannot be read", lambda: dict(self.root.attrs), {})
        if not self.checked or of_attributes(found) == int(subgroup(self.root, GROUP).attrs["attributes"]):
            return found
        self._flaw("its attributes are not what was written")
        plain = {k: v.encode(errors="replace").decode() if isinstance(v, str) else v for k, v in found.items()}
        return {name.encode(errors="replace").decode(): value for name, value in plain.items()}

    def _read_committed(self) -> Committed:
        if self.checked:
            kind, shape = np.dtype("u1"), (2 * PLACES, RECORD_BYTES)
            return latest(dataset(subgroup(self.root, GROUP), RECORDS, kind, shape, self.allowance)[()])
        # Paths first: their rows are counted after their points.
        paths, points = (
            int(dataset(self.root, f"committed_{name}", np.dtype("i8"), (), self.allowance)[()])
            for name in ("paths", "points")
        )
        if points < 0 or paths < 0:
            raise DamageError(f"it has {points} points and {paths} paths")
        return Committed(points=points, paths=paths)

    def _ledger(self, table: str) -> Ledger | None:
        if table in self._ledgers:
            return self._ledgers[table]
        columns, rows, ledger = list(self._columns[table]), getattr(self.committed, f"{table}s"), None
        if self.checked:
            blocks, shape = getattr(self.committed, f"{table}_blocks"), (None, STOP + len(columns))
            sums = self._leading(subgroup(self.root, GROUP), table, np.dtype("u4"), shape, blocks)
            ledger = Ledger(sums, columns, None if self._salvage else rows)
            if ledger.rows != rows:
                self._flaw(f"the checksums of {rows - ledger.rows} {table}s are missing")
                rows = ledger.rows
        held = rows * self._row_bytes[table] + len(columns) * COLUMN_BYTES
        self.allowance.take(f"the table of {table}s", held)
        self._ledgers[table] = ledger
        return ledger

    def _leading(self, group: Any, name: str, kind: Any, shape: tuple[int | None, ...], count: int) -> Array:
        """First rows of a dataset, as far as HDF5 finds chunks."""
        found = dataset(group, name, kind, shape, self.allowance, count)
        step = found.chunks[0] if self._salvage and found.chunks else max(count, 1)
        parts: list[Array | None] = [np.empty((0, *found.shape[1:]), found.dtype)]
        while parts[-1] is not None and (len(parts) - 1) * step < count:
            rows = slice((len(parts) - 1) * step, min(len(parts) * step, count))
            parts.append(self._or_else("", partial(found.__getitem__, rows), None))
        return np.concatenate([part for part in parts if part is not None])

    def _read_names(self) -> tuple[str, ...]:
        # Raw bytes, since h5netcdf, netCDF4 and h5py decode text differently.
        count = self.committed.names if self.checked else self.root[EVENT_NAME.name].shape[0]
        raw = self._leading(self.root, EVENT_NAME.name, EVENT_NAME.storage, (None,), count).astype(EVENT_NAME.storage)
        if self.checked:
            sums = self._leading(subgroup(self.root, GROUP), "event", np.dtype("u4"), (None,), count)
            if len(raw) < count or [digest(raw[k : k + 1]) for k in range(len(raw))] != sums.tolist():
                self._flaw("the names of its events are not what was written")
        named = [name.decode(errors="replace") for name in raw]
        return (*named, *(f"event {k}, whose name is lost" for k in range(len(named), count)))

    def table(self, name: str) -> Table:
        """The committed rows of ``"point"`` or ``"path"``."""
        return Table(self.layout, name, getattr(self.committed, f"{name}s"), partial(self.read, name))

    def read(self, table: str, name: str, rows: slice) -> Array:
        """Committed rows of a column, checked."""
        return self.guarded(lambda: self._read(table, name, rows))

    def _read(self, table: str, name: str, rows: slice) -> Array:
        fetch, ledger = partial(self._fetch, self._columns[table][name]), self._ledger(table)
        return fetch(rows) if ledger is None else ledger.read(name, rows, fetch)

    def _fetch(self, column: Column, rows: slice) -> Array:
        if column.name not in self._datasets:
            shape = (None, *self.layout.width(column))
            found = dataset(self.root, column.name, column.storage, shape, self.allowance, 0)
            self._datasets[column.name] = found.astype(column.storage) if column.length else found
        found = self._datasets[column.name]
        if len(found) < rows.stop:
            raise DamageError(f"{column.name} has fewer rows than were committed")
        values: Array = found[rows]
        return values

    def unsound(self, table: str) -> list[tuple[int, int]]:
        """Blocks of rows with a damaged or unreadable column."""
        ledger = self._ledger(table)
        blocks = [] if ledger is None else list(pairwise(ledger.bounds.tolist()))

        def is_sound(start: int, stop: int) -> bool:
            rows = slice(start, stop)
            return self._or_else("", lambda: all(len(self._read(table, n, rows)) for n in self._columns[table]), False)

        several = [blocks[k : k + _BLOCKS] for k in range(0, len(blocks), _BLOCKS)]
        doubtful = [some for some in several if not is_sound(some[0][0], some[-1][1])]
        return [block for some in doubtful for block in some if not is_sound(*block)]

    def slots(self) -> list[bytes]:
        """Stored checkpoints, perhaps torn."""

        def read() -> list[bytes]:
            found = dataset(subgroup(self.root, RESUME), "slots", np.dtype("u1"), (SLOTS, None), self.allowance)
            return [slot.tobytes() for slot in found[()]]

        return self.guarded(read) if RESUME in self._present else []

    def problem(self) -> tuple[str, Mapping[str, Any]]:
        """The problem group."""

        def read() -> tuple[str, Mapping[str, Any]]:
            group = subgroup(self.root, PROBLEM) if PROBLEM in self._present else None
            return read_problem(group, self.checked, self.allowance)

        nothing = read_problem(None, False, self.allowance)
        return self.guarded(lambda: self._or_else("its problem cannot be read", read, nothing))


_BLOCKS = 64
"""Blocks (up to 4 MiB each) checked together."""


def _check_schema(name: File, attributes: Any, present: set[str]) -> None:
    schema = attributes.get("schema")
    complete = {"committed_points", "committed_paths"} <= present and (schema in (UNCHECKED, None) or GROUP in present)
    kind, _, version = str(schema).rpartition("-")
    ours, _, newest = SCHEMA.rpartition("-")
    known = kind == ours and version.isdecimal() and len(version) < 9
    writer = attributes.get("library_version") or "unknown"
    said = (
        "is an HDF5 file, but not an archive of paths (it has no attribute `schema`)"
        if schema is None and not complete
        else f"has the schema {str(schema)[:60]!r}, expected {SCHEMA!r}"
        if not known
        else f"has the newer schema {schema}, this library reads up to {SCHEMA}; upgrade to continuation "
        f"{str(writer)[:20]} or later, or read it with h5py or xarray"
        if int(version) > int(newest)
        else "truncated, its writer ended before the structure was complete"
        if not complete
        else ""
    )
    if said:
        raise ArchiveError(f"{name}: {said}")


def _layout(file: Any, present: set[str], allowance: Allowance) -> Layout:
    known = {column.name for column in OPTIONAL} & present
    for prefix in (OBSERVED, PARAMETER):
        own = sorted(name.removeprefix(prefix) for name in present if name.startswith(prefix))
        check_names(prefix, own)
        known |= {prefix + name for name in own}
    y, state = (dataset(file, name, np.dtype("f8"), (None, None), allowance, 0) for name in ("y", "controller_state"))
    return Layout(int(y.shape[1]), int(state.shape[1]), frozenset(known))
