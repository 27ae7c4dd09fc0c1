"""The file being written: data and intent, a flush, then the commit's record (see `hdf5`). SWMR keeps it readable."""

from __future__ import annotations

import os
import weakref
from collections.abc import Callable, Mapping
from functools import lru_cache
from io import BytesIO
from pathlib import Path as File
from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5s, h5t

from continuation.archive.atomic import ArchiveError, Lock, beside, check_new, publish, short
from continuation.archive.hdf5 import (
    GROUP,
    PLACES,
    RECORD,
    RECORDS,
    Committed,
    digest,
    of_attributes,
    seal,
    write_problem,
)
from continuation.archive.provenance import HEAD
from continuation.archive.schema import EVENT_NAME, LIBVER, RESUME, Layout, empty, text

_RECORDS, _SLOTS = f"{GROUP}/{RECORDS}", f"{RESUME}/slots"


def put(
    target: File,
    layout: Layout,
    attributes: Mapping[str, Any],
    problem: tuple[str, Mapping[str, Any]] | None = None,
    fill: Callable[[Store], object] | None = None,
    *,
    compressed: bool = False,
    durable: bool = False,
    replace: bool = False,
    grows: bool = False,
) -> Store:
    """Make and fill a new file beside `target`, then rename it; `grows` leaves it open.

    `problem`: result of `problem_data`. `compressed`: by gzip. `durable`: wait for the disk at each commit.
    """
    if not replace:
        check_new(target)
    with beside(target) as part:
        _write_new(part, layout, attributes, problem, compressed)
        store = Store(part, layout, str(attributes.get("identifier", "")), durable)
        try:
            if fill is not None:
                fill(store)
            if not grows:
                store.close()
            publish(part, target, replace=replace, descriptor=store._lock.descriptor)
        except BaseException:
            store.close()
            raise
        store.file = target
        return store


def _write_new(
    part: File,
    layout: Layout,
    attributes: Mapping[str, Any],
    problem: tuple[str, Mapping[str, Any]] | None,
    compressed: bool,
) -> None:
    # In memory: HDF5 ends the process if writing fails while it closes a file.
    made = BytesIO(empty(layout, compressed))
    with h5py.File(made, "r+", libver=LIBVER) as new:
        new.attrs.update(attributes)
        if problem is not None:
            write_problem(new, *problem)
        new[GROUP].attrs.update({"attributes": np.uint32(of_attributes(attributes))})
    with part.open("xb") as file:
        file.write(made.getbuffer())


Block = Mapping[str, np.ndarray[Any, Any]]


