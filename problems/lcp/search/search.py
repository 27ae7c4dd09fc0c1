"""The search for a solution: which paths are traced, one after another, and what each came to."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any

import numpy as np
from attrs import define, field, frozen

from continuation.archive import PathLog
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.path import Path
from continuation.status import Status
from continuation.step.tracer import Observer
from continuation.tracing import trace
from problems.lcp.active_set.face import Mask
from problems.lcp.active_set.finish import Finish, Finishing
from problems.lcp.data.problem import LCP
from problems.lcp.homotopies import KKTHomotopy, Structure
from problems.lcp.proof.certificate import ROUND_OFF, Certificate, certify
from problems.lcp.proof.verdict import confirmed, stationary
from problems.lcp.search.padded import Padded
from problems.lcp.search.restarts import FAR, TWO_VECTOR, Band, Restart, light, reweighted, trace_light

MAKERS: dict[str, Callable[..., Any]] = {"kkt": KKTHomotopy, **TWO_VECTOR}
"""By the name that `solve` takes."""

IN_FLIGHT = 64
"""Restarts handed to an executor before the first of them has come back."""

LARGEST_KEPT = 4_000_000
"""Numbers of path points kept in memory; of further paths only the two ends are."""


@frozen(eq=False)
class Candidate:
    """Where a path, or a finish, led: the certificate of its x, and the index of the path (-1 for none).

    `stationary` is whether x is the end of a KKT path, and the equations hold there.
    """

    certificate: Certificate
    path: int
    stationary: bool


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
    ends: list[Candidate] = field(factory=list)
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
        return bool(self.ends) and self._confirmed(self.ends[-1].certificate)

    def accept(self, certificate: Certificate) -> None:
        """Take a point that no path led to into account."""
        self.ends.append(Candidate(certificate, -1, False))

    def finish_from(self, active: Mask, steps: int, patience: int | None = None) -> bool:
        """The finish alone, from a guess of the active set."""
        return self._finished(lambda attempt: attempt.settle(active, steps, patience=patience))

    def finish_nearby(self, active: Mask | None = None) -> bool:
        """The finish by the proximal method, from a guess of the active set or from the last one tried."""
        return self._finished(lambda attempt: attempt.proximal_active_set(active))

    def _finished(self, method: Callable[[Finish], Array | None]) -> bool:
        if self.attempt is None:
            return False
        before = self.attempt.counts.factorizations
        found = method(self.attempt) is not None
        self.counts.factorizations += self.attempt.counts.factorizations - before
        if found and self.attempt.certificate is not None:
            self.accept(self.attempt.certificate)
        return found

    def follow(self, homotopy: Any, **options: Any) -> bool:
        """Trace one path to its end; whether that is a solution."""
        before = 0 if self.attempt is None else self.attempt.counts.factorizations
        traced = homotopy if self.attempt is None else Finishing(homotopy, self.attempt)
        path = trace(traced, observers=self._observers(), budget=self._left(), **{**options, **self.options})
        if self.attempt is not None:
            path.counts.factorizations += self.attempt.counts.factorizations - before
        self.add(path)
        return self.solved

    def add(self, path: Path, weighted: bool = False) -> None:
        """Take a traced path into account; one with weights in its objective ends where those of x'w need not hold."""
        self.counts = self.counts + path.counts
        if path.steps:
            arrived = path.status is Status.REACHED_TARGET
            at_stationary = arrived and not weighted and stationary(self.problem, path.endpoint.y)
            self.ends.append(Candidate(self._certified(path, arrived), len(self.paths), at_stationary))
            self._kept += len(path) * path.endpoint.u.size
        if self._kept > LARGEST_KEPT:
            light(path)
        self.paths.append(path)

    def _confirmed(self, certificate: Certificate) -> bool:
        return confirmed(self.problem, certificate, self.tolerance)

    def _certified(self, path: Path, arrived: bool) -> Certificate:
        """The certificate of a path's end, which the finish brings to round-off where it can."""
        x = np.maximum(path.endpoint.y[: self.problem.n], 0.0)
        end = certify(self.problem, x)
        if arrived and not self._confirmed(end):
            zeros = certify(self.problem, x, self.tolerance)
            end = zeros if zeros.relative_residual < end.relative_residual else end
        if self.attempt is None or not arrived or end.relative_residual <= ROUND_OFF:
            return end
        before = self.attempt.counts.factorizations
        polished = self.attempt.settle(x > end.w, 0, x)
        self.counts.factorizations += self.attempt.counts.factorizations - before
        return self.attempt.certificate if polished is not None and self.attempt.certificate is not None else end

    def restart(
        self, name: str, seed: int, count: int, executor: Executor | None, bands: tuple[Band, ...] = FAR
    ) -> int:
        """Trace restarts until one solves the problem, or the budget or the count is used up; how many were begun.

        Over an executor the first solution in the order of the restarts is taken among those that are there.
        """
        tolerance = None if self.attempt is None else self.tolerance

        def task(k: int, weights: Array | None) -> Restart:
            return Restart(self.structure, name, bands, seed, k, tolerance, self.options, weights)

        if executor is not None:
            return self._distributed(executor, task, count)
        weights = None
        for k in range(count):
            if self.exhausted:
                return k
            path = task(k, weights).trace(self._left(), self._observers())
            self.add(path, weights is not None)
            if self.solved:
                return k + 1
            weights = reweighted(self.problem, weights, path)
        return count

    def _distributed(self, executor: Executor, task: Callable[[int, Array | None], Restart], count: int) -> int:
        """Restart k goes on with the weights that restart k - IN_FLIGHT left: what it does depends on no timing."""
        waiting: dict[Future[Path], Restart] = {}
        begun = 0

        def submit(k: int, weights: Array | None) -> int:
            if k >= count or self.exhausted:
                return 0
            one = task(k, weights)
            waiting[executor.submit(trace_light, one, self._left())] = one
            return 1

        try:
            for k in range(min(IN_FLIGHT, count)):
                begun += submit(k, None)
            while waiting:
                done, _ = wait(waiting, return_when=FIRST_COMPLETED)
                for future in sorted(done, key=lambda one: waiting[one].k):
                    restart, path = waiting.pop(future), future.result()
                    self.add(path, restart.weights is not None)
                    if self.solved:
                        return begun
                    begun += submit(restart.k + IN_FLIGHT, reweighted(self.problem, restart.weights, path))
            return begun
        finally:
            for future in waiting:
                future.cancel()

    def _observers(self) -> tuple[Observer, ...]:
        archive = () if self.log is None else (Padded(self.log, 3 * self.problem.n),)
        if not self.progress:
            return archive
        from continuation.progress import Progress

        return (*archive, Progress())

    def _left(self) -> Budget:
        """What of the budget is left, at least a little of each."""
        b, counts = self.budget, self.counts
        return Budget(
            steps=max(b.steps - counts.accepted, 1.0),
            seconds=max(b.seconds - self.seconds, 1e-3),
            factorizations=max(b.factorizations - counts.factorizations, 1.0),
        )

    def best(self) -> Candidate | None:
        """The solution, else the best stationary point, else the end of least residual."""
        if not self.ends:
            return None
        return min(self.ends, key=lambda end: (not self._confirmed(end.certificate), not end.stationary,
                                               end.certificate.residual))
