"""The search for a solution: which paths are traced, one after another, and what each came to."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import define, evolve, field, frozen

from continuation.archive import PathLog
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.evaluation import Counts
from continuation.path import Path
from continuation.status import Status
from continuation.trace import trace
from problems.lcp.certificate import Certificate, certify
from problems.lcp.finish import Finish, Finishing
from problems.lcp.homotopies import (
    KKTHomotopy,
    Structure,
    WangHomotopy,
    XuHomotopy,
    YuHomotopy,
    ZhaoHomotopy,
    random_start,
)
from problems.lcp.padded import Padded
from problems.lcp.problem import LCP

MAKERS: dict[str, Callable[..., Any]] = {
    "kkt": KKTHomotopy,
    "wang": WangHomotopy,
    "yu": YuHomotopy,
    "zhao": ZhaoHomotopy,
    "xu": XuHomotopy,
}
"""By the name that `solve` takes."""

LARGEST_KEPT = 4_000_000
"""Numbers of path points kept in memory; of further paths only the two ends are."""


@frozen(eq=False)
class End:
    """Where a path, or a finish, led: the certificate of its x, and the index of the path (-1 for none)."""

    certificate: Certificate
    path: int
    arrived: bool


@define(eq=False)
class Search:
    """Paths of one problem, with what they share: the finish, the budget, the archive.

    Attributes
    ----------
    structure : Structure
    attempt : Finish or None
        None where the finish is switched off.
    tolerance : float
        Of the certificate.
    budget : Budget
        Of the whole search.
    log : PathLog or None
    progress : bool
    options : dict
        For `continuation.trace`.
    """

    structure: Structure
    attempt: Finish | None
    tolerance: float
    budget: Budget
    log: PathLog | None
    progress: bool
    options: dict[str, Any]
    counts: Counts = field(factory=Counts)
    paths: list[Path] = field(factory=list)
    ends: list[End] = field(factory=list)
    began: float = field(factory=time.perf_counter)
    _kept: int = field(default=0, init=False)

    @property
    def problem(self) -> LCP:
        """The problem."""
        return self.structure.problem

    @property
    def seconds(self) -> float:
        """Since the search began."""
        return time.perf_counter() - self.began

    @property
    def exhausted(self) -> str:
        """Which limit of the budget is reached; empty if none is."""
        return self.budget.spent(self.counts, self.seconds)

    @property
    def solved(self) -> bool:
        """Whether the last end is a solution."""
        return bool(self.ends) and self.ends[-1].certificate.solves(self.tolerance)

    def finish_from(self, active: Array, steps: int) -> bool:
        """The finish alone, from a guess of the active set."""
        if self.attempt is None:
            return False
        before = self.attempt.counts.factorizations
        x = self.attempt.settle(active, steps)
        self.counts.factorizations += self.attempt.counts.factorizations - before
        if x is not None:
            self.ends.append(End(certify(self.problem, x), -1, True))
        return x is not None

    def follow(self, homotopy: Any, **options: Any) -> bool:
        """Trace one path to its end; whether that is a solution."""
        before = 0 if self.attempt is None else self.attempt.counts.factorizations
        traced = homotopy if self.attempt is None else Finishing(homotopy, self.attempt)
        observers = () if self.log is None else (Padded(self.log, 3 * self.problem.n),)
        path = trace(
            traced, observers=observers, progress=self.progress, budget=self._left(), **{**self.options, **options}
        )
        if self.attempt is not None:
            path.counts.factorizations += self.attempt.counts.factorizations - before
        self.add(path)
        return self.solved

    def add(self, path: Path) -> None:
        """Take a traced path into account."""
        self.counts = self.counts + path.counts
        if path.steps:
            x = np.maximum(path.endpoint.y[: self.problem.n], 0.0)
            self.ends.append(End(certify(self.problem, x), len(self.paths), path.status is Status.REACHED_TARGET))
            self._kept += len(path) * path.endpoint.u.size
        if self._kept > LARGEST_KEPT:
            path.steps = [evolve(step, segment=None) for step in (path.steps[0], path.steps[-1])]
        self.paths.append(path)

    def _left(self) -> Budget:
        """What of the budget is left, at least a little of each."""
        b, counts = self.budget, self.counts
        return Budget(
            steps=max(b.steps - counts.accepted, 1.0),
            seconds=max(b.seconds - self.seconds, 1e-3),
            factorizations=max(b.factorizations - counts.factorizations, 1.0),
        )

    def best(self) -> End | None:
        """The solution, else the best end among those that reached lambda = 0, else among all."""
        if not self.ends:
            return None
        return min(self.ends, key=lambda end: (not end.certificate.solves(self.tolerance), not end.arrived,
                                               end.certificate.residual))


def another(name: str, search: Search, k: int, seed: int) -> Any:
    """The k-th restart of a homotopy: its start depends on the seed and k alone."""
    generator = np.random.default_rng([seed, k])
    start = random_start(search.problem, generator)
    if name == "kkt":
        return KKTHomotopy(search.problem, start.x0, start.z1, start.z2, start.w0, structure=search.structure)
    return MAKERS[name](search.problem, start.x0, start.w0, structure=search.structure)
