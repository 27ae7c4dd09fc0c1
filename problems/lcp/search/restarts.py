"""Paths from random starts: where they begin, the parts that make them quick, and when one is given up.

A path of the KKT homotopy may end at a stationary point of x'w that does not solve the problem; another start leads
elsewhere (`homotopies.starts.random_start` has what was measured).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.budget import Budget
from continuation.controllers import AllgowerGeorg
from continuation.correctors import BorderedNewton
from continuation.path import Path, Step
from continuation.predictors import Hermite
from continuation.status import Kind
from continuation.step.presets import Preset
from continuation.step.tracer import Observer
from continuation.tolerance import Tolerance
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import Finish
from problems.lcp.active_set.on_path import smallest_parameter
from problems.lcp.homotopies import Structure
from problems.lcp.homotopies.registry import HOMOTOPIES, LCPHomotopy
from problems.lcp.homotopies.starts import START_DISTANCES, random_start
from problems.lcp.search.route import Patience, follow

Band = tuple[float, float]

FAR_STARTS: tuple[Band, ...] = (START_DISTANCES,)
NEAR_STARTS: tuple[Band, ...] = ((-0.5, 0.0), (0.0, 0.5))
"""The distances of starts, in turn; see `random_start`. For A >= 0 (bimatrix games) only near ones do well."""

SETTLED_PRODUCT = 5e-5
"""Products x z1 below this, in natural units: what the active set is then, it remains."""

RESTART_STEPS = 60
"""Steps, and n more, after which a restart is given up: of 144 paths that solved one took nearly as many."""

FIRST_PATH = 2
"""Times as many are left to the first path, which takes shorter ones, where nothing tells that it leads to a solution:
one of a Hankel matrix of order 100 was not at its end after 3,000, and restarts had no time left."""

LARGEST_FRESH = 150
"""Up to this order a factorisation costs no more than the solves by which an old one is refined."""

TRACE_TOLERANCE = Tolerance(relative=5e-2)
"""Of the last increment; with Newton's method the error is near its square. The end is exact by the finish."""


PURE_TOLERANCE = 1e-4
"""Of the last increment on a restart without the finish."""


def search_preset(n: int) -> Preset:
    """The parts of a restart for a problem of order n: the longest steps that pay."""
    return Preset(
        "SEARCH",
        "steps that turn up to 40 degrees, for one path among many",
        Hermite(),
        BorderedNewton(reuse=0.0 if n <= LARGEST_FRESH else 0.5),
        AllgowerGeorg(contraction=0.7, distance=0.6, angle=0.7, deceleration=2.0),
    )


@frozen(eq=False)
class Restart:
    """The k-th restart: it depends on what is here alone, and can be sent to another process.

    `structure`: Of the problem. `name`: "kkt", or that of a homotopy in (x, y). `bands`: How far out it may begin.
    `tolerance`: Of the finish; None to go without it. `options`: For the tracer, over those of `search_preset`.
    """

    structure: Structure
    name: str
    bands: tuple[Band, ...]
    seed: int
    k: int
    tolerance: float | None
    options: Mapping[str, Any]

    def homotopy(self) -> LCPHomotopy:
        """The homotopy at its start; with the finish its solves are not refined, which a loose tolerance allows."""
        problem, structure, k = self.structure.problem, self.structure, self.k
        start = random_start(problem, np.random.default_rng([self.seed, k]), self.bands[k % len(self.bands)])
        return HOMOTOPIES[self.name].at(problem, start, structure, refine=self.tolerance is None)

    def trace(self, budget: Budget, observers: tuple[Observer, ...] = ()) -> Path:
        """The path, to its end or until it is given up."""
        homotopy = self.homotopy()
        # The end of a pure path is the answer. With the finish only the active set counts that the path leads to.
        pure = self.tolerance is None
        options = {
            "preset": search_preset(self.structure.n),
            "tolerance": PURE_TOLERANCE if pure else TRACE_TOLERANCE,
            "examine": pure,
            **self.options,
        }
        finish = None if self.tolerance is None else Finish(Faces(self.structure), self.tolerance)
        patience = None if pure else _patience(homotopy)
        return follow(homotopy, finish, budget, observers=observers, patience=patience, **options)


def _patience(homotopy: LCPHomotopy) -> Patience:
    """A path among many is not worth every step."""
    least, longest = smallest_parameter(homotopy, SETTLED_PRODUCT), RESTART_STEPS + homotopy.n

    def reason(step: Step) -> str:
        if step.kind != Kind.REGULAR:
            return ""
        if step.lam < least:
            return "so near the end the active set no longer changes, and it is not that of a solution"
        return _unending(step, longest)

    return reason


def first_patience(n: int) -> Patience:
    """How long the first path is worth following before others from random starts.

    `n`: The order.
    """
    return lambda step: _unending(step, FIRST_PATH * (RESTART_STEPS + n))


def _unending(step: Step, longest: int) -> str:
    return f"it has not ended after {step.index} steps" if step.index >= longest else ""


def light(path: Path) -> Path:
    """The same path with only its two ends, and no curve between them.

    `path`: Is changed.
    """
    if path.steps:
        path.steps = [evolve(step, segment=None) for step in (path.steps[0], path.steps[-1])]
    return path


def trace_light(restart: Restart, budget: Budget) -> Path:
    """What a worker does: trace a restart and send back what is small enough to send."""
    return light(restart.trace(budget))
