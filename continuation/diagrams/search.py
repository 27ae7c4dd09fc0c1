"""`diagram`: a breadth-first search."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from typing import Any

import numpy as np
from attrs import define, evolve, field, frozen

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
from continuation.metric import Automatic
from continuation.path import LocatedEvent, Path
from continuation.status import Status
from continuation.step.options import Options
from continuation.step.start import guessed
from continuation.tracing import solve_at, trace

WHOLE = (Status.REACHED_TARGET, Status.STOPPED_AT_EVENT, Status.CLOSED, Status.DIVERGED, Status.DEAD_END)
"""Final states of complete branches."""

LEAVES = 0.1
"""Distance of guesses from known solutions, relative to their spread."""


@frozen(eq=False)
class Tracing:
    """A path to trace.

    `weights`, `used`: its junction's metric and used rays.
    """

    start: Any
    direction: int = 0
    weights: Array | None = None
    used: set[int] = field(factory=set)
    ray: int = -1


def _path(homotopy: Any, start: Any, direction: int, options: Options, before: Array | None) -> Path:
    asked = options.copy()
    asked["direction"] = direction
    if start is not None:
        asked["start"] = start
    if before is not None and options.get("metric") is None and getattr(homotopy, "metric", None) is None:
        asked["metric"] = Automatic(before=before)
    return trace(homotopy, **asked)


@define(eq=False)
class BranchSearch:
    """A search in progress."""

    homotopy: Any
    options: Options
    executor: Executor | None
    step: float
    most: int
    generations: int | None
    log: Growing | None = None
    branches: list[Branch] = field(factory=list)
    junctions: list[Junction] = field(factory=list)
    places: PointIndex[Junction] = field(factory=PointIndex)
    labels: Counter[str] = field(factory=Counter)
    missing: list[str] = field(factory=list)
    counts: Counts = field(factory=Counts)

    def run(self, starts: list[Any], deflate: list[float]) -> None:
        """Search from all starts, then by deflation."""
        for path, kept in () if self.log is None else self.log.held(self.homotopy):
            self._recall(path, kept)
        for start in starts:
            self._begin(start)
        for lam in deflate:
            known = self._solutions(lam)
            for y in others(self.homotopy, lam, known, self._guesses(known)):
                self._begin((y, lam))

    @property
    def found(self) -> Diagram:
        """Diagram so far."""
        said = "; ".join(dict.fromkeys(self.missing))
        said = f"Not complete: {said}." if said else "Complete: nothing is left open."
        return Diagram(self.branches, points_of(self.branches, self.junctions), not self.missing, said, self.counts)

    def _guesses(self, known: list[Array]) -> list[Array]:
        start = np.atleast_1d(np.asarray(self.homotopy.start()[0], dtype=float))
        every = np.array([start, *known])
        apart = np.ptp(every, axis=0)
        beside = LEAVES * np.where(apart > 0.0, apart, 1.0)
        return [start, every.mean(axis=0), *(y + way * beside for y in every for way in (1.0, -1.0))]

    def _recall(self, path: Path, kept: Path) -> None:
        self.counts = self.counts + path.counts
        self._meet(path)
        points = enumerate(path.u)
        known = [(j, k) for k, u in points for j in self.places.near(u) if j.label and (j.event.u == u).all()]
        if not known:
            self._add(kept, "", 0, held=True)
            return
        junction, number = min(known, key=lambda found: found[0].number)
        at = path.steps[number]
        junction.take(at.tangent)
        if at.index:
            junction.take(-at.tangent)
        self._add(kept, junction.label, junction.generation + 1, held=True)

    def _begin(self, start: Any) -> None:
        u = np.append(*self.homotopy.start()) if start is None else guessed(start)
        if not self._inside(u):
            raise ValueError(f"box: expected each start inside, found one at lam = {u[-1]:g} on a face or beyond")
        if not (start is None and self.branches) and not self._known(u):
            both = self._traced([Tracing(start, 1), Tracing(start, -1)])
            whole = ahead = next(both) or Path()
            if ahead.status is not Status.CLOSED:
                behind = next(both) or Path()
                self._meet(behind)
                whole = _through(behind, ahead)
            self._meet(ahead)
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
        """Solve from each guess; keep a guess if Newton's method fails, as beside a fold."""
        found = []
        for guess in guesses:
            try:
                found.append(solve_at(self.homotopy, lam, guess))
            except ArithmeticError:
                found.append(guess)
        return found

    def _traced(self, tasks: list[Tracing]) -> Iterator[Path | None]:
        ready = [None if self.executor is None else self.executor.submit(_path, *self._asked(task)) for task in tasks]
        try:
            for task, future in zip(tasks, ready):
                path = None
                if future is not None or task.ray not in task.used:
                    path = _path(*self._asked(task)) if future is None else future.result()
                    self.counts = self.counts + path.counts
                yield None if task.ray in task.used else path
        finally:
            for future in filter(None, ready):
                future.cancel()

    def _asked(self, task: Tracing) -> tuple[Any, ...]:
        return self.homotopy, task.start, task.direction, self.options, task.weights

    def _meet(self, path: Path) -> None:
        if not len(path):
            self.missing.append(path.message)
        for event in meetings(path):
            junction = self._junction(event)
            for direction in directions_of(event, path):
                junction.take(direction)

    def _junction(self, event: LocatedEvent) -> Junction:
        known = self.places.near(event.u)
        if known:
            return known[0]
        junction = Junction.at(self.homotopy, event, self.step)
        self.junctions.append(junction)
        self.places.add(event.u, junction.weights, junction)
        return junction

    def _add(self, path: Path, origin: str, generation: int, held: bool = False) -> None:
        if path.status not in WHOLE:
            self.missing.append(f"a path from lam = {path.steps[0].lam:.6g} ended with: {path.message}")
        for event in meetings(path):
            junction = self._junction(event)
            if junction.label:
                continue
            prefix = LABELS[event.kind]
            junction.number, junction.generation = self.labels.total() + 1, generation
            self.labels[prefix] += 1
            junction.label = f"{prefix}{self.labels[prefix]}"
            if junction.failed:
                self.missing.append(f"at {junction.label}, lam = {event.lam:.6g}, {junction.failed}")
        if self.log is not None and not held:
            path = self.log.add(path)
        self.branches.append(Branch(path, origin, generation))

    def _spread(self) -> None:
        while True:
            labelled = sorted((j for j in self.junctions if j.label), key=lambda j: j.number)
            rays = [(j, ray) for j in labelled for ray in j.open() if self._inside(j.starts[ray - 2][0])]
            if not rays:
                return
            before = min(j.generation for j, _ in rays)
            if self.generations is not None and before >= self.generations:
                self.missing.append(f"{len(rays)} rays beyond generation {self.generations} were not followed")
                return
            if len(self.branches) >= self.most:
                self.missing.append(f"the limit of {self.most} branches is reached, {len(rays)} rays are open")
                return
            self._follow([(j, ray) for j, ray in rays if j.generation == before], before + 1)

    def _follow(self, rays: list[tuple[Junction, int]], generation: int) -> None:
        """Trace rays, those of one smooth branch in turn, and add the branches."""
        lines: list[tuple[Junction, list[int]]] = []
        left = {(j.number, ray): j for j, ray in rays}
        while left:
            (number, ray), junction = next(iter(left.items()))
            lines.append((junction, [k for k in junction.line(ray) if left.pop((number, k), None)]))
        tasks = [Tracing(j.starts[ray - 2], 0, j.weights, j.used, ray) for j, line in lines for ray in line]
        traced = self._traced(tasks)
        for junction, line in lines:
            halves: list[Path] = []
            try:
                for ray in line:
                    path = next(traced)
                    if path is not None:
                        junction.used.add(ray)
                        self._meet(path)
                        if len(path):
                            halves.append(from_point(junction.event, junction.rays[ray], path, junction.weights))
            except BaseException:
                # The diagram shows a finished half; resuming traces it again.
                self.log = None
                raise
            finally:
                if halves:
                    whole = _through(*reversed(halves)) if len(halves) > 1 else halves[0]
                    self._add(whole, junction.label, generation)


