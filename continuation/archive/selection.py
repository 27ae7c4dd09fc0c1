"""Points of an archive that satisfy what is asked, and the paths that have such points."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from numbers import Integral
from typing import Any

import numpy as np

from continuation.archive import frames
from continuation.archive.schema import KINK_PART
from continuation.archive.stored import OpenArchive
from continuation.arguments.checks import complain, is_number
from continuation.path import Path
from continuation.status import Status


class Selection:
    """Some points of an archive, and the paths they belong to."""

    def __init__(self, archive: OpenArchive, points: Any, paths: Any) -> None:
        self.archive = archive
        self.numbers: list[int] = paths.tolist()
        self.points = archive.points.choose(points)
        self.paths = archive.paths.choose(paths)

    def __len__(self) -> int:
        return len(self.numbers)

    def __iter__(self) -> Iterator[Path]:
        return (self.archive.path(number) for number in self.numbers)

    def __repr__(self) -> str:
        return f"<Selection of {self.archive.file}: {len(self)} paths, {self.points.size} points>"

    def to_xarray(self) -> Any:
        """The selected points and paths as an `xarray.Dataset`; ``path_index`` keeps the numbers of the file."""
        archive = self.archive
        return frames.dataset(self.points, self.paths, archive.event_names, archive.layout.unknowns, archive.attributes)

    def to_dataframe(self) -> Any:
        """The selected points as a `pandas.DataFrame`."""
        return frames.dataframe(self.points)


def selected(archive: OpenArchive, status: Any, kind: Any, event: Any, parameter: Any) -> Selection:
    """What `Archive.select` returns, with its arguments.

    Raises `TypeError` or `ValueError` if one of them is nothing of its kind, or the event does not occur in the file at
    all.
    """
    paths = np.ones(len(archive), dtype=bool)
    if status is not None:
        wanted = list(status) if isinstance(status, Iterable) else [status]
        if not all(isinstance(one, Status) for one in wanted):
            raise complain(TypeError, "status", "a Status, or several", status)
        paths = np.isin(archive.paths["status"], [int(one) for one in wanted])
    points = paths[archive.points["path_index"]] & (archive.points["role"] != KINK_PART)
    if kind is not None:
        if not isinstance(kind, Integral):
            raise complain(TypeError, "kind", "a Kind", kind)
        points &= archive.points["kind"] == kind
    if event is not None:
        if event not in archive.event_names:
            raise ValueError(f"event: expected one of {', '.join(archive.event_names)}, found {event!r}")
        points &= archive.points["event_index"] == archive.event_names.index(event)
    if parameter is not None:
        if not isinstance(parameter, Sequence) or len(parameter) != 2 or not all(map(is_number, parameter)):
            raise complain(TypeError, "parameter", "two numbers, the ends of an interval", parameter)
        low, high = parameter
        points &= (archive.points["parameter"] >= low) & (archive.points["parameter"] <= high)
    if kind is not None or event is not None or parameter is not None:
        paths = np.zeros(len(archive), dtype=bool)
        paths[archive.points["path_index"][points]] = True
    return Selection(archive, np.flatnonzero(points), np.flatnonzero(paths))
