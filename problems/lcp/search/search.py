"""One problem being searched: what was asked, what may be spent, and everything that was found."""

from __future__ import annotations

import math
import time
from concurrent.futures import Executor
from functools import cached_property
from typing import Any

from attrs import define, field, frozen

from continuation.archive import PathLog
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.path import Path
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.iteration import AT_END, Policy
from problems.lcp.data.matrix_facts import MatrixFacts
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.data.scaling import Scaled
from problems.lcp.homotopies import Structure
from problems.lcp.proof.certificate import Certificate, certify
from problems.lcp.proof.farkas import Farkas, FloatFarkas
from problems.lcp.proof.verdict import NEARLY, confirmed, to_precision
from problems.lcp.reference.enumeration import Exhaustion
from problems.lcp.search.work import default_budget


@frozen(eq=False)
class Nearby:
    """The solution of a problem nearby: x, and w = A x + q there."""

    x: Array
    w: Array


@frozen(eq=False)
class Asked:
    """What the caller of `solve` asked for, in the units of the search: the arguments of the same names."""

    homotopy: str = "auto"
    x0: Array | None = None
    near: Nearby | None = None
    restarts: int = 0
    seed: int = 0
    executor: Executor | None = None
    shown: bool = False
    log: PathLog | None = None
    progress: bool = False
    options: dict[str, Any] = field(factory=dict)


@frozen(eq=False)
class Candidate:
    """Where a method led: the certificate of its x, and the index of the path (-1 for none).

    `stationary` is whether x is the end of a KKT path, and the equations hold there.
    """

    certificate: Certificate
    path: int = -1
    stationary: bool = False


@define(eq=False, slots=False)
class Search:
    """What the methods share.

    `finish`: None where it is switched off. `scaled`: How the problem came to the units in which it is searched.
    `traced`: What the paths cost. `ends`: Where methods led. `proof`: That there is no feasible point, exactly or to
    working precision. `exhaustion`: What trying all faces came to. `tried`: How many restarts were begun.
    """

    structure: Structure
    finish: Finish | None
    tolerance: float
    budget: Budget
    asked: Asked = field(factory=Asked)
    scaled: Scaled | None = None
    traced: Counts = field(factory=Counts)
    paths: list[Path] = field(factory=list)
    ends: list[Candidate] = field(factory=list)
    proof: Farkas | FloatFarkas | None = None
    exhaustion: Exhaustion | None = None
    tried: int = 0
    began: float = field(factory=time.perf_counter)
    _processor: float = field(init=False)

    @_processor.default
    def _at_first(self) -> float:
        return time.process_time() if self.budget.seconds < math.inf else 0.0

    @property
    def problem(self) -> MixedLCP:
        """The problem, in the units in which it is searched."""
        return self.structure.problem

    @property
    def counts(self) -> Counts:
        """Of all paths and active sets together."""
        if self.finish is None:
            return self.traced
        return self.traced + self.finish.counts if self.paths else self.finish.counts

    @property
    def seconds(self) -> float:
        """Since the search began, of a clock on the wall: no decision of a method depends on it."""
        return time.perf_counter() - self.began

    @property
    def processor(self) -> float:
        """Seconds of the processor, which are the same on a busy machine: those that a budget counts."""
        # A look at this clock takes longer than a small problem: it is for a budget of seconds alone.
        return time.process_time() - self._processor if self.budget.seconds < math.inf else 0.0

    @property
    def exhausted(self) -> str:
        """Which limit of the budget is reached; empty if none is."""
        spent = self.traced.factorizations + (0 if self.finish is None else self.finish.counts.factorizations)
        return self.budget.spent(Counts(accepted=self.traced.accepted, factorizations=spent), self.processor)

    @cached_property
    def share(self) -> float:
        """The budget over the default one, at most 1: of what a method may do by default it does so much."""
        return min(1.0, self.budget.factorizations / default_budget(self.problem).factorizations)

    @cached_property
    def facts(self) -> MatrixFacts:
        """What is known of the matrix."""
        return MatrixFacts(self.structure)

    @property
    def solved(self) -> bool:
        """Whether the last end is a solution."""
        return bool(self.ends) and self.confirmed(self.ends[-1].certificate)

    def confirmed(self, certificate: Certificate) -> bool:
        """Whether a point may be called a solution."""
        return confirmed(self.problem, certificate, self.tolerance)

    def accept(self, x: Array) -> bool:
        """Take a point into account that no active set led to; whether it is a solution."""
        self.ends.append(Candidate(certify(self.problem, x)))
        return self.solved

    def settle(self, state: State, policy: Policy = AT_END) -> bool:
        """Try active sets from a guess; whether that led to a solution."""
        return self.finish is not None and self.found(self.finish.settle(state, policy))

    def found(self, x: Array | None) -> bool:
        """Take what the finish has found into account; whether it has found anything."""
        if x is None or self.finish is None or self.finish.certificate is None:
            return False
        self.ends.append(Candidate(self.finish.certificate))
        return True

    def best(self) -> Candidate | None:
        """The solution, else one to working precision, one nearly, a stationary point, the point of least residual."""
        nearest = None if self.finish is None else self.finish.nearest
        ends = self.ends if nearest is None else [*self.ends, Candidate(nearest)]
        if len(ends) < 2:
            return ends[0] if ends else None

        def rank(end: Candidate) -> tuple[bool, bool, bool, bool, float]:
            found = end.certificate
            rounded, nearly = to_precision(self.problem, found), found.solves(NEARLY)
            return not self.confirmed(found), not rounded, not nearly, not end.stationary, found.residual

        return min(ends, key=rank)