class Store:
    """A file being written, locked until closed."""

    abandoned = False

    def __init__(self, part: File, layout: Layout, identifier: str, durable: bool) -> None:
        self.file, self.layout, self.identifier, self.durable = part, layout, identifier, durable
        self.events, self.committed = list[str](), Committed(sequence=1)
        # No cache: HDF5's default, 1 MiB a column, takes 25 MiB.
        self._h5 = h5py.File(part, "r+", libver=LIBVER, rdcc_nbytes=0)
        _LIVE.add(self)
        columns = [column.name for column in (*layout.columns("point"), *layout.columns("path"), EVENT_NAME)]
        own = [f"{GROUP}/point", f"{GROUP}/path", f"{GROUP}/event", _RECORDS, _SLOTS]
        names = {*columns, *own, "point", "event", "committed_points", "committed_paths"}
        # Before datasets are opened, which this would open again.
        self._h5.swmr_mode = True
        self._lock = Lock(part)
        # h5py's objects cost several times as much.
        self._data = {name: h5d.open(self._h5.id, name.encode()) for name in names}

    def commit(self, points: Block | None = None, paths: Block | None = None, checkpoint: bytes | None = None) -> None:
        """Write rows and a checkpoint, then make them valid; an interrupted commit may be repeated."""
        if self.abandoned:
            raise ArchiveError(f"{self.file}: is not this process's to write: it was forked from the writer")
        before = self.committed
        after = Committed(
            before.sequence + 1,
            before.points + _rows(points),
            before.paths + _rows(paths),
            before.point_blocks + bool(points),
            before.path_blocks + bool(paths),
            len(self.events),
            HEAD.unpack_from(checkpoint)[0] if checkpoint else before.checkpoint,
        )
        try:
            for block, start, table, number in (
                (points, before.points, "point", before.point_blocks), (paths, before.paths, "path", before.path_blocks)
            ):  # fmt: skip
                for name, values in (block or {}).items():
                    self._put(self._data[name], start, values)
                if block:
                    self._put(self._data[f"{GROUP}/{table}"], number, seal(block, start)[None])
            if points:
                self._data["point"].set_extent((after.points,))
            if checkpoint:
                slots = self._data[_SLOTS]
                if slots.shape[1] < len(checkpoint):
                    slots.set_extent((PLACES, 2 * len(checkpoint)))
                _write(slots, slots.shape, (after.checkpoint % PLACES, 0), np.frombuffer(checkpoint, "u1")[None])
            self._record(after, 0)
            self._flush()
            # After an interrupt the next commit continues here.
            self.committed = after
            self._record(after, PLACES)
            for name, count in (("committed_points", after.points), ("committed_paths", after.paths)):
                self._data[name].write(h5s.ALL, h5s.ALL, np.array(count))
            self._flush()
        except (OSError, RuntimeError, ValueError) as error:
            self.abandon()
            reason = f"could not be written ({short(error)}); what was committed is safe"
            raise ArchiveError(f"{self.file}: {reason}") from error

    def _record(self, committed: Committed, first: int) -> None:
        place = first + committed.sequence % PLACES
        _write(self._data[_RECORDS], (2 * PLACES, RECORD.size), (place, 0), committed.pack()[None])

    def name_event(self, name: str) -> int:
        """The number of an event name, which is added if it is new."""
        name = text(name, EVENT_NAME.length).decode()
        if name not in self.events:
            count, stored = len(self.events), np.array([name.encode()], dtype=EVENT_NAME.storage)
            self._data["event"].set_extent((count + 1,))
            self._put(self._data["event_name"], count, stored)
            self._put(self._data[f"{GROUP}/event"], count, np.array([digest(stored)], dtype="u4"))
            self.events.append(name)
        return self.events.index(name)

    @staticmethod
    def _put(dataset: Any, start: int, values: np.ndarray[Any, Any]) -> None:
        extent = (start + len(values), *values.shape[1:])
        dataset.set_extent(extent)
        _write(dataset, extent, (start, *(0,) * (values.ndim - 1)), values)

    def _flush(self) -> None:
        self._h5.flush()
        if self.durable:
            os.fsync(self._h5.id.get_vfd_handle())

    def close(self) -> None:
        """Close the file, idempotently."""
        try:
            self._h5.close()
        except (OSError, RuntimeError):
            if not self.abandoned:
                raise
        finally:
            self._lock.close()

    def abandon(self) -> None:
        """Discard pending writes: HDF5 ends the process if one fails during close."""
        if self._h5:
            nowhere = os.open(os.devnull, os.O_RDWR)
            os.dup2(nowhere, self._h5.id.get_vfd_handle(), inheritable=False)
            os.close(nowhere)
            self.abandoned = True


_LIVE: weakref.WeakSet[Store] = weakref.WeakSet()


def _in_child() -> None:
    """A forked child must not write to inherited stores, or keep their locks."""
    for store in list(_LIVE):
        store.abandon()
        store._lock.close()


os.register_at_fork(after_in_child=_in_child)


@lru_cache(maxsize=64)
def _spaces(extent: tuple[int, ...], place: tuple[int, ...], shape: tuple[int, ...]) -> tuple[Any, Any]:
    space = h5s.create_simple(extent)
    space.select_hyperslab(place, shape)
    return h5s.create_simple(shape), space


_type = lru_cache(maxsize=64)(h5t.py_create)
"""HDF5's type of numbers; making it takes half the time of a write."""


def _write(dataset: Any, extent: tuple[int, ...], place: tuple[int, ...], values: np.ndarray[Any, Any]) -> None:
    """Write values several times faster than h5py's slices."""
    kind = dataset.get_type() if values.dtype.kind == "S" else _type(values.dtype)
    dataset.write(*_spaces(extent, place, values.shape), values, kind)


def _rows(block: Block | None) -> int:
    return len(next(iter(block.values()))) if block else 0
