"""`follow`: a path in unknowns renewed along it, such as adapted meshes."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from os import PathLike
from typing import Any, Protocol, Unpack, runtime_checkable

import numpy as np
from attrs import evolve, field, frozen

from continuation.archive.atomic import as_file
from continuation.archive.writer import PathLog
from continuation.arguments.checks import complain, instance_with
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.path import LocatedEvent, Path, Step
from continuation.path.parts import shifted
from continuation.status import Status
from continuation.step.options import Options, check_names, checked, documented
from continuation.step.presets import DEFAULT
from continuation.tracing import trace


@runtime_checkable
class SupportsRenewal(Protocol):
    """Unknowns that suit a part of a path, for `follow`."""

    renewed_at: Sequence[str]
    """Own events that end a trace for renewal."""

    def renewed(self, u: Array, v: Array) -> tuple[Any, Array, Array]:
        """Return another homotopy of equal size, and point and direction in its unknowns.

        Parameters
        ----------
        u, v : ndarray, shape (N + 1,)

        Raises
        ------
        ArithmeticError
            If there is none.
        """
        ...


@frozen(eq=False)
class Followed:
    """A path in the unknowns of several homotopies.

    Attributes
    ----------
    homotopies : tuple
    paths : tuple of Path
        One for each.
    """

    homotopies: tuple[Any, ...]
    paths: tuple[Path, ...]
    path: Path = field(init=False, repr=False)
    """All steps and events as one path."""

    @path.default
    def _path(self) -> Path:
        first, *others = self.paths
        steps, events = list(first.steps), list(first.events)
        for path in others:
            more, met = shifted(steps[-1], path.steps, path.events)
            steps, events = steps + more, events + met
        last = self.paths[-1]
        return evolve(
            last,
            steps=steps,
            events=events,
            counts=sum((path.counts for path in others), first.counts),
            seconds=sum(path.seconds for path in self.paths),
        )

    def homotopy_of(self, event: Any) -> Any:
        """Return the homotopy of an event or step of `path`.

        Parameters
        ----------
        event : LocatedEvent or Step
        """
        number = event.index if isinstance(event, Step) else event.step if isinstance(event, LocatedEvent) else -1
        if not 0 <= number < len(self.path):
            raise complain(ValueError, "event", "an event or a step of this path", event)
        # The last point of a part has the part's unknowns.
        ends = np.cumsum([len(path) - 1 for path in self.paths])
        return self.homotopies[int(np.searchsorted(ends, number))]


@documented
def follow(
    homotopy: Any, *, every: int = 5, archive: str | PathLike[str] | None = None, **options: Unpack[Options]
) -> Followed:
    """Trace a path and renew the homotopy, for example its mesh, every few steps.

    Closed curves, event occurrences and budgets other than steps concern one part only.

    Parameters
    ----------
    homotopy : Homotopy
        With `renewed` and `renewed_at`.
    every : int, default 5
        Steps between renewals.
    archive : path, default None
        New HDF5 file, one path a part; `continuation.archive.resume` continues the last part.
    {options}

    Returns
    -------
    Followed

    Raises
    ------
    TypeError, ValueError
        For bad input, as `trace`.
    ArithmeticError
        If a renewal fails.
    """
    instance_with("homotopy", homotopy, ("renewed", "renewed_at"), "a homotopy that can be renewed")
    check_names(options)
    if not isinstance(every, int) or isinstance(every, bool) or every < 1:
        raise complain(ValueError, "every", "a positive integer", every)
    given = checked(options)["budget"] or Budget()
    homotopies, left, asked = [homotopy], given.steps, dict[str, Any](options)
    paths: list[Path] = []
    with nullcontext() if archive is None else PathLog(as_file("archive", archive)) as log:
        while True:
            steps = min(every, left)
            path = trace(homotopies[-1], archive=log, **{**asked, "budget": evolve(given, steps=steps)})
            paths.append(path)
            left -= path.counts.accepted
            due = path.status is Status.BUDGET_EXHAUSTED and path.counts.accepted >= steps
            if path.status is Status.STOPPED_AT_EVENT:
                due = path.events[-1].name in homotopies[-1].renewed_at
            if not due or left <= 0:
                return Followed(tuple(homotopies), tuple(paths))
            last = path.steps[-1]
            renewed, *asked["start"] = homotopies[-1].renewed(last.u, last.tangent)
            homotopies.append(renewed)
            controller: Any = asked.get("controller") or (asked.get("preset") or DEFAULT).controller
            # A new trace would begin with short steps.
            asked["controller"] = evolve(controller, bounds=evolve(controller.bounds, initial=last.step_length))
