"""Paths of Wang's and of the KKT homotopy, then restarts from random starts.

An end of Wang's path solves the problem. The KKT path ends for any matrix, perhaps at a stationary point of x'w only.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import define, evolve

from continuation.budget import Budget
from continuation.controllers import AllgowerGeorg
from continuation.correctors import BorderedNewton
from continuation.path import Path
from continuation.predictors import Hermite
from continuation.status import Status
from continuation.step.presets import FAST, Preset
from continuation.step.tracer import Observer, Tracer
from continuation.tolerance import Tolerance
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import Finish, with_zeros
from problems.lcp.active_set.on_path import AlongPath
from problems.lcp.data.problem import LCP
from problems.lcp.homotopies import Structure
from problems.lcp.homotopies.registry import HOMOTOPIES, LCPHomotopy
from problems.lcp.homotopies.starts import random_start
from problems.lcp.proof.certificate import Certificate, certify
from problems.lcp.proof.phase1 import NoStrictlyFeasiblePoint, strictly_feasible_start
from problems.lcp.proof.verdict import stationary
from problems.lcp.search.padded import Padded
from problems.lcp.search.search import Candidate, Search

LARGEST_MADE_DENSE = 500
"""Largest order at which paths make sparse matrices dense, as they fill: with 5 % entries (n = 200) a path takes a
tenth of the time."""

LOOSE = Tolerance(relative=5e-2)
"""Last increment of a restart: the finish is exact."""

SEARCH = Preset(
    "SEARCH",
    "steps that turn up to 40 degrees, for one path among many",
    Hermite(),
    BorderedNewton(reuse=0.0),
    AllgowerGeorg(contraction=0.7, distance=0.6, angle=0.7, deceleration=2.0),
)
"""Restarts take the longest steps that pay."""


def follow(
    homotopy: LCPHomotopy,
    finish: Finish | None,
    budget: Budget,
    exhausted: Callable[[], str],
    observers: tuple[Observer, ...] = (),
    **options: Any,
) -> Path:
    """Trace a path and try the finish along it. What is exhausted becomes its message."""
    before = 0 if finish is None else finish.counts.factorizations
    along = None if finish is None else AlongPath(finish, homotopy)
    tracer = Tracer(homotopy, finish=along, budget=budget, observers=observers, **options)
    for _ in tracer:
        if reason := exhausted():
            tracer.give_up(reason)
            break
    if finish is not None:
        tracer.path.counts.factorizations += finish.counts.factorizations - before
        finish.counts.factorizations = before
    return tracer.path


def light(path: Path) -> None:
    """Reduce a path in place to its two ends."""
    if path.steps:
        path.steps = [evolve(step, segment=None) for step in (path.steps[0], path.steps[-1])]


@define(eq=False)
class Paths:
    """One problem's paths."""

    search: Search
    _begun: bool = False

    def run(self, work: float) -> str:
        """Trace the first paths; on the next call, the restarts."""
        search = self.search
        if not self._begun:
            self._begun = True
            problem = search.problem
            if problem.sparse and problem.n <= LARGEST_MADE_DENSE:
                search.structure = Structure(evolve(problem, A=problem.A.toarray()))
            return next((said for name in self._names() if (said := self._first(name))), "")
        asked = search.asked
        name = ("kkt" if search.problem.standard else "wang") if asked.homotopy == "auto" else asked.homotopy
        search.tried = self._restarted(name, asked.restarts)
        start = f"random start {search.tried} (seed {asked.seed})"
        return f"Solved by a path of the {name} homotopy from {start}." if search.solved else ""

    def _names(self) -> tuple[str, ...]:
        """If some a_ii < 0, Wang's path mostly diverges, except in a box."""
        search = self.search
        if search.asked.homotopy != "auto":
            return (search.asked.homotopy,)
        return ("kkt",) if search.problem.standard and search.structure.negative_diagonal else ("wang", "kkt")

    def _first(self, name: str) -> str:
        search, problem, asked, known = self.search, self.search.problem, self.search.asked, HOMOTOPIES[name]
        automatic = asked.homotopy == "auto"
        # For "auto" x0 names an active set.
        start = None if automatic else asked.x0
        if search.exhausted:
            return ""
        if start is None and known.feasible:
            try:
                assert isinstance(problem, LCP)
                start = strictly_feasible_start(problem)
            except NoStrictlyFeasiblePoint as error:
                search.proof = error.certificate or search.proof
                return str(error)
        homotopy = known.from_x0(problem, start, search.structure)
        preset = {"preset": FAST} if automatic else {}
        # The finish certifies ends.
        options = {"examine": search.finish is None or asked.shown, **preset, **asked.options}
        self.add(follow(homotopy, search.finish, self._left(), lambda: search.exhausted, self._observers(), **options))
        return f"Solved by the path of the {name} homotopy." if search.solved else ""

    def add(self, path: Path) -> None:
        """Record a path."""
        search = self.search
        search.traced = search.traced + path.counts
        if path.steps:
            arrived = path.status is Status.REACHED_TARGET
            at_stationary = arrived and stationary(search.problem, path.endpoint.y)
            search.ends.append(Candidate(self._certified(path, arrived), len(search.paths), at_stationary))
        search.paths.append(path)

    def _certified(self, path: Path, arrived: bool) -> Certificate:
        search, problem = self.search, self.search.problem
        x = problem.clipped(path.endpoint.y[: problem.n])
        end = certify(problem, x)
        if not arrived or search.confirmed(end):
            return end
        return with_zeros(problem, end, search.tolerance)

    def _restarted(self, name: str, count: int) -> int:
        """Trace paths until one solves; return their number. The k-th depends on the seed and k alone."""
        search, asked, structure = self.search, self.search.asked, self.search.structure
        parts = {} if search.finish is None else {"tolerance": LOOSE}
        for k in range(count):
            if search.exhausted:
                return k
            start = random_start(search.problem, np.random.default_rng([asked.seed, k]))
            homotopy = HOMOTOPIES[name].at(search.problem, start, structure, refine=search.finish is None)
            options = {"preset": SEARCH, "examine": search.finish is None, **parts, **asked.options}
            finish = None if search.finish is None else Finish(Faces(structure), search.tolerance)
            path = follow(homotopy, finish, self._left(), lambda: search.exhausted, self._observers(), **options)
            self.add(path)
            if search.solved:
                return k + 1
            light(path)
        return count

    def _observers(self) -> tuple[Observer, ...]:
        asked = self.search.asked
        archive = () if asked.log is None else (Padded.of(asked.log, self.search.problem),)
        if not asked.progress:
            return archive
        from continuation.step.progress import Progress

        return (*archive, Progress())

    def _left(self) -> Budget:
        b, counts = self.search.budget, self.search.counts
        return Budget(
            steps=max(b.steps - counts.accepted, 1.0), factorizations=max(b.factorizations - counts.factorizations, 1.0)
        )
