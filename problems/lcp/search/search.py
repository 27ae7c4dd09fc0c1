"""The state that all methods share."""

from __future__ import annotations

import time
from typing import Any

from attrs import define, field, frozen

from continuation.archive import PathLog
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.counts import Counts
from continuation.path import Path
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.iteration import AT_END, Policy
from problems.lcp.data.problem import MixedLCP, State
from problems.lcp.data.scaling import Scaled
from problems.lcp.homotopies import Structure
from problems.lcp.proof.certificate import Certificate, certify
from problems.lcp.proof.farkas import Farkas, FloatFarkas
from problems.lcp.proof.verdict import NEARLY, confirmed, to_precision
from problems.lcp.reference.enumeration import Exhaustion


@frozen(eq=False)
class Nearby:
    """A nearby problem's solution x, and its w."""

    x: Array
    w: Array


@frozen(eq=False)
class Asked:
    """The arguments of `solve`, in the search's units."""

    homotopy: str = "auto"
    x0: Array | None = None
    near: Nearby | None = None
    restarts: int = 0
    seed: int = 0
    shown: bool = False
    log: PathLog | None = None
    progress: bool = False
    options: dict[str, Any] = field(factory=dict)


@frozen(eq=False)
class Candidate:
    """A point that a method reached; `path` is its path's index, or -1."""

    certificate: Certificate
    path: int = -1
    stationary: bool = False


@define(eq=False, slots=False)
class Search:
    """The state of a search."""

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
    _processor: float = field(factory=time.process_time, init=False)

    @property
    def problem(self) -> MixedLCP:
        """The problem in the search's units."""
        return self.structure.problem

    @property
    def counts(self) -> Counts:
        """Counts of paths and active sets."""
        if self.finish is None:
            return self.traced
        return self.traced + self.finish.counts if self.paths else self.finish.counts

    @property
    def seconds(self) -> float:
        """Wall-clock time; no method depends on it."""
        return time.perf_counter() - self.began

    @property
    def exhausted(self) -> str:
        """The reached limit of the budget as text, or ""; seconds are CPU seconds."""
        spent = self.traced.factorizations + (0 if self.finish is None else self.finish.counts.factorizations)
        counts = Counts(accepted=self.traced.accepted, factorizations=spent)
        return self.budget.spent(counts, time.process_time() - self._processor)

    @property
    def solved(self) -> bool:
        """Whether the last end is a solution."""
        return bool(self.ends) and self.confirmed(self.ends[-1].certificate)

    def confirmed(self, certificate: Certificate) -> bool:
        """Whether a point may be called a solution."""
        return confirmed(self.problem, certificate, self.tolerance)

    def accept(self, x: Array) -> bool:
        """Record a point; return whether it is a solution."""
        self.ends.append(Candidate(certify(self.problem, x)))
        return self.solved

    def settle(self, state: State, policy: Policy = AT_END) -> bool:
        """Try active sets; return whether one solves."""
        return self.finish is not None and self.found(self.finish.settle(state, policy))

    def found(self, x: Array | None) -> bool:
        """Record the finish's result; return whether there is one."""
        if x is None or self.finish is None or self.finish.certificate is None:
            return False
        self.ends.append(Candidate(self.finish.certificate))
        return True

    def best(self) -> Candidate | None:
        """The best candidate."""
        nearest = None if self.finish is None else self.finish.nearest
        ends = self.ends if nearest is None else [*self.ends, Candidate(nearest)]
        if len(ends) < 2:
            return ends[0] if ends else None

        def rank(end: Candidate) -> tuple[bool, bool, bool, bool, float]:
            found = end.certificate
            rounded, nearly = to_precision(self.problem, found), found.solves(NEARLY)
            return not self.confirmed(found), not rounded, not nearly, not end.stationary, found.residual

        return min(ends, key=rank)
