"""The result of a trace."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise
from os import PathLike
from typing import Any, Protocol, overload, runtime_checkable

import numpy as np
from attrs import define, evolve, field
from scipy.optimize import brentq

from continuation.arguments.checks import complain, real_vector
from continuation.arguments.labels import Labels
from continuation.arrays import Array
from continuation.counts import Counts
from continuation.path.parts import StepsAndEvents, following, part_of, turned_round
from continuation.path.steps import LocatedEvent, Step
from continuation.point.segment import parameter_at
from continuation.rejection import Rejected
from continuation.status import Kind, Status

__all__ = ["LocatedEvent", "Path", "Step"]


@define(eq=False)
class Path:
    """A traced path.

    Attributes
    ----------
    steps : sequence of Step
        Accepted points: a list, or `continuation.archive.reader.StoredSteps`.
    events : list of LocatedEvent
        In path order.
    status : Status
    message : str
        The status in a sentence.
    counts : Counts
    seconds : float
        Wall-clock time.
    references : tuple of str
        BibTeX of homotopy and parts; see `continuation.cite`.
    end_error : float or None
        At the target: bound of the components' absolute error by round-off, or an endgame's estimate.
    winding_number : int or None
        After an endgame: the path is a power series in |lam - target|^(1 / winding_number).
    rejected : tuple of Rejected
        Failed attempts at the last point.
    proof : Proof or None
        If requested (`continuation.certify`).
    labels : Labels
        Names and units.
    """

    steps: list[Step] = field(factory=list)
    events: list[LocatedEvent] = field(factory=list)
    status: Status = Status.TRACING
    message: str = ""
    counts: Counts = field(factory=Counts)
    seconds: float = 0.0
    references: tuple[str, ...] = ()
    end_error: float | None = None
    winding_number: int | None = None
    rejected: tuple[Rejected, ...] = ()
    proof: Any = None
    labels: Labels = field(factory=Labels)

    def __len__(self) -> int:
        return len(self.steps)

    @overload
    def __getitem__(self, index: int) -> Step: ...

    @overload
    def __getitem__(self, index: slice) -> Path: ...

    def __getitem__(self, index: int | slice) -> Step | Path:
        """A step, or the path between two steps; arclengths stay."""
        return self._of(part_of(self.steps, self.events, index)) if isinstance(index, slice) else self.steps[index]

    def _of(self, pieces: StepsAndEvents) -> Path:
        return evolve(self, steps=pieces[0], events=pieces[1])

    def __repr__(self) -> str:
        end = f", lam {self.steps[0].lam:g} -> {self.steps[-1].lam:g}" if self.steps else ""
        return f"<Path {self.status.name}: {len(self.steps)} points{end}, {len(self.events)} events>"

    @property
    def success(self) -> bool:
        """Whether the path ended at its target, a terminal event or its start."""
        return self.status.success

    @property
    def u(self) -> Array:
        """All points, shape (m, N + 1)."""
        return _column(self.steps, "u")

    @property
    def y(self) -> Array:
        """The unknowns, shape (m, N)."""
        return self.u[:, :-1]

    @property
    def lam(self) -> Array:
        """The parameter, shape (m,)."""
        return self.u[:, -1]

    @property
    def arclength(self) -> Array:
        """Arclengths (see `Step`), shape (m,)."""
        return _column(self.steps, "arclength")

    @property
    def tangents(self) -> Array:
        """Unit tangents, shape (m, N + 1)."""
        return _column(self.steps, "tangent")

    @property
    def endpoint(self) -> Step:
        """The last point."""
        if not self.steps:
            raise IndexError(f"the path has no point. {self.message}")
        return self.steps[-1]

    @property
    def turning_points(self) -> list[LocatedEvent]:
        """Turning points of the parameter."""
        return [event for event in self.events if event.turns]

    @property
    def branch_points(self) -> list[LocatedEvent]:
        """Simple branch points."""
        return [event for event in self.events if event.kind == Kind.BRANCH_POINT]

    @property
    def kinks(self) -> list[LocatedEvent]:
        """Points between smooth pieces of the map."""
        return [event for event in self.events if event.kind == Kind.KINK]

    def __call__(self, s: float | Array | None = None, *, t: float | None = None) -> Array:
        """Dense output at arclength s, shape (N + 1,) or (k, N + 1), or the first point with parameter t.

        Raises
        ------
        ValueError
            If s lies outside [0, arclength[-1]], or the parameter is never t.
        IndexError
            If the path has no points.
        """
        if (s is None) == (t is None):
            raise ValueError("s: expected an arclength, or t in its place, found both or neither")
        if t is not None:
            there = self.crossings(t)
            if not len(there):
                raise ValueError(f"t: expected a value that the parameter takes on the path, found {t:g}")
            first: Array = there[0]
            return first
        wanted, knots = self._places(s)
        points = [self._at(float(value), knots) for value in np.atleast_1d(wanted)]
        return np.array(points) if wanted.ndim else points[0]

    def error_bound(self, homotopy: Any, s: float | Array) -> Array:
        """Bound the distance of ``path(s)`` from the path, by component.

        Two chord steps toward the path are measured, the others bounded if H' changes evenly; infinite if the steps do
        not halve. For proofs see `continuation.certify`.

        Parameters
        ----------
        homotopy : Homotopy
        s : float or ndarray, shape (k,)
            Arclengths.

        Returns
        -------
        ndarray, shape (N + 1,) or (k, N + 1)
        """
        from continuation.path.refining import error_bound

        wanted, knots = self._places(s)
        values = np.atleast_1d(wanted)
        ends = [self._end(float(value), knots) for value in values]
        bounds = error_bound(homotopy, self.steps, self(values), ends)
        return bounds if wanted.ndim else bounds[0]

    def _places(self, s: Any) -> tuple[Array, list[float]]:
        wanted = real_vector("s", s) if np.size(s) else np.zeros(0)
        knots = self.arclength.tolist()
        if not knots:
            raise IndexError("s: expected a path with points, found one without")
        if wanted.size and not (wanted.min() >= knots[0] and wanted.max() <= knots[-1] * (1 + 1e-15)):
            found = f"{wanted.min():g} .. {wanted.max():g}"
            raise ValueError(f"s: expected values in [{knots[0]:g}, {knots[-1]:g}], found {found}")
        return wanted, knots

    def _end(self, s: float, knots: list[float]) -> int:
        return min(max(bisect_right(knots, s), 1), len(knots) - 1)

    def crossings(self, t: float) -> Array:
        """All points with parameter t, in order, shape (k, N + 1).

        Both ends of an arc with constant parameter t count.

        Parameters
        ----------
        t : float
        """
        found = [step.u for step in self.steps[:1] if step.lam == t]
        for before, after in pairwise(self.steps):
            curve = _curve(before, after)
            places = (0.0, *(() if after.segment is None else after.segment.inside), 1.0)
            off = [before.lam - t, *(float(curve(place)[-1]) - t for place in places[1:-1]), after.lam - t]
            for (a, at_a), (b, at_b) in pairwise(zip(places, off)):
                if at_a * at_b < 0.0:
                    line = after.segment is None
                    place = a + (b - a) * at_a / (at_a - at_b) if line else brentq(_off, a, b, (curve, t), xtol=1e-15)
                    found.append(np.append(curve(place)[:-1], t))
                elif at_b == 0.0:
                    found.append(np.append(curve(b)[:-1], t))
        size = self.steps[0].u.size if self.steps else 0
        return np.array(found).reshape(-1, size)

    def _at(self, s: float, knots: list[float]) -> Array:
        i = self._end(s, knots)
        if len(knots) == 1:
            return self.steps[0].u
        segment, weights = self.steps[i].segment, self.steps[i].weights
        fraction = (s - knots[i - 1]) / (knots[i] - knots[i - 1])
        if segment is None:
            return (1 - fraction) * self.steps[i - 1].u + fraction * self.steps[i].u
        # Archives keep no metric; the fraction is exact at knots.
        return segment.at(fraction if weights is None else parameter_at(segment, weights, fraction))

    def reversed(self) -> Path:
        """The path from end to start."""
        return self._of(turned_round(self.steps, self.events))

    def join(self, other: Path) -> Path:
        """Append a path that begins at this one's end.

        Parameters
        ----------
        other : Path

        Raises
        ------
        ValueError
            If it begins elsewhere.
        """
        if not len(self) or not len(other):
            return self if len(self) else other
        extent = max(float(np.ptp(path.u, axis=0).max()) for path in (self, other))
        steps, events = following(self.steps, other.steps, other.events, extent)
        whole = other._of(([*self.steps, *steps], [*self.events, *events]))
        whole.counts, whole.seconds = self.counts + other.counts, self.seconds + other.seconds
        whole.references = tuple(dict.fromkeys((*self.references, *other.references)))
        return whole

    def refined(self, homotopy: Any, accuracy: float = 1e-3) -> Path:
        """The path with more points (`refined_path`).

        Parameters
        ----------
        homotopy : Homotopy
        accuracy : float, default 1e-3
        """
        from continuation.path.refining import refined_path

        return self._of(refined_path(homotopy, self.steps, self.events, accuracy))

    def plot(self, axes: Any = None, **options: Any) -> Any:
        """Draw the unknowns, or with ``value=...`` a diagram.

        Parameters
        ----------
        axes : matplotlib Axes, optional
        **options
            As for `continuation.plot.plot_components`, with `value` for `plot_bifurcation`.
        """
        from continuation.plot import plot_bifurcation, plot_components

        return (plot_bifurcation if "value" in options else plot_components)(self, axes, **options)

    def to_xarray(self) -> Any:
        """An `xarray.Dataset` of points and events, as `Archive.to_xarray`."""
        from continuation.archive import growing

        return growing.dataset_of(self)

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame` of points and events."""
        from continuation.archive import growing

        return growing.dataframe_of(self)

    def save(self, file: str | PathLike[str], title: str = "") -> None:
        """Write the path to a new archive; `resume` needs one of ``trace(archive=...)``.

        Parameters
        ----------
        file : path
            Must not exist.
        title : str
        """
        from continuation.archive import growing

        growing.save_all([self], file, title)

    def _repr_html_(self) -> str:
        from continuation.plot.html import TABLE_ROWS, table

        rows: list[Sequence[object]] = [("message", self.message)]
        name = self.labels.parameter()
        if self.steps:
            first, last = self.steps[0], self.steps[-1]
            rows += [("points", len(self)), (name, f"{first.lam:.6g} to {last.lam:.6g}")]
            rows += [("arclength", f"{last.arclength:.6g}")]
        rows.append(("cost", f"{self.counts.factorizations} factorisations, {self.seconds:.3g} s"))
        page = table(f"Path: {self.status.name}", rows)
        if self.events:
            found = [(e.name, f"{e.lam:.10g}", f"{e.arclength:.6g}") for e in self.events[:TABLE_ROWS]]
            more = len(self.events) - TABLE_ROWS
            page += table("Events" if more <= 0 else f"Events, {more} more", found, ("event", name, "arclength"))
        return page


@runtime_checkable
class SupportsColumn(Protocol):
    """Steps stored as columns."""

    def column(self, name: str) -> Array:
        """A field of all steps."""
        ...


def _off(place: float, curve: Callable[[float], Array], t: float) -> float:
    return float(curve(place)[-1]) - t


def _curve(before: Step, after: Step) -> Callable[[float], Array]:
    if after.segment is not None:
        return after.segment.at
    return lambda place: before.u if place == 0.0 else before.u + place * (after.u - before.u)


def _column(steps: Any, name: str) -> Array:
    return steps.column(name) if isinstance(steps, SupportsColumn) else np.array([getattr(s, name) for s in steps])


def require_path(path: Any) -> None:
    """Raise unless `path` is a path with two points."""
    if not isinstance(path, Path):
        raise complain(TypeError, "path", "a path, as `trace` gives it", path)
    if len(path) < 2:
        raise ValueError(f"path: expected at least two points, found {len(path)}")
