"""Ctrl-C during a trace, as an exception that has the path so far."""

from __future__ import annotations

from collections.abc import Sequence

from continuation.path import Path


class Interrupted(KeyboardInterrupt):
    """Ctrl-C reached a trace: nothing that was traced is lost.

    Attributes
    ----------
    path : Path
        All accepted points, with the status INTERRUPTED.
    paths : sequence of Path
        From a sweep: the paths before it, and it.
    """

    def __init__(self, path: Path, paths: Sequence[Path] = ()) -> None:
        self.path = path
        self.paths = tuple(paths) or (path,)
        super().__init__(path, self.paths)

    def __str__(self) -> str:
        points = sum(map(len, self.paths))
        where = f", the last at lam = {self.path.endpoint.lam:.6g}" if len(self.path) else ""
        return f"interrupted after {points} points{where}"
