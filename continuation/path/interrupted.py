"""Ctrl-C during a trace, as an exception."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from continuation.path.path import Path


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a trace.

    Attributes
    ----------
    path : Path
        The path so far.
    paths : sequence of Path
        The paths of a sweep.
    diagram : Diagram or None
        Finished branches.
    """

    def __init__(self, path: Path, paths: Sequence[Path] = (), diagram: Any = None) -> None:
        self.path = path
        self.paths = tuple(paths) or (path,)
        self.diagram = diagram
        super().__init__(path, self.paths, diagram)

    def __str__(self) -> str:
        points = sum(map(len, self.paths))
        where = f", the last at lam = {self.path.endpoint.lam:.6g}" if len(self.path) else ""
        return f"interrupted after {points} points{where}"
