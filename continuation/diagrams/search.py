"""`diagram`: every branch that hangs together with the start, breadth first, each once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, Future
from numbers import Integral
from os import PathLike
from typing import Any, Unpack

import numpy as np
from attrs import define, evolve, field, frozen

from continuation.archive.atomic import as_file, check_new
from continuation.arrays import Array
from continuation.branch_switching import metric_at
from continuation.checks import complain, instance_with, is_number
from continuation.counts import Counts
from continuation.diagrams.branches import LABELS, Branch, Diagram, Special, from_point
from continuation.diagrams.deflation import others, same_solution, solved
from continuation.diagrams.junctions import SAME_POINT, Junction, directions_of, meetings
from continuation.evaluation.evaluator import Evaluator
from continuation.events.box import is_inside
from continuation.labels import Labels
from continuation.metric import Inherited, norm
from continuation.path import LocatedEvent, Path
from continuation.stability import Stability
from continuation.status import Status
from continuation.step.options import Options, check_names, documented
from continuation.step.start import guessed, is_guess
from continuation.tracing import trace

WHOLE = (Status.REACHED_TARGET, Status.STOPPED_AT_EVENT, Status.CLOSED, Status.DIVERGED, Status.DEAD_END)
"""Ends of branches that leave nothing open."""

LEAVES = 0.1
"""Guesses for deflation lie beside known solutions, by this part of how far these are apart."""


@frozen(eq=False)
class Task:
    """A path to be traced: from a start, or from a junction along a ray."""

    start: Any
    direction: int = 0
    junction: Junction | None = None
    ray: int = -1

    @property
    def metric(self) -> Array | None:
        """Where the path leaves a junction, the metric there."""
        return None if self.junction is None else self.junction.weights

    @property
    def idle(self) -> bool:
        """Whether somebody has come along the ray meanwhile."""
        return self.junction is not None and self.ray in self.junction.used


def _path(homotopy: Any, start: Any, direction: int, options: Options, before: Array | None) -> Path:
    """One path, in this process or in a worker's; `before` is the metric where it leaves another."""
    asked = options.copy()
    asked["direction"] = direction
    if start is not None:
        asked["start"] = start
    if before is not None and options.get("metric") is None and getattr(homotopy, "metric", None) is None:
        asked["metric"] = Inherited(before)
    return trace(homotopy, **asked)


@documented
def diagram(
    homotopy: Any,
    *,
    starts: Sequence[Any] = (),
    branches: int = 100,
    generations: int | None = None,
    deflate: Sequence[float] = (),
    step: float = 1e-2,
    stability: Stability | None = None,
    executor: Executor | None = None,
    archive: str | PathLike[str] | None = None,
    **options: Unpack[Options],
) -> Diagram:
    """Trace all branches that hang together: from the start both ways, then from every point at which others leave.

    A branch is a smooth curve; it goes straight on where others cross. At simple and multiple branch points, and at
    kinks, those that leave are followed, breadth first; which rays of a point have been followed is kept, so that a
    branch that comes back to a known point is not traced again. With several processes the result is the same: of two
    that meet from both ends, the later one is dropped.

    Parameters
    ----------
    homotopy : Homotopy
        To be picklable where the executor needs it.
    starts : sequence of (y, lam), default ()
        More points to begin at, besides the homotopy's own start.
    branches : int, default 100
        At most so many.
    generations : int, optional
        At most so many branch points between a branch and the start; 0 for the start's own branch.
    deflate : sequence of float, default ()
        Values of the parameter at which more solutions are sought, when nothing is left that hangs together: by
        Newton's method with the known ones divided out (`Deflated`).
    step : float, default 1e-2
        How far beside a branch point branches begin, in the metric, as for `switch_branch`.
    stability : Stability, optional
        Stored with each point, and drawn; its Hopf points are found.
    executor : concurrent.futures.Executor, optional
        Traces the paths of one generation; without one this process does.
    archive : path, optional
        A new file that all branches are written to, at the end.
    {options}

    Returns
    -------
    Diagram
        What was found, also where a limit was reached: `complete` and `message` say so.

    Raises
    ------
    TypeError, ValueError
        For bad input; if there is no box, and so no end; if the start is not inside of it.
    """
    check_names(options, owned={"start": "there is starts=", "direction": "both are traced"})
    Evaluator(homotopy, Counts())
    for name, count in (("branches", branches), ("generations", 1 if generations is None else generations)):
        if not isinstance(count, Integral) or isinstance(count, bool) or count < (name == "branches"):
            raise complain(ValueError, name, "a positive integer", count)
    if not is_number(step) or isinstance(step, bool) or not 0.0 < step < np.inf:
        raise complain(ValueError, "step", "a positive finite number", step)
    if stability is not None and not isinstance(stability, Stability):
        raise complain(TypeError, "stability", "a Stability or None", stability)
    if executor is not None:
        instance_with("executor", executor, ("submit",), "a concurrent.futures.Executor")
    if not isinstance(deflate, Sequence) or not all(is_number(lam) and np.isfinite(lam) for lam in deflate):
        raise complain(TypeError, "deflate", "values of the parameter", deflate)
    if not all(is_guess(start) for start in starts):
        raise complain(TypeError, "starts", "pairs (y, lam)", starts)
    file = None if archive is None else as_file("archive", archive)
    if file is not None:
        check_new(file)
    box = options.get("box", getattr(homotopy, "box", None))
    if box is None or isinstance(box, str):
        raise complain(ValueError, "box", 'one, as {"lam": (0, 5)}, since branches have no other end', box)
    asked: Options = {**options, "box": box, "target": options.get("target")}
    if stability is not None:
        asked["events"] = (*options.get("events", ()), *stability.events)
    search = Search(homotopy, asked, executor, float(step), branches, generations)
    found = search.run([None, *starts], [float(lam) for lam in deflate])
    if file is not None:
        found.save(file)
    return found


