"""Finished paths as tables."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import closing
from copy import deepcopy
from functools import partial
from os import PathLike
from pathlib import Path as File
from types import TracebackType
from typing import Any

from attrs import define, evolve

from continuation.archive.atomic import new_file, own
from continuation.archive.copies import append, share_of, share_of_path, sourced, write_copy
from continuation.archive.provenance import process, root_attributes
from continuation.archive.reader import StoredSteps, open_archive
from continuation.archive.resume import check_homotopy
from continuation.archive.store import Store, put
from continuation.archive.tables import Table, dataframe, dataset
from continuation.path import Path


def _attributes(path: Path, title: str = "A path") -> dict[str, Any]:
    about = root_attributes(None, title, {})
    return {**about, **path.labels.attributes(), "references": "\n\n".join(path.references)}


def dataset_of(path: Path) -> Any:
    """The path as an `xarray.Dataset`."""
    share, attributes = share_of_path(path), _attributes(path)
    share = sourced(share, attributes["identifier"], "", first=0)
    paths = Table.of(share.layout, "path", share.paths)
    return dataset(share.points, paths, share.names, share.layout.unknowns, attributes)


def dataframe_of(path: Path) -> Any:
    """The path as a `pandas.DataFrame` with names."""
    share = share_of_path(path)
    frame = dataframe(share.points)
    frame["event"] = [share.names[k] if k >= 0 else "" for k in share.points["event_index"]]
    called = {f"y_{i}": name for i, name in enumerate(path.labels.names)}
    if path.labels.parameter_name:
        called["parameter"] = path.labels.parameter_name
    return frame.rename(columns=called)


def save_all(many: Sequence[Path], file: str | PathLike[str], title: str = "") -> None:
    """Write paths of one homotopy to a new archive."""
    target = new_file("file", file)
    pieces = any(event.switches for path in many for event in path.events)
    shares = [share_of_path(path, member=k, pieces=pieces) for k, path in enumerate(many)]

    def write(beside: File) -> Store:
        store = Store(beside, shares[0].layout, _attributes(many[0], title or "A path"))
        for share in shares:
            append(store, share, target.name)
        return store

    put(target, write)


@define(eq=False)
class Growing:
    """An archive of finished paths, safe from kills.

    `pieces`: store switches and rays of kinks. `keep`: steps in memory, "all" or "ends".
    """

    file: File
    title: str
    pieces: bool
    keep: str = "all"
    _store: Store | None = None

    def held(self, homotopy: Any) -> Iterator[tuple[Path, Path]]:
        """The paths of an existing file, whole and as kept; a growing copy then replaces it."""
        if not self.file.exists():
            return
        target = File(os.path.realpath(self.file))
        with (
            open_archive(target) as source,
            closing(own(target, source.contents.descriptor, source.attributes.get("process"))),
        ):
            if len(source):
                last = source[-1].endpoint
                check_homotopy(homotopy, last.u, last.residual_norm)
            for number, path in enumerate(source):
                # A view would keep the whole array in memory.
                yield path, path if self.keep == "all" else deepcopy(self._kept(path, number))
            copy = partial(write_copy, [share_of(source)], what="went on", more=process())
            self._store = put(target, copy, replace=True, grows=True)

    def add(self, path: Path) -> Path:
        """Append a path and return it as kept."""
        share = share_of_path(path, member=self._store.committed.paths if self._store else 0, pieces=self.pieces)
        if self._store is None:
            about = _attributes(path, self.title)
            self._store = put(self.file, partial(Store, layout=share.layout, attributes=about), grows=True)
        return self._kept(path, append(self._store, share, self.file.name))

    def _kept(self, path: Path, number: int) -> Path:
        if self.keep == "all":
            return path
        steps: Any = StoredSteps(self.file, number, [path.steps[0], path.steps[-1]], len(path.steps))
        return evolve(path, steps=steps)

    def __enter__(self) -> Growing:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._store is not None:
            self._store.close()
