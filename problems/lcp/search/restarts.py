"""Paths from random starts: where they begin, the parts that make them quick, and when one is given up.

A path of the KKT homotopy may end at a stationary point of x'w that does not solve the problem; another start leads
elsewhere. Measured on random nonmonotone problems (docs/lcp_benchmark.md): starts far out, whose products x z1 and w z2
are all about equal, solve several times as often as others. Where a path failed, its large products x_i w_i get more
weight in the objective of the next, which then has other stationary points, while the solutions stay.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from contextlib import closing
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.budget import Budget
from continuation.controllers import AllgowerGeorg
from continuation.correctors import BorderedNewton
from continuation.path import Path
from continuation.predictors import Hermite
from continuation.presets import Preset
from continuation.status import Kind
from continuation.step.tracer import Observer, Tracer
from continuation.tolerance import Tolerance
from problems.lcp.active_set.face import Faces
from problems.lcp.active_set.finish import Finish, Finishing, smallest_parameter
from problems.lcp.data.problem import LCP
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
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.farkas import scaled_data

Band = tuple[float, float]

FAR: tuple[Band, ...] = ((0.7, 2.5),)
NEAR: tuple[Band, ...] = ((-0.5, 0.0), (0.0, 0.5))
"""Ten to a power from these intervals, in turn, is the distance of a start in natural units.

Starts far out solve most; for A >= 0 only near ones do well.
"""

SPREAD = 0.5
"""Standard deviation of the natural logarithms of the components of a start; with 0 or 1 half as many paths solve."""

BALANCE = (0.05, 0.1)
"""Mean and standard deviation of the decimal logarithm of the products w z2 over the products x z1.

At a point where all x_i w_i are equal, z1 = w and z2 = x satisfy the optimality conditions where the two products are
equal: then a central point of the LCP is one of the path. At a ratio of 4 or 1/4 next to no path solves.
"""

WEIGHT_GAIN = 1.0
"""How much weight the largest product x_i w_i at the end of a path that failed gains; others by the root of theirs."""

HEAVIEST = 100.0
"""Weights stay below this, and above its inverse, however often the same product is the largest."""

SMALLEST = 5e-5
"""Products x z1 below this, in natural units: what the active set is then, it remains."""

LONGEST = 60
"""Steps, and n more, after which a restart is given up: of 144 paths that solved one took nearly as many."""

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


def restart_start(problem: LCP, generator: np.random.Generator, k: int, bands: tuple[Band, ...] = FAR) -> Start:
    """The start of the k-th restart: scale, balance and components random, all products x z1 equal, and all w z2.

    Parameters
    ----------
    problem : LCP
    generator : numpy.random.Generator
        Its state decides, so that restarts can be repeated.
    k : int
        Decides which of the bands it is from.
    bands : tuple of intervals
        `FAR` or `NEAR`.
    """
    x, w = natural_units(problem)
    scale = 10.0 ** generator.uniform(*bands[k % len(bands)])
    balance = 10.0 ** generator.normal(*BALANCE)
    x0 = scale * x * np.exp(SPREAD * generator.standard_normal(problem.n))
    w0 = np.maximum(problem.w(x0), 0.0) + scale * w * np.exp(SPREAD * generator.standard_normal(problem.n))
    product = scale * scale * x * w
    return Start(x0, product / x0, balance * product / w0, w0)


def reweighted(problem: LCP, weights: Array | None, path: Path) -> Array | None:
    """Weights of the x_i w_i in the objective after a path that failed: those that are not zero at its end gain."""
    if not path.steps:
        return weights
    x = np.maximum(path.endpoint.y[: problem.n], 0.0)
    products = x * np.maximum(problem.w(x), 0.0)
    largest = float(products.max())
    if not 0.0 < largest < np.inf:
        return weights
    gained = (1.0 if weights is None else weights) * (1.0 + WEIGHT_GAIN * np.sqrt(products / largest))
    balanced: Array = np.clip(gained / np.exp(np.log(gained).mean()), 1.0 / HEAVIEST, HEAVIEST)
    return balanced


TWO_VECTOR = {"wang": WangHomotopy, "yu": YuHomotopy, "zhao": ZhaoHomotopy, "xu": XuHomotopy}
"""The homotopies in (x, y), by the names that `solve` takes."""


@frozen(eq=False)
class Restart:
    """The k-th restart: it depends on what is here alone, and can be sent to another process.

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
    weights : Array or None
        Of the x_i w_i in the objective of "kkt", shape (n,); None for ones. The path is then that of the problem whose
        rows are multiplied by them.
    """

    structure: Structure
    name: str
    bands: tuple[Band, ...]
    seed: int
    k: int
    tolerance: float | None
    options: Mapping[str, Any]
    weights: Array | None = None

    def homotopy(self) -> KKTHomotopy | TwoVectorHomotopy:
        """The homotopy at its start."""
        problem = self.structure.problem
        start = restart_start(problem, np.random.default_rng([self.seed, self.k]), self.k, self.bands)
        if self.name == "kkt" and self.weights is not None:
            e = self.weights
            weighted = Structure(LCP(*scaled_data(problem, 1.0 / e, np.ones(problem.n))))
            return KKTHomotopy(weighted.problem, start.x0, start.z1, start.z2 / e, e * start.w0, structure=weighted)
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
        tolerance: Tolerance | float = PURE_TOLERANCE if finish is None else TRACE_TOLERANCE
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
