"""The account of a search: its budget, the finish, every path and finish so far, and what each came to."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any

from attrs import define, evolve, field, frozen

from continuation.archive import PathLog
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.path import Path
from continuation.status import Status
from continuation.step.tracer import Observer
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import Finish, with_zeros
from problems.lcp.active_set.iteration import Policy
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.data.scaling import Scaled, balanced
from problems.lcp.homotopies import Structure
from problems.lcp.homotopies.registry import LCPHomotopy
from problems.lcp.proof.certificate import ROUND_OFF, Certificate, certify
from problems.lcp.proof.farkas import Farkas, FloatFarkas
from problems.lcp.proof.verdict import NEARLY, confirmed, stationary, to_precision
from problems.lcp.reference.enumeration import Exhaustion
from problems.lcp.search.padded import Padded, show
from problems.lcp.search.restarts import FAR_STARTS, Band, Restart, light, trace_light
from problems.lcp.search.route import follow

IN_FLIGHT = 64
"""Restarts handed to an executor before the first of them has come back: more than one machine has workers."""

LARGEST_KEPT = 4_000_000
"""Numbers of path points kept in memory (32 MB); of further paths only the two ends are."""


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

    `finish`: None where it is switched off. `tolerance`: Of the certificate. `budget`: Of the whole search. `options`:
    For `continuation.trace`. `counts`: Of everything so far. `ends`: Where the paths, and the finish, led. `scaled`:
    The problem in units of its own, where it is solved in these. `postponed`: Whether these are looked for only when
    active sets have failed in the units given. `proof`: That there is no feasible point, exactly or to working
    precision. `exhaustion`: What trying all faces came to. `compiled`: Whether pivots were. `looked`: Whether the
    equations of the first active set are regular, where it was looked at before the search, and is not counted yet.
    """

    structure: Structure
    finish: Finish | None
    tolerance: float
    budget: Budget
    log: PathLog | None
    progress: bool
    options: dict[str, Any]
    counts: Counts = field(factory=Counts)
    paths: list[Path] = field(factory=list)
    ends: list[Candidate] = field(factory=list)
    scaled: Scaled | None = None
    postponed: bool = False
    proof: Farkas | FloatFarkas | None = None
    exhaustion: Exhaustion | None = None
    compiled: bool = False
    looked: bool | None = None
    shown: bool = False
    began: float = field(factory=time.perf_counter)
    _kept: int = field(default=0, init=False)

    @property
    def problem(self) -> MixedLCP:
        """The problem."""
        return self.structure.problem

    @property
    def seconds(self) -> float:
        """Since the search began."""
        return time.perf_counter() - self.began

    @property
    def seconds_left(self) -> float:
        """Of the budget: infinite where that does not look at the clock."""
        return max(self.budget.seconds - self.seconds, 0.0)

    @property
    def exhausted(self) -> str:
        """Which limit of the budget is reached; empty if none is."""
        return self.budget.spent(self.counts, self.seconds)

    @property
    def solved(self) -> bool:
        """Whether the last end is a solution."""
        return bool(self.ends) and self.confirmed(self.ends[-1].certificate)

    def confirmed(self, certificate: Certificate) -> bool:
        """Whether a point may be called a solution."""
        return confirmed(self.problem, certificate, self.tolerance)

    def rescale(self) -> None:
        """Go on in units of the problem's own, if it has others than those given; what was tried stays tried."""
        self.postponed = False
        own = balanced(self.problem)
        if own is not None:
            self.scaled = own.after(self.scaled)
            self.ends.clear()
            self.looked = None
            if self.finish is not None:
                self.finish.nearest = None
            self._change(own.problem)

    def make_dense(self) -> None:
        """Store the matrix dense from here on."""
        self._change(evolve(self.problem, A=self.problem.A.toarray()))

    def _change(self, problem: MixedLCP) -> None:
        self.structure = Structure(problem)
        if self.finish is not None:
            self.finish.faces = Faces(self.structure, factoring=self.finish.faces.factoring)

    def accept(self, certificate: Certificate) -> None:
        """Take a point that no path led to into account."""
        self.ends.append(Candidate(certificate, -1, False))

    def settle(self, state: State, policy: Policy) -> bool:
        """Try active sets from a guess; whether that led to a solution."""
        return self._finished(lambda finish: finish.settle(state, policy))

    def settle_proximally(self, state: State | None = None) -> bool:
        """The same by the proximal method, from a guess or from the last active set tried."""
        return self._finished(lambda finish: finish.proximal_active_set(state))

    def descend(self, state: State) -> bool:
        """Whether descent in a box, from a guess, led to a solution."""
        return self._finished(lambda finish: finish.descend(state))

    def augment(self, below: float, most: int) -> bool:
        """Whether the augmented Lagrangian of a program led to a solution, if only to working precision.

        `below`: How far below zero the least eigenvalue of P is. `most`: Factorisations.
        """
        if self._finished(lambda finish: finish.augmented(below, most)):
            return True
        nearest = None if self.finish is None else self.finish.nearest
        return nearest is not None and to_precision(self.problem, nearest)

    def take(self, x: Array) -> bool:
        """Whether a point is itself a solution."""
        return self._finished(lambda finish: finish.take(x))

    def _finished(self, method: Callable[[Finish], Array | None]) -> bool:
        if self.finish is None:
            return False
        before = self.finish.counts.factorizations
        found = method(self.finish) is not None
        self.counts.factorizations += self.finish.counts.factorizations - before
        if found and self.finish.certificate is not None:
            self.accept(self.finish.certificate)
        return found

    def follow(self, homotopy: LCPHomotopy, **options: Any) -> bool:
        """Trace one path to its end; whether that is a solution.

        Its arcs are examined where the path is asked for; with the finish its end is certified, whatever led there.
        """
        given = {"examine": self.finish is None or self.shown, **options, **self.options}
        self.add(follow(homotopy, self.finish, self._left(), observers=self._observers(), **given))
        return self.solved

    def add(self, path: Path) -> None:
        """Take a traced path into account."""
        self.counts = self.counts + path.counts
        if path.steps:
            arrived = path.status is Status.REACHED_TARGET
            at_stationary = arrived and stationary(self.problem, path.endpoint.y)
            self.ends.append(Candidate(self._certified(path, arrived), len(self.paths), at_stationary))
            self._kept += len(path) * path.endpoint.u.size
        if self._kept > LARGEST_KEPT:
            light(path)
        self.paths.append(path)

    def _certified(self, path: Path, arrived: bool) -> Certificate:
        """The certificate of a path's end, which the finish brings to round-off where it can."""
        x = self.problem.clipped(path.endpoint.y[: self.problem.n])
        end = certify(self.problem, x)
        if arrived and not self.confirmed(end):
            zeros = certify(self.problem, x, self.tolerance)
            end = zeros if zeros.relative_residual < end.relative_residual else end
        if arrived and not self.problem.standard:
            end = with_zeros(self.problem, end, self.tolerance)
        if self.finish is None or not arrived or end.relative_residual <= ROUND_OFF:
            return end
        before = self.finish.counts.factorizations
        polished = self.finish.settle(self.problem.states(x, end.w), Policy(steps=0), x)
        self.counts.factorizations += self.finish.counts.factorizations - before
        return self.finish.certificate if polished is not None and self.finish.certificate is not None else end

    def restart(
        self, name: str, seed: int, count: int, executor: Executor | None, bands: tuple[Band, ...] = FAR_STARTS
    ) -> int:
        """Trace restarts until one solves the problem, or the budget or the count is used up; how many were begun.

        Over an executor the first solution in the order of the restarts is taken among those that are there.

        `name`: Of the homotopy. `bands`: How far out they begin, in turn.
        """
        tolerance = None if self.finish is None else self.tolerance

        def task(k: int) -> Restart:
            return Restart(self.structure, name, bands, seed, k, tolerance, self.options)

        if executor is not None:
            return self._distributed(executor, task, count)
        for k in range(count):
            if self.exhausted:
                return k
            self.add(task(k).trace(self._left(), self._observers()))
            if self.solved:
                return k + 1
        return count

    def _distributed(self, executor: Executor, task: Callable[[int], Restart], count: int) -> int:
        waiting: dict[Future[Path], Restart] = {}
        begun = 0

        def submit() -> None:
            nonlocal begun
            if begun < count and not self.exhausted:
                one = task(begun)
                waiting[executor.submit(trace_light, one, self._left())] = one
                begun += 1

        try:
            for _ in range(IN_FLIGHT):
                submit()
            while waiting:
                done, _ = wait(waiting, return_when=FIRST_COMPLETED)
                for future in sorted(done, key=lambda one: waiting[one].k):
                    restart, path = waiting.pop(future), future.result()
                    if self.log is not None:
                        self.record(path, restart.homotopy())
                    self.add(path)
                    if self.solved:
                        return begun
                    submit()
            return begun
        finally:
            for future in waiting:
                future.cancel()

    def record(self, path: Path, homotopy: LCPHomotopy) -> None:
        """Put a path into the archive, if there is one, that was not traced here."""
        if self.log is not None:
            show(path, homotopy, Padded(self.log, (3 if self.problem.standard else 6) * self.problem.n))

    def _observers(self) -> tuple[Observer, ...]:
        archive = () if self.log is None else (Padded(self.log, (3 if self.problem.standard else 6) * self.problem.n),)
        if not self.progress:
            return archive
        from continuation.step.progress import Progress

        return (*archive, Progress())

    def _left(self) -> Budget:
        """What of the budget is left, at least a little of each."""
        b, counts = self.budget, self.counts
        return Budget(
            steps=max(b.steps - counts.accepted, 1.0),
            seconds=max(self.seconds_left, 1e-3),
            factorizations=max(b.factorizations - counts.factorizations, 1.0),
        )

    def best(self) -> Candidate | None:
        """The solution, else one to working precision, one nearly, a stationary point, the point of least residual."""
        nearest = None if self.finish is None else self.finish.nearest
        ends = self.ends if nearest is None else [*self.ends, Candidate(nearest, -1, False)]
        if len(ends) < 2:
            return ends[0] if ends else None

        def rank(end: Candidate) -> tuple[bool, bool, bool, bool, float]:
            found = end.certificate
            rounded, nearly = to_precision(self.problem, found), found.solves(NEARLY)
            return not self.confirmed(found), not rounded, not nearly, not end.stationary, found.residual

        return min(ends, key=rank)
