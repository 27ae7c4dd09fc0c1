"""Branches, their special points, and plots."""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np
from attrs import evolve, field, frozen

from continuation.archive.growing import save_all
from continuation.arrays import Array
from continuation.counts import Counts
from continuation.metric import norm
from continuation.path import LocatedEvent, Path, Step
from continuation.plot.bifurcation import Value, at_event, plot_bifurcation
from continuation.plot.drawing import Axes
from continuation.point.segment import hermite
from continuation.status import Kind

LABELS = {
    Kind.TURNING_POINT: "LP",
    Kind.BRANCH_POINT: "BP",
    Kind.SINGULAR_POINT: "BP",
    Kind.HOPF: "HB",
    Kind.KINK: "KP",
}
"""Labels as in AUTO (limit point, branch point, Hopf bifurcation); KP is a kink."""


@frozen(eq=False)
class Branch:
    """A smooth curve, followed both ways.

    Attributes
    ----------
    path : Path
    origin : str
        Label of the point where it leaves; empty for starts and deflation.
    generation : int
        Number of such points between it and the start.
    """

    path: Path
    origin: str
    generation: int


@frozen(eq=False)
class Special:
    """A point of a diagram.

    Attributes
    ----------
    label : str
        LP, BP, HB or KP with a number.
    event : LocatedEvent
        As first found.
    branches : tuple of int
        Numbers of the branches through it.
    """

    label: str
    event: LocatedEvent
    branches: tuple[int, ...]


@frozen(eq=False)
class Diagram:
    """Connected branches.

    Attributes
    ----------
    branches : list of Branch
        In order of discovery, breadth first.
    points : list of Special
        Turning points, branch points, Hopf points and kinks, each once.
    complete : bool
        Whether all branches were followed to the box, to infinity or back to themselves.
    message : str
        Reason.
    counts : Counts
        Of all traces, discarded ones included.
    """

    branches: list[Branch] = field(factory=list)
    points: list[Special] = field(factory=list)
    complete: bool = True
    message: str = ""
    counts: Counts = field(factory=Counts)

    def __len__(self) -> int:
        return len(self.branches)

    def __repr__(self) -> str:
        return f"<Diagram: {len(self)} branches, {len(self.points)} points, {'' if self.complete else 'not '}complete>"

    @property
    def paths(self) -> list[Path]:
        """The branches' paths."""
        return [branch.path for branch in self.branches]

    def of_kind(self, kind: Kind) -> list[Special]:
        """Points of a kind.

        Parameters
        ----------
        kind : Kind
        """
        return [point for point in self.points if point.event.kind == kind]

    def at(self, lam: float) -> Array:
        """Solutions at a parameter value, interpolated, shape (k, N).

        Parameters
        ----------
        lam : float
        """
        found = [path.crossings(lam)[:, :-1] for path in self.paths]
        return np.vstack([y for y in found if len(y)]) if any(map(len, found)) else np.empty((0, 0))

    def plot(self, axes: Axes | None = None, *, value: Value = None, labels: bool = True, **options: Any) -> Axes:
        """Draw one number of all branches against the parameter, solid where stable.

        Parameters
        ----------
        axes : matplotlib Axes, optional
        value : int, str or callable, optional
            As for `continuation.plot.plot_bifurcation`.
        labels : bool
            Name the points.
        **options
            As for `plot_bifurcation`.
        """
        drawn = [evolve(path, events=[e for e in path.events if e.kind in LABELS]) for path in self.paths]
        axes = plot_bifurcation(drawn, axes, value=value, **{"legend": False, **options})
        if labels:
            along = options.get("against", "lam") == "lam"
            for point in self.points:
                event = point.event
                place = (event.lam if along else event.arclength, at_event(event, self.paths[point.branches[0]], value))
                axes.annotate(point.label, place, xytext=(4, 4), textcoords="offset points", fontsize="x-small")
        return axes

    def save(self, file: str | PathLike[str], title: str = "") -> None:
        """Write the branches to a new archive, a path each.

        Parameters
        ----------
        file : path
            Must not exist.
        title : str
        """
        save_all(self.paths, file, title or "A diagram")


def from_point(event: LocatedEvent, ray: Array, path: Path, weights: Array) -> Path:
    """Extend a path along `ray` to the branch point beside which it starts."""
    first = path.steps[0]
    chord = first.u - event.u
    length = norm(weights, chord)
    if length == 0.0:
        return path
    here = Step(0, event.u, ray, 0.0, 0.0, event.residual_norm, first.orientation, Kind.START, observed=event.observed)
    arc = hermite(event.u, ray, first.u, first.tangent, weights * ray)
    moved = [evolve(step, index=step.index + 1, arclength=step.arclength + length) for step in path.steps]
    moved[0] = evolve(moved[0], kind=Kind.REGULAR, step_length=length, segment=arc, weights=weights)
    events = [evolve(e, step=e.step + 1, arclength=e.arclength + length) for e in path.events]
    return evolve(path, steps=[here, *moved], events=events)
