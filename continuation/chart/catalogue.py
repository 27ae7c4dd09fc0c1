"""The ready studies: found through the entry points `continuation.studies`, so that the engine imports no problems."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib.metadata import EntryPoint, entry_points
from typing import Literal

from continuation.arguments.plugins import grouped, owners
from continuation.chart.study import Study

GROUP = "continuation.studies"
"""Entry points of this group are functions (size, compare) to a sequence of studies, named as the entry point."""

Size = Literal["smoke", "moderate", "full"]
"""For tests, for a few minutes on two cores, for reports."""

Maker = Callable[[Size, bool], Sequence[Study]]
"""(size, compare) to studies; `compare` asks for outside solvers where they are installed."""


def catalogue() -> dict[str, EntryPoint]:
    """The ready studies by name, in alphabetical order; none is imported yet.

    Raises `ValueError` if two distributions provide a study of the same name.
    """
    found = grouped(entry_points(group=GROUP))
    for name, points in found.items():
        if len(points) > 1:
            raise ValueError(f"{name}: expected one package that provides this study, found {owners(points)}")
    return {name: points[0] for name, points in sorted(found.items())}


def studies(name: str, size: Size = "moderate", compare: bool = False) -> Sequence[Study]:
    """The studies behind a name.

    `name`: One of `catalogue`. `compare`: Ask for outside solvers too. Raises `ValueError` if there is no such name.
    """
    known = catalogue()
    if name not in known:
        raise ValueError(f"NAME: expected one of {', '.join(known) or '(none installed)'}, found {name!r}")
    make: Maker = known[name].load()
    return make(size, compare)
