"""Paths from random starts: where they begin, the parts that make them quick, and when one is given up.

A path of the KKT homotopy may end at a stationary point that does not solve the problem; another start leads elsewhere.
Measured on random nonmonotone problems (docs/benchmarks/lcp.md): starts far out, of uniform products, solve several
times as often as starts near the solution; what tells them apart is the weight of one multiplier against the other.
"""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen
from numpy.random import Generator

from continuation.arrays import Array
from continuation.controllers import AllgowerGeorg
from continuation.correctors import BorderedNewton
from continuation.path import Path, Step
from continuation.predictors import Hermite
from continuation.presets import Preset
from continuation.progress import Progress
from continuation.status import Status
from continuation.tracer import Observer, Tracer
from problems.lcp.finish import Finish, Finishing
from problems.lcp.homotopies import KKTHomotopy, Start, Structure, TwoVectorHomotopy, WangHomotopy
from problems.lcp.homotopies.starts import SPREAD, natural_units
from problems.lcp.problem import LCP

SCALES = (0.7, 2.0)
"""Ten to a power from this interval is the distance of a start, in natural units."""

WEIGHTS = 0.35
"""Standard deviation of the decimal logarithm of the weight of z2 against z1."""

SMALLEST = 2e-4
"""Products x z1 below this, in natural units: what the active set is then, it remains."""

LONGEST = 150
"""Steps after which a restart is given up: few that turn so often end well, and none of them soon."""

LARGEST_FRESH = 150
"""Up to this order a factorisation costs no more than the solves by which an old one is refined."""

TRACE_TOLERANCE = 1e-4
"""Of the corrector: the end is exact by the finish, on the way it is enough not to lose the path."""


def search_preset(n: int) -> Preset:
    """The parts of a restart for a problem of order n: the longest steps that pay."""
    return Preset(
        "SEARCH",
        "steps that turn up to 40 degrees, for one path among many",
        Hermite(),
        BorderedNewton(reuse=0.0 if n <= LARGEST_FRESH else 0.5),
        AllgowerGeorg(contraction=0.7, distance=0.6, angle=0.7, deceleration=2.0),
    )


def distant_start(problem: LCP, generator: Generator) -> Start:
    """A start of the KKT homotopy far out: scale, weight and components random, x z1 and w z2 each uniform.

    Parameters
    ----------
    problem : LCP
    generator : numpy.random.Generator
        Its state decides, so that restarts can be repeated.
    """
    x, w = natural_units(problem)
    scale = 10.0 ** generator.uniform(*SCALES)
    weight = 10.0 ** (WEIGHTS * generator.standard_normal())
    x0 = scale * x * generator.uniform(*SPREAD, problem.n)
    w0 = np.maximum(problem.w(x0), 0.0) + scale * w * generator.uniform(*SPREAD, problem.n)
    product = scale * scale * x * w
    return Start(x0, product / x0, weight * product / w0, w0)


@frozen(eq=False)
class Restart:
    """The k-th restart: it depends on the problem, the seed and k alone, and can be sent to another process.

    Attributes
    ----------
    problem : LCP
    name : str
        "kkt" or another homotopy's name, for which x0 and w0 of the start serve.
    seed, k : int
    tolerance : float
        Of the certificate; NaN to switch the finish off.
    """

    problem: LCP
    name: str
    seed: int
    k: int

    def homotopy(self, structure: Structure) -> KKTHomotopy | TwoVectorHomotopy:
        """The homotopy at its start."""
        start = distant_start(self.problem, np.random.default_rng([self.seed, self.k]))
        if self.name == "kkt":
            return KKTHomotopy(self.problem, start.x0, start.z1, start.z2, start.w0, structure=structure)
        return WangHomotopy(self.problem, start.x0, start.w0, structure=structure)
