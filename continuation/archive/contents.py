"""What a file holds, taken from it piece by piece and checked: the one place where an archive is read from HDF5."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any, TypeVar

import numpy as np

from continuation.archive.atomic import as_file, short
from continuation.archive.checkpoint import HEAD
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
from continuation.archive.datasets import DATASET_BYTES, StructureError, check_size, dataset, names, subgroup
from continuation.archive.errors import ArchiveError
from continuation.archive.files import FAULTS, WRITER_SECONDS, open_for_reading
from continuation.archive.locks import is_held
from continuation.archive.problem import GROUP as PROBLEM
from continuation.archive.problem import read_problem
from continuation.archive.schema import EVENT_NAME, KINK_COLUMNS, ORIGIN_COLUMNS, TANGENT_COLUMNS, Column, Layout
from continuation.archive.structure import RESUME, SLOTS

Array = np.ndarray[Any, Any]
_T = TypeVar("_T")


class Contents:
    """An open file.

    `limit`: Bytes that one compressed dataset may unfold to. `salvage`: Whether to go on where the end of the file is
    missing, or its attributes, names or problem are not what was written: rows are checked all the same. `checked`:
    Whether it has checksums; files of the schema `continuation-path-1` have none. `flaws`: What was passed over. Raises
    `ArchiveError` for anything wrong with it, here and in the methods.
    """

    def __init__(self, file: str | PathLike[str], *, limit: int = DATASET_BYTES, salvage: bool = False) -> None:
        self.file, self._limit, self._salvage = as_file("file", file), limit, salvage
        self.flaws: list[str] = []
        self._open()
        try:
            self._guarded(self._read_structure)
        except BaseException:
            self.close()
            raise

    def _open(self) -> None:
        self._h5, self._image = open_for_reading(self.file, truncated=self._salvage)
        self._datasets: dict[str, Any] = {}
        self.closed_by_writer = self._image.closed_by_writer
        if self._image.missing:
            self.flaws.append(f"its last {self._image.missing} bytes are missing")

    @property
    def root(self) -> Any:
        """The root of the file, for groups that only some files have."""
        return self._h5

    def close(self) -> None:
        """Close the file."""
        self._h5.close()
        self._image.close()

    def _guarded(self, read: Callable[[], _T]) -> _T:
        """What `read` returns; a file that is being written is given time to be read right."""
        end = time.monotonic() + WRITER_SECONDS
        while True:
            try:
                return read()
            except FAULTS as error:
                if isinstance(error, ArchiveError):
                    raise
                if self.closed_by_writer or time.monotonic() > end or not is_held(self.file):
                    raise self.damaged(error) from error
            self.close()
            self._open()

    def damaged(self, error: BaseException) -> ArchiveError:
        """The error for a file that cannot be read."""
        hint = "; `recover` keeps what is sound" if isinstance(error, DamageError) else ""
        return ArchiveError(f"{self.file}: truncated or damaged ({short(error)}){hint}")

    def _flaw(self, text: str) -> None:
        if not self._salvage:
            raise DamageError(text)
        self.flaws.append(text)

    @property
    def size(self) -> int:
        """Bytes of the file."""
        return self._image.length

    @property
    def descriptor(self) -> int:
        """Of the open file."""
        return self._image.descriptor

    # -- structure --------------------------------------------------------------------------------------------

    def _read_structure(self) -> None:
        file = self._h5
        self.checked = GROUP in file
        self.layout = _layout(file, max(self._limit, self.size))
        self._columns = {
            "point": {column.name: column for column in self.layout.point_columns},
            "path": {column.name: column for column in self.layout.path_columns},
        }
        self._ledgers: dict[str, Ledger] = {}
        self.committed = self._read_committed()
        if self.checked:
            checks = subgroup(file, GROUP)
            sizes = {
                "point": (self.committed.point_blocks, self.committed.points),
                "path": (self.committed.path_blocks, self.committed.paths),
            }
            for table, (blocks, rows) in sizes.items():
                columns = list(self._columns[table])
                sums = dataset(checks, table, np.dtype("u4"), (None, width(columns)), self._limit)
                self._ledgers[table] = Ledger(_rows(sums, blocks, self._limit), columns, rows)
        self.attributes: dict[str, Any] = dict(file.attrs)
        if self.checked and of_attributes(self.attributes) != int(subgroup(file, GROUP).attrs["attributes"]):
            self._flaw("its attributes are not what was written")
        self.event_names = self._read_names()

    def _read_committed(self) -> Committed:
        if self.checked:
            kind, shape = np.dtype("u1"), (2 * PLACES, RECORD_BYTES)
            return latest(dataset(subgroup(self._h5, GROUP), RECORDS, kind, shape, self._limit)[()])
        # Paths first: their rows are counted after the points they need, so this order sees no path without its points.
        paths, points = (
            int(dataset(self._h5, f"committed_{name}", np.dtype("i8"), ())[()]) for name in ("paths", "points")
        )
        if points < 0 or paths < 0:
            raise DamageError(f"it has {points} points and {paths} paths")
        return Committed(points=points, paths=paths)

    def _read_names(self) -> tuple[str, ...]:
        # Raw bytes: h5netcdf, netCDF4 and h5py each decode text in their own way, HDF5 only stores it.
        stored = dataset(self._h5, EVENT_NAME.name, EVENT_NAME.storage, (None,), self._limit)
        count = self.committed.names if self.checked else stored.shape[0]
        raw = _rows(stored.astype(EVENT_NAME.storage), count, self._limit, stored)
        if self.checked:
            sums = _rows(dataset(subgroup(self._h5, GROUP), "event", np.dtype("u4"), (None,), self._limit), count)
            if [digest(raw[k : k + 1]) for k in range(count)] != sums.tolist():
                self._flaw("the names of its events are not what was written")
        return tuple(name.decode(errors="surrogateescape") for name in raw)

    # -- tables -----------------------------------------------------------------------------------------------

    def read(self, table: str, name: str, rows: slice) -> Array:
        """Committed rows of a column of the table ``"point"`` or ``"path"``, checked."""

        def fetch(rows: slice) -> Array:
            return self._fetch(table, name, rows)

        if not self.checked:
            return self._guarded(lambda: fetch(rows))
        return self._guarded(lambda: self._ledgers[table].read(name, rows, fetch))

    def unsound(self, table: str) -> list[tuple[int, int]]:
        """The blocks of rows of which some column is not what was written, or cannot be read at all."""
        if not self.checked:
            return []
        ledger, rows = self._ledgers[table], self.committed.points if table == "point" else self.committed.paths
        found: set[tuple[int, int]] = set()
        for start in range(0, rows, _STRIDE):
            whole = ledger.covering(slice(start, min(start + _STRIDE, rows)))
            for name in self._columns[table]:
                try:
                    found.update(ledger.damaged(name, self._fetch(table, name, whole), whole))
                except FAULTS:
                    found.update(self._one_by_one(table, name, whole))
        return sorted(found)

    def _one_by_one(self, table: str, name: str, rows: slice) -> list[tuple[int, int]]:
        """The unsound blocks among rows that HDF5 does not read in one go."""
        found, ledger, start = [], self._ledgers[table], rows.start
        while start < rows.stop:
            block = ledger.covering(slice(start, start + 1))
            try:
                found += ledger.damaged(name, self._fetch(table, name, block), block)
            except FAULTS:
                found.append((block.start, block.stop))
            start = block.stop
        return found

    def _fetch(self, table: str, name: str, rows: slice) -> Array:
        column = self._columns[table][name]
        found = self._dataset(column)
        if found.shape[0] < rows.stop:
            raise DamageError(f"{name} has fewer rows than were committed")
        row = column.storage.itemsize * int(np.prod(self.layout.width(column)))
        check_size(found, rows.stop * row, self._limit)
        values: Array = (found.astype(column.storage) if column.length else found)[rows]
        return values

    def _dataset(self, column: Column) -> Any:
        if column.name not in self._datasets:
            shape = (None, *self.layout.width(column))
            self._datasets[column.name] = dataset(self._h5, column.name, column.storage, shape, self._limit)
        return self._datasets[column.name]

    # -- for resuming -----------------------------------------------------------------------------------------

    def slots(self) -> list[bytes]:
        """The two checkpoints, as far as they are there; each says itself whether it is whole."""
        return self._guarded(self._read_slots)

    def _read_slots(self) -> list[bytes]:
        if RESUME not in self._h5:
            return []
        slots = dataset(subgroup(self._h5, RESUME), "slots", np.dtype("u1"), (SLOTS, None), self._limit)
        found = []
        for slot in range(SLOTS):
            head = slots[slot, : HEAD.size].tobytes()
            length = HEAD.unpack(head)[1] if len(head) == HEAD.size else 0
            if 0 < length <= min(slots.shape[1] - HEAD.size, self._image.length):
                found.append(slots[slot, : HEAD.size + length].tobytes())
        return found

    def problem(self) -> tuple[str, Mapping[str, Any]]:
        """The first homotopy's description (JSON), and its arrays."""

        def read() -> tuple[str, Mapping[str, Any]]:
            return read_problem(subgroup(self._h5, PROBLEM) if PROBLEM in self._h5 else None, self.checked, self._limit)

        return self._guarded(read)


