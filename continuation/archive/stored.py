"""Steps of a path that stay in the archive: read when they are asked for, so that a long path needs no memory."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from pathlib import Path as File
from typing import Any, overload

import numpy as np

from continuation.archive.rows import from_columns
from continuation.archive.schema import ACCEPTED, KINK_PART
from continuation.archive.tables import OpenArchive
from continuation.path import LocatedEvent, Step

_WINDOW = 4096
"""Rows that are read at once."""

_COLUMNS = {"u": ("y", "parameter"), "arclength": ("arclength",)}
"""What of a step is a column of the file. A tangent may be in memory alone."""


Opener = Callable[[File], AbstractContextManager[Any]]
"""Opens an archive: `continuation.archive.open_archive`, which this module is too low to know."""


def kept_every(keep: str) -> int:
    """How many steps apart those lie that stay in memory: 1 for ``"all"``, 0 for ``"ends"``, k for ``"every k"``.

    Raises `ValueError` for anything else.
    """
    if keep in ("all", "ends"):
        return int(keep == "all")
    every = re.fullmatch(r"every ([1-9]\d{0,17})", keep) if isinstance(keep, str) else None
    if every is None:
        raise ValueError(f'keep: expected "all", "ends" or "every k", found {keep!r}')
    return int(every[1])


class StoredSteps(Sequence[Step]):
    """The steps of a path as a sequence: some in memory, the others read from the file.

    While the path is traced, `append` adds to it, and what is not yet committed is in memory. A step that is read has
    the segment to the step before only if the archive holds tangents. `every` is as `kept_every` has it; 0 keeps the
    first and the last.
    """

    def __init__(self, opener: Opener, file: File, path: int, every: int) -> None:
        self._opener, self._file, self._path, self._every = opener, file, path, every
        self._memory: dict[int, Step] = {}
        self._recent: list[int] = []
        self._located: list[int] = []
        self._count = 0

    # -- while it grows ---------------------------------------------------------------------------------------

    def append(self, step: Step) -> None:
        """The next step."""
        self._memory[self._count] = step
        self._recent.append(self._count)
        self._count += 1

    def locate(self, after: bool = False) -> None:
        """An event has got a row of its own, before the last step; or, `after` it, a part of a kink has."""
        self._located.append(self._count - (not after))

    def committed(self) -> None:
        """The file holds all of it: what is not to be kept can go, but for the last step."""
        for index in self._recent[:-1]:
            if index and (not self._every or index % self._every):
                del self._memory[index]
        self._recent = self._recent[-1:]

    def known(self, roles: Any, ends: Sequence[Step]) -> None:
        """Begin with what a file holds already: the roles of the path's rows, and its first and last step."""
        places = np.flatnonzero(roles != ACCEPTED)
        self._located = (places - np.arange(len(places))).tolist()
        self._count = len(roles) - len(places)
        self._memory = {step.index: step for step in ends}
        self._recent = [self._count - 1] if self._count else []

    # -- the sequence -----------------------------------------------------------------------------------------

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> Step: ...

    @overload
    def __getitem__(self, index: slice) -> list[Step]: ...

    def __getitem__(self, index: int | slice) -> Step | list[Step]:
        if isinstance(index, slice):
            wanted = range(*index.indices(self._count))
            if not wanted:
                return []
            first, last = min(wanted[0], wanted[-1]), max(wanted[0], wanted[-1])
            between = list(self._between(first, last + 1))
            return [between[i - first] for i in wanted]
        if not -self._count <= index < self._count:
            raise IndexError(f"index: expected a step below {self._count}, found {index}")
        index %= self._count
        return self._memory[index] if index in self._memory else next(self._between(index, index + 1))

    def __iter__(self) -> Iterator[Step]:
        return self._between(0, self._count)

    def __repr__(self) -> str:
        return f"<{self._count} steps in {self._file}, {len(self._memory)} of them in memory>"

    def column(self, name: str) -> Any:
        """One number or vector of all steps, as an array: ``u``, ``tangent`` or ``arclength``."""
        parts, begin = [], 0
        if name in _COLUMNS and self._recent and self._recent[0]:
            begin = self._recent[0]
            parts = list(self._stored(_COLUMNS[name], begin))
        for k in range(begin, self._count, _WINDOW):
            parts.append(np.array([getattr(step, name) for step in self[k : k + _WINDOW]]))
        return np.concatenate(parts) if parts else np.empty(0)

    def _stored(self, columns: Sequence[str], count: int) -> Iterator[np.ndarray[Any, Any]]:
        """Columns of the first steps as the file has them: to make steps of them takes 14 times as long."""
        with self._opener(self._file) as archive:
            rows = archive.rows(self._path)
            stop = rows.start + self._row(count - 1) + 1
            for start in range(rows.start, stop, _WINDOW):
                part = slice(start, min(start + _WINDOW, stop))
                steps = archive.points.some("role", part) == ACCEPTED
                found = [archive.points.some(column, part)[steps] for column in columns]
                yield found[0] if len(found) == 1 else np.column_stack(found)

    def _between(self, start: int, stop: int) -> Iterator[Step]:
        i = start
        while i < stop:
            while i < stop and i in self._memory:
                yield self._memory[i]
                i += 1
            j = i
            while j < min(stop, i + _WINDOW) and j not in self._memory:
                j += 1
            if j > i:
                yield from self._read(i, j)
                i = j

    def _row(self, index: int) -> int:
        """Of a step among the path's rows: each event before it has one too."""
        return index + bisect_left(self._located, index + 1)

    def _read(self, start: int, stop: int) -> list[Step]:
        before = max(start - 1, 0)
        with self._opener(self._file) as archive:
            steps, _ = window(archive, self._path, self._row(before), self._row(stop - 1) + 1, before)
        return steps[start - before :]


def window(archive: OpenArchive, path: int, start: int, stop: int, index: int) -> tuple[list[Step], list[LocatedEvent]]:
    """Steps and events of some rows of a path; `index` is that of the first step among them."""
    first = archive.rows(path).start
    block = archive.points.block(slice(first + start, first + stop))
    return from_columns(block, archive.event_names, archive.layout.observed, index)


def events(archive: OpenArchive, path: int) -> list[LocatedEvent]:
    """The events of a path, without its steps."""
    rows = archive.rows(path)
    size = rows.stop - rows.start
    found: list[LocatedEvent] = []
    steps = 0
    stop = 0
    while stop < size:
        start, stop = stop, min(stop + _WINDOW, size)
        # A kink and its parts stay together.
        while stop < size and archive.points.some("role", slice(rows.start + stop, rows.start + stop + 1)) == KINK_PART:
            stop += 1
        part = slice(rows.start + start, rows.start + stop)
        if np.any(archive.points.some("event_index", part) >= 0):
            found += window(archive, path, start, stop, steps)[1]
        steps += int(np.count_nonzero(archive.points.some("role", part) == ACCEPTED))
    return found


def stored_path(archive: OpenArchive, opener: Opener, file: File, path: int, every: int = 0) -> StoredSteps:
    """The steps of a path in an archive, of which only the ends are in memory."""
    rows = archive.rows(path)
    size = rows.stop - rows.start
    roles = archive.points.some("role", rows)
    steps = StoredSteps(opener, file, path, every)
    ends: list[Step] = []
    accepted = np.flatnonzero(roles == ACCEPTED)
    if len(accepted):
        ends += window(archive, path, int(accepted[0]), int(accepted[0]) + 1, 0)[0]
        last = len(accepted) - 1
        if last:
            ends += window(archive, path, int(accepted[last - 1]), size, last - 1)[0][1:2]
    steps.known(roles, ends)
    return steps