def _through(behind: Path, ahead: Path) -> Path:
    whole = behind.reversed().join(ahead)
    return whole if behind.status in WHOLE else evolve(whole, status=behind.status, message=behind.message)


def points_of(branches: Sequence[Branch], junctions: Sequence[Junction]) -> list[Special]:
    """Junctions, turning points, Hopf points and kinks, in branch order."""
    labels: Counter[str] = Counter()
    found: list[tuple[str, LocatedEvent, list[int]]] = []
    places: PointIndex[tuple[str, list[int]]] = PointIndex()

    def entry(label: str, event: LocatedEvent) -> list[int]:
        through: list[int] = []
        found.append((label, event, through))
        places.add(event.u, metric_at(event), (label, through))
        labels[label[:2]] += 1
        return through

    origins = {j.label: entry(j.label, j.event) for j in sorted(junctions, key=lambda j: j.number) if j.label}
    for k, branch in enumerate(branches):
        for event in branch.path.events:
            if event.kind not in LABELS:
                continue
            kind = LABELS[event.kind]
            same = [through for label, through in places.near(event.u) if label.startswith(kind)]
            (same[0] if same else entry(f"{kind}{1 + labels[kind]}", event)).append(k)
        if branch.origin:
            origins[branch.origin].append(k)
    return [Special(label, event, tuple(dict.fromkeys(through))) for label, event, through in found]