_STRIDE = 1 << 16
"""Rows that are checked at once."""


def _rows(found: Any, count: int, limit: int = DATASET_BYTES, stored: Any = None) -> Array:
    """The first rows of a dataset, if they are there."""
    base = found if stored is None else stored
    if base.shape[0] < count:
        raise DamageError(f"{base.name[1:]} has fewer rows than were committed")
    check_size(base, count * int(np.prod(base.shape[1:], dtype=int)) * base.dtype.itemsize, limit)
    values: Array = found[:count]
    return values


def _layout(file: Any, limit: int) -> Layout:
    present = names(file)

    def named(prefix: str) -> tuple[str, ...]:
        return tuple(sorted(name.removeprefix(prefix) for name in present if name.startswith(prefix)))

    y, state = (
        dataset(file, "y", np.dtype("f8"), (None, None)),
        dataset(file, "controller_state", np.dtype("f8"), (None, None)),
    )
    if 8 * (y.shape[1] + state.shape[1]) > limit:
        raise StructureError(f"it claims {y.shape[1]} unknowns, and is too small for one point of them")
    return Layout(
        unknowns=int(y.shape[1]),
        controller=int(state.shape[1]),
        observed=named("observed_"),
        scalars=named("homotopy_"),
        tangents=all(column.name in present for column in TANGENT_COLUMNS),
        pieces=all(column.name in present for column in KINK_COLUMNS),
        origins=all(column.name in present for column in ORIGIN_COLUMNS),
    )
