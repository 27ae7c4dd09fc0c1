"""What a search for branches gives: the branches, the points where they meet or turn, and a picture of them."""

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
"""What points are called, with a number: as in AUTO (limit point, branch point, Hopf bifurcation); KP is a kink."""


@frozen(eq=False)
class Branch:
    """A branch: one smooth curve through the point from which it was found, as far as it was followed to both sides.

    Attributes
    ----------
    path : Path
    origin : str
        Label of the point from which it was found; empty for one that was given, or found by deflation.
    generation : int
        How many such points lie between it and the start.
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
        As it was found first.
    branches : tuple of int
        The numbers of the branches through it.
    """

    label: str
    event: LocatedEvent
    branches: tuple[int, ...]


@frozen(eq=False)
class Diagram:
    """Branches that hang together.

    Attributes
    ----------
    branches : list of Branch
        In the order in which they were found, breadth first.
    points : list of Special
        Turning points, branch points, Hopf points and kinks, each once.
    complete : bool
        Whether every branch was followed to the box, to infinity or back to itself, from every point where one leaves.
    message : str
        That, or what is missing.
    counts : Counts
        Of all traces, those of branches that turned out to be known among them.
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
        """The paths of the branches."""
        return [branch.path for branch in self.branches]

    def of_kind(self, kind: Kind) -> list[Special]:
        """The points of a kind.

        Parameters
        ----------
        kind : Kind
        """
        return [point for point in self.points if point.event.kind == kind]

    def at(self, lam: float) -> Array:
        """The solutions at a value of the parameter, between points interpolated, shape (k, N).

        Parameters
        ----------
        lam : float
        """
        found = [path.crossings(lam)[:, :-1] for path in self.paths]
        return np.vstack([y for y in found if len(y)]) if any(map(len, found)) else np.empty((0, 0))

    def plot(self, axes: Axes | None = None, *, value: Value = None, labels: bool = True, **options: Any) -> Axes:
        """Draw one number of all branches against the parameter, solid where stable if that is known.

        Parameters
        ----------
        axes : matplotlib Axes, optional
        value : int, str or callable, optional
            As for `continuation.plot.plot_bifurcation`.
        labels : bool
            Name the points.
        **options
            As for `plot_bifurcation`.

        Returns
        -------
        Axes
        """
        drawn = [evolve(path, events=[e for e in path.events if e.kind in LABELS]) for path in self.paths]
        axes = plot_bifurcation(drawn, axes, value=value, **options)
        if labels:
            along = options.get("against", "lam") == "lam"
            for point in self.points:
                event = point.event
                place = (event.lam if along else event.arclength, at_event(event, self.paths[point.branches[0]], value))
                axes.annotate(point.label, place, xytext=(4, 4), textcoords="offset points", fontsize="x-small")
        return axes

    def save(self, file: str | PathLike[str], title: str = "") -> None:
        """Write all branches to one new archive, a path each.

        Parameters
        ----------
        file : path
            Must not exist.
        title : str
        """
        save_all(self.paths, file, title or "A diagram")


def from_point(event: LocatedEvent, ray: Array, path: Path, weights: Array) -> Path:
    """A path that began beside a branch point, from the branch point on.

    `ray`, of shape (N + 1,): The direction in which it leaves. `weights`, of shape (N + 1,): The metric at the branch
    point.
    """
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
