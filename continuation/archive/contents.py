"""An open file, read in pieces and checked."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from functools import cached_property, partial
from itertools import pairwise, starmap, takewhile
from os import PathLike
from pathlib import Path as File
from typing import Any, TypeVar

import h5py
import numpy as np
from attrs import evolve

from continuation.archive.atomic import ArchiveError, as_file, is_held, short
from continuation.archive.hdf5 import (
    GROUP,
    PLACES,
    PROBLEM,
    RECORD,
    RECORDS,
    Allowance,
    DamageError,
    Image,
    Ledger,
    LimitError,
    dataset,
    digest,
    latest,
    member,
    of_attributes,
    read_problem,
)
from continuation.archive.rows import Table
from continuation.archive.schema import (
    EVENT_NAME,
    LATER,
    OBSERVED,
    PARAMETER,
    RESUME,
    SCHEMA,
    TABLES,
    Column,
    Layout,
    check_names,
)

Array = np.ndarray[Any, Any]
_T = TypeVar("_T")

FAULTS = (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError, MemoryError, ArithmeticError)
"""Exceptions by h5py for a damaged file."""

WRITER_SECONDS, _PAUSE = 2.0, 0.02
"""Seconds during which a live writer's file may seem damaged, and between retries."""

Problem = tuple[str, Mapping[str, Any]]
"""JSON and arrays."""


