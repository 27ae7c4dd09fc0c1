"""`follow`: a path in unknowns that are chosen anew along it, as meshes are that are to suit the point.

A path is a plain trace for a number of steps; then the homotopy is asked for another one in better unknowns, whose path
goes on from there. Nothing in a trace knows of it.
"""

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
    """Unknowns that suit a part of a path only; found by presence, and asked for by `follow`."""

    renewed_at: Sequence[str]
    """Names of events of its own that end a trace because other unknowns are due."""

    def renewed(self, u: Array, v: Array) -> tuple[Any, Array, Array]:
        """Another homotopy, of as many unknowns, and the same point and direction of the path in its unknowns.

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
    """A path in several homotopies' unknowns, one after another.

    Attributes
    ----------
    homotopies : tuple
    paths : tuple of Path
        As many; each begins where the one before ends, in other unknowns.
    """

    homotopies: tuple[Any, ...]
    paths: tuple[Path, ...]
    path: Path = field(init=False, repr=False)
    """All steps and events as one path, for pictures and tables: what is observed has one meaning all along."""

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
        """The homotopy in whose unknowns an event, or a step, of `path` is.

        Parameters
        ----------
        event : LocatedEvent or Step
        """
        number = event.index if isinstance(event, Step) else event.step if isinstance(event, LocatedEvent) else -1
        if not 0 <= number < len(self.path):
            raise complain(ValueError, "event", "an event or a step of this path", event)
        # A part ends with the point from which the next one goes on, in unknowns of its own.
        ends = np.cumsum([len(path) - 1 for path in self.paths])
        return self.homotopies[int(np.searchsorted(ends, number))]


@documented
def follow(
    homotopy: Any, *, every: int = 5, archive: str | PathLike[str] | None = None, **options: Unpack[Options]
) -> Followed:
    """Trace a path, and have the homotopy renewed after every few steps: on a mesh that suits the point, say.

    A closed curve is not recognised beyond one renewal, and events' occurrences are counted anew behind each. Budgets
    of anything but steps hold for the part between two renewals.

    Parameters
    ----------
    homotopy : Homotopy
        With `renewed` and `renewed_at`.
    every : int, default 5
        Steps between two renewals.
    archive : path, default None
        A new HDF5 file, which gets the parts as paths. If it is cut off, `continuation.archive.resume` goes on with the
        last part in its own unknowns.
    {options}

    Returns
    -------
    Followed

    Raises
    ------
    TypeError, ValueError
        For bad input, as `trace` does.
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
            # A trace begins with short steps; this one goes on.
            asked["controller"] = evolve(controller, bounds=evolve(controller.bounds, initial=last.step_length))