@define(eq=False)
class Search:
    """A search under way."""

    homotopy: Any
    options: Options
    executor: Executor | None
    step: float
    most: int
    generations: int | None
    branches: list[Branch] = field(factory=list)
    junctions: list[Junction] = field(factory=list)
    missing: list[str] = field(factory=list)
    counts: Counts = field(factory=Counts)

    def run(self, starts: list[Any], deflate: list[float]) -> Diagram:
        """All of it."""
        for start in starts:
            self._begin(start)
        for lam in deflate:
            known = self._solutions(lam)
            for y in others(self.homotopy, lam, known, self._guesses(known)):
                self._begin((y, lam))
        found = Diagram(self.branches, self._points(), not self.missing, "", self.counts)
        said = f"Not complete: {'; '.join(self.missing)}." if self.missing else "Complete: nothing is left open."
        return evolve(found, message=said)

    def _guesses(self, known: list[Array]) -> list[Array]:
        start = np.atleast_1d(np.asarray(self.homotopy.start()[0], dtype=float))
        every = np.array([start, *known])
        apart = np.ptp(every, axis=0)
        beside = LEAVES * np.where(apart > 0.0, apart, 1.0)
        return [start, every.mean(axis=0), *(y + way * beside for y in every for way in (1.0, -1.0))]

    def _begin(self, start: Any) -> None:
        """Both ways from a start, and all that hangs on it, unless it lies on a known branch."""
        u = np.append(*self.homotopy.start()) if start is None else guessed(start)
        if not self._inside(u):
            raise ValueError(f"box: expected each start inside, found one at lam = {u[-1]:g} on a face or beyond")
        if self._known(u):
            return
        both = (path for _, path in self._traced([Task(start, 1), Task(start, -1)]))
        whole = ahead = next(both)
        if ahead.status is not Status.CLOSED:
            behind = next(both)
            self._meet(behind)
            whole = behind.reversed().join(ahead)
        self._meet(ahead)
        if len(whole):
            self.branches.append(Branch(whole, "", 0))
        self._spread()

    def _inside(self, u: Array) -> bool:
        return is_inside(self.options.get("box"), Labels.of(self.homotopy), u)

    def _known(self, u: Array) -> bool:
        """Whether a branch has the point: Newton's method leads there from what is interpolated."""
        known = self._solutions(float(u[-1]))
        (y,) = self._polished(float(u[-1]), [u[:-1]])
        return any(same_solution(y, other) for other in known)

    def _solutions(self, lam: float) -> list[Array]:
        """Those of the branches at a value of the parameter."""
        return self._polished(lam, list(Diagram(self.branches).at(lam)))

    def _polished(self, lam: float, guesses: list[Array]) -> list[Array]:
        """Solutions from guesses; one from which Newton's method leads nowhere, as beside a fold, stays what it is."""
        found = []
        for guess in guesses:
            try:
                found.append(solved(self.homotopy, lam, guess))
            except ArithmeticError:
                found.append(guess)
        return found

    def _traced(self, tasks: list[Task]) -> Iterator[tuple[Task, Path]]:
        """The paths of tasks, but for those that have become idle when it is their turn."""
        ready: list[Future[Path]] = []
        asked = [(self.homotopy, task.start, task.direction, self.options, task.metric) for task in tasks]
        if self.executor is not None:
            ready = [self.executor.submit(_path, *one) for one in asked]
        for k, task in enumerate(tasks):
            if task.idle and not ready:
                continue
            path = ready[k].result() if ready else _path(*asked[k])
            self.counts = self.counts + path.counts
            if not task.idle:
                yield task, path

    def _meet(self, path: Path) -> None:
        """Whether a path came to its end, and the junctions on it: new ones are waiting, of old ones rays are taken."""
        if path.status not in WHOLE:
            self.missing.append(f"a path from lam = {path.steps[0].lam:.6g} ended with: {path.message}" if len(path)
                                else path.message)  # fmt: skip
        for event in meetings(path):
            junction = next((known for known in self.junctions if known.is_at(event)), None)
            if junction is None:
                junction = Junction.at(self.homotopy, event, self.step)
                prefix = LABELS[event.kind]
                junction.label = f"{prefix}{1 + sum(known.label.startswith(prefix) for known in self.junctions)}"
                self.junctions.append(junction)
                if junction.failed:
                    self.missing.append(f"at {junction.label}, lam = {event.lam:.6g}, {junction.failed}")
            for direction in directions_of(event, path):
                junction.take(direction)

    def _spread(self) -> None:
        """Generation after generation, until no ray is open."""
        generation = 0
        while True:
            tasks = [Task(j.starts[ray - 2], 0, j, ray) for j in self.junctions for ray in j.open()]
            tasks = [task for task in tasks if self._inside(task.start[0])]
            if not tasks:
                return
            generation += 1
            if self.generations is not None and generation > self.generations:
                self.missing.append(f"{len(tasks)} rays beyond generation {self.generations} were not followed")
                return
            if len(self.branches) >= self.most:
                self.missing.append(f"the limit of {self.most} branches is reached, {len(tasks)} rays are open")
                return
            self._follow(tasks, generation)

    def _follow(self, tasks: list[Task], generation: int) -> None:
        """One generation: its paths, each accepted before the next is looked at, and the branches that they make."""
        paths: dict[tuple[int, int], tuple[Junction, Path]] = {}
        for task, path in self._traced(tasks):
            assert task.junction is not None
            task.junction.used.add(task.ray)
            self._meet(path)
            if len(path):
                paths[self.junctions.index(task.junction), task.ray] = task.junction, path
        while paths:
            number, ray = next(iter(paths))
            junction, path = paths.pop((number, ray))
            whole = from_point(junction.event, junction.rays[ray], path, junction.weights)
            across = junction.opposite(ray)
            if across is not None and (number, across) in paths:
                _, other = paths.pop((number, across))
                behind = from_point(junction.event, junction.rays[across], other, junction.weights)
                whole = behind.reversed().join(whole)
            self.branches.append(Branch(whole, junction.label, generation))

    def _points(self) -> list[Special]:
        """Junctions, turning points, Hopf points and kinks, each once, in the order of the branches."""
        found: list[tuple[str, LocatedEvent, list[int]]] = [(j.label, j.event, []) for j in self.junctions]
        numbers = dict.fromkeys(LABELS.values(), 0)
        for k, branch in enumerate(self.branches):
            for event in branch.path.events:
                if event.kind not in LABELS:
                    continue
                label = LABELS[event.kind]
                same = [entry for entry in found if entry[0].startswith(label) and _one_place(entry[1], event)]
                if not same:
                    numbers[label] += 1
                    junctions = sum(j.label.startswith(label) for j in self.junctions)
                    same = [(f"{label}{junctions + numbers[label]}", event, [])]
                    found += same
                same[0][2].append(k)
            for entry in found:
                if entry[0] == branch.origin:
                    entry[2].append(k)
        return [Special(label, event, tuple(dict.fromkeys(through))) for label, event, through in found]


def _one_place(a: LocatedEvent, b: LocatedEvent) -> bool:
    return norm(metric_at(a), a.u - b.u) <= SAME_POINT
