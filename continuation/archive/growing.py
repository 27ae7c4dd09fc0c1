"""A file that finished paths are added to, one by one."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import closing
from copy import deepcopy
from pathlib import Path as File
from types import TracebackType
from typing import Any

from attrs import define, evolve

from continuation.archive.atomic import beside
from continuation.archive.copies import everything, write_copy
from continuation.archive.live import create, publish_live
from continuation.archive.memory import append, layout_of
from continuation.archive.provenance import history, process
from continuation.archive.reader import open_archive
from continuation.archive.recover import own
from continuation.archive.resume import check_homotopy
from continuation.archive.store import Store
from continuation.archive.stored import StoredSteps
from continuation.path import Path


@define(eq=False)
class Growing:
    """An archive of finished paths: a kill loses none that was added. As a context manager it is closed at the end.

    With `pieces` kinks are kept with their switches and rays. What of a path stays in memory is `keep`: "all" steps,
    or the "ends".
    """

    file: File
    title: str
    pieces: bool
    keep: str = "all"
    _store: Store | None = None
    _identifier: str = ""

    def held(self, homotopy: Any) -> Iterator[tuple[Path, Path]]:
        """The paths of the file, if there is one, each whole and as it is kept; the file goes on from then on.

        It goes on as a copy that takes its place when all paths have been read, in one go.
        """
        if not self.file.exists():
            return
        target = File(os.path.realpath(self.file))
        with open_archive(target) as source, closing(own(source.contents, target)), beside(target) as part:
            if len(source):
                last = source[-1].endpoint
                check_homotopy(homotopy, last.u, last.residual_norm)
            for number, path in enumerate(source):
                # A point that was read is part of an array, which would stay in memory with it.
                ends = path if self.keep == "all" else deepcopy(evolve(path, steps=[path.steps[0], path.steps[-1]]))
                yield path, self._kept(ends, number, source.points.some("role", source.rows(number)))
            attributes = {**source.attributes, **process(), **history(source.attributes, "went on")}
            store = write_copy([everything(source)], part, attributes=attributes)
            self._store, self._identifier = publish_live(store, target, replace=True), attributes["identifier"]

    def add(self, path: Path) -> Path:
        """One more path, which comes back as it is kept; the first makes the file."""
        if self._store is None:
            layout, attributes = layout_of(path, self.title, self.pieces)
            self._store, self._identifier = create(self.file, layout, attributes), attributes["identifier"]
        number = self._store.committed.paths
        roles = append(self._store, path, f"{self._identifier} {number} {self.file.name}")
        return self._kept(path, number, roles)

    def _kept(self, path: Path, number: int, roles: Any) -> Path:
        if self.keep == "all":
            return path
        steps: Any = StoredSteps(open_archive, self.file, number, 0)
        steps.known(roles, (path.steps[0], path.steps[-1]))
        return evolve(path, steps=steps)

    def __enter__(self) -> Growing:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._store is not None:
            self._store.close()
