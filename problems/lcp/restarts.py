"""Paths from random starts: where they begin, the parts that make them quick, and when one is given up.

A path of the KKT homotopy may end at a stationary point that does not solve the problem; another start leads elsewhere.
Measured on random nonmonotone problems (docs/lcp_benchmark.md): starts far out, of uniform products, solve several
times as often as starts near the solution; what tells them apart is the weight of one multiplier against the other.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from contextlib import closing
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.budget import Budget
from continuation.controllers import AllgowerGeorg
from continuation.correctors import BorderedNewton
from continuation.path import Kind, Path
from continuation.predictors import Hermite
from continuation.presets import Preset
from continuation.tracer import Observer, Tracer
from problems.lcp.faces import Faces
from problems.lcp.finish import Finish, Finishing, smallest_parameter
from problems.lcp.homotopies import (
    KKTHomotopy,
    Start,
    Structure,
    TwoVectorHomotopy,
    WangHomotopy,
    XuHomotopy,
    YuHomotopy,
    ZhaoHomotopy,
)
from problems.lcp.homotopies.starts import SPREAD, natural_units
from problems.lcp.problem import LCP

Band = tuple[float, float]

FAR: tuple[Band, ...] = ((0.7, 1.5), (1.5, 2.5), (0.7, 1.5), (-0.3, 0.5))
NEAR: tuple[Band, ...] = ((-0.5, 0.0), (0.0, 0.5))
"""Ten to a power from these intervals, in turn, is the distance of a start in natural units.

Starts far out solve most, and each band solves problems that the others do not; for A >= 0 only near ones do well.
"""

WEIGHTS = (0.1, 0.02, 0.8)
"""Standard deviation of the decimal logarithm of the weight of z2 against z1: at first, growth a restart, at most."""

SMALLEST = 5e-5
"""Products x z1 below this, in natural units: what the active set is then, it remains."""

LONGEST = 100
"""Steps, and n more, after which a restart is given up: few that turn so often end well, and none of them soon."""

LARGEST_FRESH = 150
"""Up to this order a factorisation costs no more than the solves by which an old one is refined."""

TRACE_TOLERANCE = 1e-2
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


def restart_start(problem: LCP, generator: np.random.Generator, k: int, bands: tuple[Band, ...] = FAR) -> Start:
    """The start of the k-th restart: scale, weight and components random, x z1 and w z2 each uniform.

    Parameters
    ----------
    problem : LCP
    generator : numpy.random.Generator
        Its state decides, so that restarts can be repeated.
    k : int
        The weights spread wider as k grows.
    bands : tuple of intervals
        `FAR` or `NEAR`.
    """
    x, w = natural_units(problem)
    scale = 10.0 ** generator.uniform(*bands[k % len(bands)])
    first, growth, most = WEIGHTS
    weight = 10.0 ** (min(first + growth * k, most) * generator.standard_normal())
    x0 = scale * x * generator.uniform(*SPREAD, problem.n)
    w0 = np.maximum(problem.w(x0), 0.0) + scale * w * generator.uniform(*SPREAD, problem.n)
    product = scale * scale * x * w
    return Start(x0, product / x0, weight * product / w0, w0)


TWO_VECTOR = {"wang": WangHomotopy, "yu": YuHomotopy, "zhao": ZhaoHomotopy, "xu": XuHomotopy}
"""The homotopies in (x, y), by the names that `solve` takes."""


@frozen(eq=False)
class Restart:
    """The k-th restart: it depends on the problem, the seed and k alone, and can be sent to another process.

    Attributes
    ----------
    structure : Structure
        Of the problem.
    name : str
        "kkt", or that of a homotopy in (x, y).
    bands : tuple of intervals
        How far out it may begin.
    seed, k : int
    tolerance : float or None
        Of the finish; None to go without it.
    options : mapping
        For the tracer, over those of `search_preset`.
    """

    structure: Structure
    name: str
    bands: tuple[Band, ...]
    seed: int
    k: int
    tolerance: float | None
    options: Mapping[str, Any]

    def homotopy(self) -> KKTHomotopy | TwoVectorHomotopy:
        """The homotopy at its start."""
        problem = self.structure.problem
        start = restart_start(problem, np.random.default_rng([self.seed, self.k]), self.k, self.bands)
        if self.name == "kkt":
            return KKTHomotopy(problem, start.x0, start.z1, start.z2, start.w0, structure=self.structure)
        return TWO_VECTOR[self.name](problem, start.x0, start.w0, structure=self.structure)

    def trace(self, budget: Budget, observers: tuple[Observer, ...] = ()) -> Path:
        """The path, to its end or until it is given up; its counts hold those of the finish too."""
        homotopy = self.homotopy()
        n = self.structure.n
        finish = None if self.tolerance is None else Finish(Faces(self.structure), self.tolerance)
        # A pure path is its own end, so it is traced in earnest.
        traced = homotopy if finish is None else Finishing(homotopy, finish, rough=True)
        tolerance = PURE_TOLERANCE if finish is None else TRACE_TOLERANCE
        # What counts is where the path ends, and that the finish finds.
        options = {
            "preset": search_preset(n), "tolerance": tolerance, "examine": finish is None, **self.options
        }  # fmt: skip
        tracer = Tracer(traced, budget=budget, observers=observers, **options)
        with closing(_reasons(tracer, homotopy, finish is not None)) as reasons:
            reason = next(reasons, "")
        if reason:
            tracer.path.message = f"Given up: {reason}."
        if finish is not None:
            tracer.path.counts.factorizations += finish.counts.factorizations
        return tracer.path


def _reasons(
    tracer: Tracer, homotopy: KKTHomotopy | TwoVectorHomotopy, impatient: bool
) -> Generator[str, None, None]:
    """Trace, and yield a reason to give up whenever there is one: a path among many is not followed at any price."""
    least, longest = smallest_parameter(homotopy, SMALLEST), LONGEST + homotopy.n
    for step in tracer:
        if not impatient or step.kind != Kind.REGULAR:
            continue
        if step.lam < least:
            yield "so near the end the active set no longer changes, and it is not that of a solution"
        elif step.index >= longest:
            yield f"it has not ended after {step.index} steps"


def light(path: Path) -> Path:
    """The same path with only its two ends, and no curve between them."""
    if path.steps:
        path.steps = [evolve(step, segment=None) for step in (path.steps[0], path.steps[-1])]
    return path


def trace_light(restart: Restart, budget: Budget) -> Path:
    """What a worker does: trace a restart and send back what is small enough to send."""
    return light(restart.trace(budget))
