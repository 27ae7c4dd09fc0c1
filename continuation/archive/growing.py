"""A file that finished paths are added to, one by one."""

from __future__ import annotations

import os
from contextlib import closing
from pathlib import Path as File
from types import TracebackType
from typing import Any

from attrs import define

from continuation.archive.atomic import beside
from continuation.archive.copies import everything, write_copy
from continuation.archive.live import create, publish_live
from continuation.archive.memory import append, layout_of
from continuation.archive.provenance import history, process
from continuation.archive.reader import open_archive
from continuation.archive.recover import own
from continuation.archive.resume import check_homotopy
from continuation.archive.store import Store
from continuation.path import Path


@define(eq=False)
class Growing:
    """An archive of finished paths: a kill loses none that was added. As a context manager it is closed at the end.

    With `pieces` kinks are kept with their switches and rays.
    """

    file: File
    title: str
    pieces: bool
    _store: Store | None = None
    _identifier: str = ""

    def held(self, homotopy: Any) -> list[Path]:
        """The paths of the file, if there is one, which goes on from now on: as a copy that takes its place."""
        if not self.file.exists():
            return []
        target = File(os.path.realpath(self.file))
        with open_archive(target) as source, closing(own(source.contents, target)), beside(target) as part:
            paths = list(source)
            for path in paths[-1:]:
                check_homotopy(homotopy, path.endpoint.u, path.endpoint.residual_norm)
            attributes = {**source.attributes, **process(), **history(source.attributes, "went on")}
            store = write_copy([everything(source)], part, attributes=attributes)
            self._store, self._identifier = publish_live(store, target, replace=True), attributes["identifier"]
            return paths

    def add(self, path: Path) -> None:
        """One more path; the first makes the file."""
        if self._store is None:
            layout, attributes = layout_of(path, self.title, self.pieces)
            self._store, self._identifier = create(self.file, layout, attributes), attributes["identifier"]
        append(self._store, path, f"{self._identifier} {self._store.committed.paths} {self.file.name}")

    def __enter__(self) -> Growing:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._store is not None:
            self._store.close()
