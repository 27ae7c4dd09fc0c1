"""`diagram`: a breadth-first search."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

import numpy as np
from attrs import define, evolve, field

from continuation.archive.growing import Growing
from continuation.arguments.labels import Labels
from continuation.arrays import Array
from continuation.branch_switching import metric_at
from continuation.counts import Counts
from continuation.diagrams.branches import LABELS, Branch, Diagram, Special, from_point
from continuation.diagrams.deflation import others, same_solution
from continuation.diagrams.junctions import Junction, directions_of, meetings
from continuation.diagrams.places import PointIndex
from continuation.events.box import is_inside
from continuation.metric import Inherited
from continuation.path import LocatedEvent, Path
from continuation.status import Status
from continuation.step.options import Options
from continuation.step.start import guessed
from continuation.tracing import solve_at, trace

WHOLE = (Status.REACHED_TARGET, Status.STOPPED_AT_EVENT, Status.CLOSED, Status.DIVERGED, Status.DEAD_END)
"""Final states of complete branches."""

LEAVES = 0.1
"""Distance of guesses from known solutions, relative to their spread."""


def _path(homotopy: Any, start: Any, direction: int, options: Options, before: Array | None) -> Path:
    asked = options.copy()
    asked["direction"] = direction
    if start is not None:
        asked["start"] = start
    if before is not None and options.get("metric") is None and getattr(homotopy, "metric", None) is None:
        asked["metric"] = Inherited(before)
    return trace(homotopy, **asked)


@contextmanager
def _ready(executor: Executor | None, asked: dict[Any, tuple[Any, ...]]) -> Iterator[Callable[[Any], Path]]:
    """A function that gives the traces by name: traced when asked for, or ahead by the executor."""
    if executor is None:
        yield lambda name: _path(*asked[name])
        return
    futures = {name: executor.submit(_path, *one) for name, one in asked.items()}
    try:
        yield lambda name: futures[name].result()
    finally:
        for future in futures.values():
            future.cancel()


@define(eq=False)
class BranchSearch:
    """A search in progress.

    `junctions`: those on branches, in order; `places`, all that were met. `points`, `specials`: labels, events and
    numbers of branches of the special points.
    """

    homotopy: Any
    options: Options
    executor: Executor | None
    step: float
    most: int
    log: Growing | None = None
    branches: list[Branch] = field(factory=list)
    junctions: list[Junction] = field(factory=list)
    places: PointIndex[Junction] = field(factory=PointIndex)
    points: dict[str, tuple[LocatedEvent, list[int]]] = field(factory=dict)
    specials: PointIndex[str] = field(factory=PointIndex)
    missing: list[str] = field(factory=list)
    counts: Counts = field(factory=Counts)

    def run(self, starts: list[Any], deflate: list[float]) -> None:
        """Search from all starts, then by deflation."""
        for start in starts:
            self._begin(start)
        for lam in deflate:
            known = self._solutions(lam)
            for y in others(self.homotopy, lam, known, self._guesses(known)):
                self._begin((y, lam))

    @property
    def found(self) -> Diagram:
        """The diagram so far."""
        said = "; ".join(dict.fromkeys(self.missing))
        said = f"Not complete: {said}." if said else "Complete: nothing is left open."
        points = [Special(label, event, tuple(dict.fromkeys(on))) for label, (event, on) in self.points.items()]
        return Diagram(self.branches, points, not self.missing, said, self.counts)

    def _guesses(self, known: list[Array]) -> list[Array]:
        start = np.atleast_1d(np.asarray(self.homotopy.start()[0], dtype=float))
        every = np.array([start, *known])
        apart = np.ptp(every, axis=0)
        beside = LEAVES * np.where(apart > 0.0, apart, 1.0)
        return [start, every.mean(axis=0), *(y + way * beside for y in every for way in (1.0, -1.0))]

    def _begin(self, start: Any) -> None:
        u = np.append(*self.homotopy.start()) if start is None else guessed(start)
        if not self._inside(u):
            raise ValueError(f"box: expected each start inside, found one at lam = {u[-1]:g} on a face or beyond")
        if self._known(u):
            return
        asked = {way: (self.homotopy, start, way, self.options, None) for way in (1, -1)}
        with _ready(self.executor, asked) as traced:
            whole = self._met(traced(1))
            if whole.status is not Status.CLOSED:
                whole = _through(self._met(traced(-1)), whole)
        if len(whole):
            self._add(whole, "", 0)
        self._spread()

    def _inside(self, u: Array) -> bool:
        return is_inside(self.options.get("box"), Labels.of(self.homotopy), u)

    def _known(self, u: Array) -> bool:
        known = self._solutions(float(u[-1]))
        (y,) = self._polished(float(u[-1]), [u[:-1]])
        return any(same_solution(y, other) for other in known)

    def _solutions(self, lam: float) -> list[Array]:
        return self._polished(lam, list(Diagram(self.branches).at(lam)))

    def _polished(self, lam: float, guesses: list[Array]) -> list[Array]:
        """Solve from each guess; keep it if Newton's method fails, as beside a fold."""
        found = []
        for guess in guesses:
            try:
                found.append(solve_at(self.homotopy, lam, guess))
            except ArithmeticError:
                found.append(guess)
        return found

    def _met(self, path: Path) -> Path:
        """The path, after its rays at junctions are marked as used."""
        self.counts = self.counts + path.counts
        if not len(path):
            self.missing.append(path.message)
        for event in meetings(path):
            junction = self._junction(event)
            for direction in directions_of(event, path):
                junction.take(direction)
        return path

    def _junction(self, event: LocatedEvent) -> Junction:
        known = self.places.near(event.u)
        if known:
            return known[0]
        junction = Junction.at(self.homotopy, event, self.step)
        self.places.add(event.u, junction.weights, junction)
        return junction

    def _label(self, event: LocatedEvent) -> str:
        """The label of a special point, perhaps a new one."""
        prefix = LABELS[event.kind]
        for label in self.specials.near(event.u):
            if label.startswith(prefix):
                return label
        label = f"{prefix}{1 + sum(one.startswith(prefix) for one in self.points)}"
        self.specials.add(event.u, metric_at(event), label)
        self.points[label] = event, []
        return label

    def _add(self, path: Path, origin: str, generation: int) -> None:
        if path.status not in WHOLE:
            self.missing.append(f"a path from lam = {path.steps[0].lam:.6g} ended with: {path.message}")
        labels = {id(event): self._label(event) for event in path.events if event.kind in LABELS}
        for event in meetings(path):
            junction = self._junction(event)
            if junction.label:
                continue
            junction.label, junction.generation = labels[id(event)], generation
            self.junctions.append(junction)
            if junction.failed:
                self.missing.append(f"at {junction.label}, lam = {event.lam:.6g}, {junction.failed}")
        for label in [*labels.values(), *filter(None, [origin])]:
            self.points[label][1].append(len(self.branches))
        if self.log is not None:
            self.log.add(path)
        self.branches.append(Branch(path, origin, generation))

    def _spread(self) -> None:
        """Follow unused rays, generation by generation."""
        while True:
            rays = [(j, ray) for j in self.junctions for ray in j.open() if self._inside(j.starts[ray - 2][0])]
            if not rays:
                return
            if len(self.branches) >= self.most:
                self.missing.append(f"the limit of {self.most} branches is reached, {len(rays)} rays are open")
                return
            before = min(j.generation for j, _ in rays)
            self._follow([(j, ray) for j, ray in rays if j.generation == before], before + 1)

    def _follow(self, rays: list[tuple[Junction, int]], generation: int) -> None:
        """Trace rays, each with the one opposite to it."""
        asked = {(j.label, ray): (self.homotopy, j.starts[ray - 2], 0, self.options, j.weights) for j, ray in rays}
        with _ready(self.executor, asked) as traced:
            for junction, ray in rays:
                halves = []
                for one in (ray, junction.opposite(ray)):
                    if one is None or one in junction.used or (junction.label, one) not in asked:
                        continue
                    junction.used.add(one)
                    path = self._met(traced((junction.label, one)))
                    if len(path):
                        halves.append(from_point(junction.event, junction.rays[one], path, junction.weights))
                if halves:
                    whole = halves[0] if len(halves) == 1 else _through(halves[1], halves[0])
                    self._add(whole, junction.label, generation)


def _through(behind: Path, ahead: Path) -> Path:
    whole = behind.reversed().join(ahead)
    return whole if behind.status in WHOLE else evolve(whole, status=behind.status, message=behind.message)
