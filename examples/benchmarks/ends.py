"""Ends that numbers mislead about, in random units: is each what it is, and at what cost beside textbook scaling?

    python examples/benchmarks/ends.py [NUMBER] [SEED] [FAMILY ...]

Paths whose ends are known: imperfections, symmetry, tails, weak parameters, poles; in units of 1e-4 to 1e4.
A path is wrong if its status is not one of those expected, or its number of folds. Its cost is compared with that of
the path in its own units under the Euclidean metric, if that is right too.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from itertools import accumulate
from typing import Any

import numpy as np
from attrs import frozen
from campaign import WRONG, Campaign, Cases, Verdict, drawn
from scipy.optimize import brentq

import continuation
from continuation import Status
from continuation.arrays import Array

Residual = Callable[[Any, Any], Any]

BUDGET = continuation.Budget(steps=2000, factorizations=6000)


@frozen
class Case:
    """A path: its residual, start and target, how it may end, and how many folds it has."""

    residual: Residual
    start: tuple[Array, float]
    target: float
    ends: tuple[Status, ...] = (Status.REACHED_TARGET,)
    folds: int = 0

    def homotopy(self, D: float = 1.0, a: float = 1.0, E: float = 1.0) -> Any:
        """In units D of the unknowns, a of the parameter, E of the equations."""
        y0, lam0 = self.start
        return continuation.from_functions(
            lambda y, lam: E * self.residual(y / D, lam / a), start=(D * y0, a * lam0), target=a * self.target
        )


def scalar(f: Residual, y0: float, lam0: float, target: float, **known: Any) -> Case:
    """A path in one unknown."""
    return Case(lambda y, lam: np.stack([f(y[0], lam)]), (np.array([y0]), lam0), target, **known)


def imperfect(generator: np.random.Generator) -> Case:
    """A pitchfork, a transcritical point, a cusp or a hysteresis, with an imperfection from 1e-2 to 1e-14."""
    eps = 10.0 ** generator.uniform(-14.0, -2.0)
    kinds: tuple[tuple[Residual, float, float], ...] = (
        (lambda y, lam: lam * y - y**3 + eps, eps, -1.0),
        (lambda y, lam: lam * y - y**2 + eps, eps, -1.0),
        (lambda y, lam: y**3 + eps * y - lam, -1.0, -1.0 - eps),
    )
    return scalar(*kinds[generator.integers(3)], 1.0)


def ring(generator: np.random.Generator) -> Case:
    """Coupled cells that are all zero by symmetry at the start, in a basis in which their terms cancel by rounding."""
    n = int(generator.integers(3, 8))
    Q, _ = np.linalg.qr(generator.standard_normal((n, n)))
    b, shift = Q[:, 0].copy(), generator.standard_normal(n)

    # Along Q's first column alone: all others stay zero.
    def residual(y: Any, lam: Any) -> Any:
        x = (y + shift) - shift
        along = (x * b).sum()
        return x + b * (along**3) - b * lam

    return Case(residual, (np.zeros(n), 0.0), 2.0)


def localised(generator: np.random.Generator) -> Case:
    """A pulse on a lattice with tails as small as 1e-60, along the way on which it shrinks or grows."""
    n, c = int(generator.integers(12, 31)), 10.0 ** generator.uniform(-2.0, -1.0)

    # The middle decides the parameter; each further cell is c times the one before, and a little of its square.
    def residual(y: Any, lam: Any) -> Any:
        first = y[:1] + y[:1] ** 3 - lam
        return np.concatenate([first, y[1:] * (1.0 + y[1:]) - c * y[:-1]])

    cells = accumulate(range(n - 1), lambda y, _: 2.0 * c * y / (1.0 + np.sqrt(1.0 + 4.0 * c * y)), initial=0.6)
    return Case(residual, (np.array([*cells]), 0.6 + 0.6**3), 2.0)


def hysteresis(generator: np.random.Generator) -> Case:
    """lam = y^3 - d y between its folds, d = 1e-4 to 1, with an unknown that follows and is d times as large."""
    d = 10.0 ** generator.uniform(-4.0, 0.0)
    return Case(
        lambda y, lam: np.stack([y[0] ** 3 - d * y[0] - lam, y[1] - d * y[0] ** 2]),
        (np.array([-1.5, 2.25 * d]), -(1.5**3) + 1.5 * d), 1.5**3 - 1.5 * d, folds=2,
    )  # fmt: skip


def pattern(generator: np.random.Generator) -> Case:
    """The trunk of Swift and Hohenberg's equation on a ring, zero by symmetry, over its patterns' branch points."""
    n, length = int(generator.integers(8, 25)), float(generator.uniform(2.0, 6.0))
    k = np.fft.fftfreq(n, 1.0 / n) / length
    L = np.fft.ifft(((1.0 - k**2) ** 2)[:, None] * np.fft.fft(np.eye(n), axis=0), axis=0).real
    return Case(lambda y, lam: lam * y - L @ y + 1.2 * y**2 - y**3, (np.zeros(n), -1.0), 0.4)


def truss(generator: np.random.Generator) -> Case:
    """A star of bars, at rest, pressed down in its middle: sideways it moves by the rounding of cosines alone."""
    bars, rise = int(generator.integers(3, 12)), float(generator.uniform(0.5, 1.5))
    at = float(generator.uniform(0.0, 6.0))
    feet = np.array([[np.cos(at + a), np.sin(at + a), -rise] for a in 2.0 * np.pi * np.arange(bars) / bars])

    # Energy sum (|bar|^2 - |bar at rest|^2)^2 / 8: forces are polynomials, the load is least at the fold.
    def residual(y: Any, lam: Any) -> Any:
        stretch = [((y - foot) * (y - foot)).sum() - 1.0 - rise**2 for foot in feet]
        force = [0.5 * e * (y - foot) for e, foot in zip(stretch, feet)]
        return sum(force[1:], force[0]) + lam * np.array([0.0, 0.0, 1.0])

    # On the axis the force is bars z' (z'^2 - rise^2) / 2, z' = rise + z: its least value is the fold's load.
    fold = bars * rise**3 / 27.0**0.5
    return Case(residual, (np.zeros(3), 0.0), 0.8 * fold)


def weak(generator: np.random.Generator) -> Case:
    """A parameter that enters by 1e-3 to 1e-12."""
    small, m = 10.0 ** generator.uniform(-12.0, -3.0), float(generator.uniform(1.0, 3.0))
    root = float(brentq(lambda y: y**3 + m * y - 1.0, 0.0, 1.0, xtol=1e-15))
    return scalar(lambda y, lam: y**3 + m * y - 1.0 - small * lam, root, 0.0, 1.0)


def pole(generator: np.random.Generator) -> Case:
    """y ~ (1 - lam)^-p for p = 1/3 to 4, given as y or as its inverse, and a target on it or beyond."""
    p, target = float(generator.choice([1 / 3, 1 / 2, 1.0, 2.0, 3.0, 4.0])), float(generator.choice([1.0, 1.5]))
    return scalar(lambda y, lam: y ** (-1.0 / p) - 1.0 + lam, 1.0, 0.0, target, ends=(Status.DIVERGED,))


FAMILIES: dict[str, Callable[[np.random.Generator], Case]] = {
    "imperfections": imperfect,
    "zero by symmetry": ring,
    "localised": localised,
    "hysteresis": hysteresis,
    "patterns": pattern,
    "trusses": truss,
    "weak parameter": weak,
    "poles": pole,
    # A circle to 1e-1 .. 1e-14 before its fold.
    "before folds": lambda generator: scalar(
        lambda y, lam: y**2 + lam**2 - 1.0, 1.0, 0.0, 1.0 - 10.0 ** generator.uniform(-14.0, -1.0)
    ),
}


def in_units(family: Callable[[np.random.Generator], Case]) -> Cases:
    """Paths, and the same in random units."""

    def draw(_: int, generator: np.random.Generator) -> tuple[Case, Any]:
        case = family(generator)
        return case, case.homotopy(*10.0 ** generator.uniform(-4.0, 4.0, 3))

    return drawn(draw)


def wrong(path: continuation.Path, case: Case) -> str:
    """The fault of a path, or ""."""
    if path.status not in case.ends:
        return f"{WRONG}: {path.status.name}"
    return "" if len(path.turning_points) == case.folds else f"{WRONG}: {len(path.turning_points)} folds"


def judge(drawn_one: tuple[Case, Any], preset: continuation.Preset) -> Verdict:
    """The fault of a path, and factorisations over those of the Euclidean metric in its own units."""
    case, homotopy = drawn_one
    path = continuation.trace(homotopy, preset=preset, budget=BUDGET)
    plain = continuation.trace(case.homotopy(), preset=preset, budget=BUDGET, metric=continuation.Euclidean())
    ratio = np.nan if wrong(plain, case) else path.counts.factorizations / plain.counts.factorizations
    return wrong(path, case), ratio


CAMPAIGN = Campaign({name: in_units(f) for name, f in FAMILIES.items()}, judge, cost="cost")

if __name__ == "__main__":
    sys.exit(CAMPAIGN.main(100))