class Contents:
    """An open file; any fault raises `ArchiveError`.

    `limit`: bytes of memory. `salvage`: accept damage outside rows. `flaws`: accepted damage. `stated`: the last
    commit, `committed`: what of it has checksums.
    """

    root: Any = None
    closed_by_writer, closed = True, False
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
        self._release()
        self.closed = True

    def _release(self) -> None:
        for held in (self.root, self._image):
            if held is not None:
                held.close()
        self.root = self._image = None

    def guarded(self, read: Callable[[], _T]) -> _T:
        """The result of `read`, retried while a writer lives; faults become `ArchiveError`."""
        if self.closed:
            raise ArchiveError(f"{self.file}: the archive was closed; open it again to read more of it")
        end = time.monotonic() + WRITER_SECONDS
        while True:
            try:
                if self._image is None:
                    self._open()
                return read()
            except FAULTS as error:
                if self._salvage or self.closed_by_writer or time.monotonic() > end or not is_held(self.file):
                    raise self.damaged(error) from error
            self._release()
            time.sleep(_PAUSE)

    def damaged(self, error: BaseException) -> ArchiveError:
        """Error for an unreadable file."""
        if self._image is not None and self._image.failure:
            return ArchiveError(f"{self.file}: could not be read ({self._image.failure})")
        if isinstance(error, ArchiveError):
            return error
        if isinstance(error, LimitError):
            return ArchiveError(f"{self.file}: {short(error)}; say limit=")
        hint = "; `recover` keeps the rows that are sound" if isinstance(error, DamageError) else ""
        return ArchiveError(f"{self.file}: truncated or damaged, {short(error)}{hint}")

    def _or_else(self, what: str, read: Callable[[], _T], lost: _T) -> _T:
        """The result of `read`; `lost` for damage if salvaging."""
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
        self.flaws, self._datasets, self._ledgers = list[str](), dict[str, Any](), dict[str, Ledger]()
        if image.missing:
            self._flaw(f"its last {image.missing} bytes are missing")
        self.root = file = h5py.File(image, "r", rdcc_nbytes=0)
        self._present = set(file)
        _check_schema(self.file, file.attrs, self._present)
        self.allowance = Allowance(self.size - image.missing, self._limit)
        for name in ("y", "controller_state"):
            self._datasets[name] = dataset(file, name, np.dtype("f8"), (None, None), self.allowance, 0)
        unknowns, cells = (int(found.shape[1]) for found in self._datasets.values())
        self.layout = Layout(unknowns, cells, _known(self._present))
        for table in TABLES:
            self.allowance.take(f"a row of {table}s", self.layout.row_bytes[table])
        records = dataset(file, f"{GROUP}/{RECORDS}", np.dtype("u1"), (2 * PLACES, RECORD.size), self.allowance)
        self.committed = self.stated = latest(records[()])
        if self._salvage:
            points, paths = (self._ledger(table).rows for table in TABLES)
            self.committed = evolve(self.stated, points=points, paths=paths)
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
        if of_attributes(found) == int(member(self.root, GROUP).attrs["attributes"]):
            return found
        self._flaw("its attributes are not what was written")
        plain = {k: v.encode(errors="replace").decode() if isinstance(v, str) else v for k, v in found.items()}
        return {name.encode(errors="replace").decode(): value for name, value in plain.items()}

    def _ledger(self, table: str) -> Ledger:
        if table not in self._ledgers:
            rows, columns = self.committed.rows(table), self.layout.columns(table)
            blocks, shape = getattr(self.committed, f"{table}_blocks"), (None, 2 + len(columns))
            sums = self._leading(f"{GROUP}/{table}", np.dtype("u4"), shape, blocks)
            ledger = Ledger(sums, [column.name for column in columns], rows)
            if ledger.rows != rows:
                self._flaw(f"the checksums are damaged: those of {rows - ledger.rows} {table}s are missing")
            self.allowance.take(f"the table of {table}s", ledger.rows * self.layout.row_bytes[table])
            self._ledgers[table] = ledger
        return self._ledgers[table]

    def _leading(self, name: str, kind: Any, shape: tuple[int | None, ...], count: int) -> Array:
        """First rows of a dataset, as far as HDF5 finds chunks."""
        found = dataset(self.root, name, kind, shape, self.allowance, count)
        if not self._salvage:
            return np.asarray(found[:count])
        step = found.chunks[0] if found.chunks else max(count, 1)
        starts = range(0, count, step)
        parts = [self._or_else("", partial(found.__getitem__, slice(k, min(k + step, count))), None) for k in starts]
        return np.concatenate([found[:0], *takewhile(lambda part: part is not None, parts)])

    def _read_names(self) -> tuple[str, ...]:
        # Raw bytes, since h5netcdf, netCDF4 and h5py decode text differently.
        count = self.committed.names
        raw = self._leading(EVENT_NAME.name, EVENT_NAME.storage, (None,), count).astype(EVENT_NAME.storage)
        sums = self._leading(f"{GROUP}/event", np.dtype("u4"), (None,), count)
        if len(raw) < count or [digest(raw[k : k + 1]) for k in range(len(raw))] != sums.tolist():
            self._flaw("the names of its events are not what was written")
        named = [name.decode(errors="replace") for name in raw]
        return (*named, *(f"event {k}, whose name is lost" for k in range(len(named), count)))

    def table(self, name: str) -> Table:
        """Committed rows of ``"point"`` or ``"path"``."""
        return Table(self.layout, name, self.committed.rows(name), partial(self.read, name))

    def read(self, table: str, column: Column, rows: slice) -> Array:
        """Committed rows of a column, checked."""
        return self.guarded(lambda: self._ledger(table).read(column.name, rows, partial(self._fetch, column)))

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

    def sound(self, name: str) -> Array:
        """Which rows of a table have their checksums."""
        table, edges = self.table(name), self._ledger(name).bounds.tolist()
        nothing: dict[str, Array] = {}
        sound = np.zeros(edges[-1], dtype=bool)
        for rows in starmap(slice, pairwise(edges)):
            sound[rows] = self._or_else("", partial(table.block, rows), nothing) is not nothing
        return sound

    def slots(self) -> list[bytes]:
        """Stored checkpoints, perhaps torn."""

        def read() -> list[bytes]:
            found = dataset(self.root, f"{RESUME}/slots", np.dtype("u1"), (PLACES, None), self.allowance)
            return [slot.tobytes() for slot in found[()]]

        return self.guarded(lambda: self._or_else("its checkpoints cannot be read", read, []))

    def problem(self) -> Problem:
        """The problem group."""

        def read() -> Problem:
            return read_problem(member(self.root, PROBLEM), self.allowance) if PROBLEM in self._present else nothing

        nothing: Problem = json.dumps({"unstorable": "the file holds no problem"}), {}
        return self.guarded(lambda: self._or_else("its problem cannot be read", read, nothing))


def _check_schema(name: File, attributes: Any, present: set[str]) -> None:
    schema = str(attributes.get("schema", ""))
    kind, _, version = schema.rpartition("-")
    ours, _, newest = SCHEMA.rpartition("-")
    said = (
        "is an HDF5 file, but not an archive of paths (it has no attribute `schema`)"
        if not schema
        else f"has the newer schema {schema[:60]}, this library reads up to {SCHEMA}; upgrade to continuation "
        f"{str(attributes.get('library_version') or 'unknown')[:20]} or later, or read it with h5py or xarray"
        if kind == ours and version.isdecimal() and (len(version), version) > (len(newest), newest)
        else f"has the schema {schema[:60]!r}, expected {SCHEMA!r}"
        if schema != SCHEMA
        else "truncated, its writer ended before the structure was complete"
        if not {GROUP, "committed_points", "committed_paths"} <= present
        else ""
    )
    if said:
        raise ArchiveError(f"{name}: {said}")


def _known(present: set[str]) -> frozenset[str]:
    own = {name for name in present if name.startswith((OBSERVED, PARAMETER))}
    check_names("column", [name.partition("_")[2] for name in sorted(own)])
    return frozenset(own | (LATER & present))
