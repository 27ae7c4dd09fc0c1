"""S-bends of a thousandth to a tenth of the path's extent: how many of their turning points are missed.

    python examples/benchmarks/bends.py [NUMBER] [SEED] ["KIND WIDTH" ...]

lam = g(y) - a s((y - y0) / w) for y from 0 to 1, with a smooth step s of width w, on a straight and on a curved path.
"""

import sys
from collections.abc import Callable
from functools import cache

import numpy as np
from campaign import WRONG, Campaign, Cases, Verdict

import continuation
from continuation.arrays import Array

WIDTHS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3)

Function = Callable[[Array], Array]
KINDS: dict[str, tuple[Function, Function, Function, Function]] = {
    "tanh": (lambda y: y, lambda y: 1.0 + 0.0 * y, np.tanh, lambda t: 1.0 / np.cosh(np.clip(t, -300.0, 300.0)) ** 2),
    "arctan": (lambda y: y, lambda y: 1.0 + 0.0 * y, np.arctan, lambda t: 1.0 / (1.0 + t * t)),
    "curved": (
        lambda y: y + 0.3 * np.sin(2.0 * y),
        lambda y: 1.0 + 0.6 * np.cos(2.0 * y),
        np.tanh,
        lambda t: 1.0 / np.cosh(np.clip(t, -300.0, 300.0)) ** 2,
    ),
}


@cache
def bend(kind: str, width: float, seed: int) -> tuple[object, int]:
    """A homotopy with one S-bend, and the number of its turning points before the target."""
    g, slope, step, rise = KINDS[kind]
    r = np.random.default_rng([seed, round(-10.0 * np.log10(width)), len(kind)])
    y0, a = r.uniform(0.15, 0.85), width * r.uniform(1.3, 3.0)

    def f(y: Array) -> Array:
        return g(y) - a * step((y - y0) / width)

    def df(y: Array) -> Array:
        return slope(y) - a / width * rise((y - y0) / width)

    y = np.linspace(0.0, 1.0, 400_001)
    target = float(f(np.ones(1))[0])
    first = int(np.flatnonzero(np.diff(np.sign(f(y) - target)) != 0.0)[0]) + 1
    turns = int(np.count_nonzero(np.diff(np.sign(df(y[: first + 1]))) != 0.0))
    homotopy = continuation.from_functions(
        lambda y, lam: f(y) - lam,
        lambda y, lam: (df(y)[:, None], -np.ones(1)),
        start=(np.zeros(1), float(f(np.zeros(1))[0])),
        target=target,
    )
    return homotopy, turns


def cases(kind: str, width: float) -> Cases:
    """So many bends, of seeds from one on."""
    return lambda number, first: (bend(kind, width, seed) for seed in range(first, first + number))


def judge(case: tuple[object, int], preset: continuation.Preset) -> Verdict:
    """How many turning points are missed, and the number of factorisations."""
    homotopy, turns = case
    path = continuation.trace(homotopy, preset=preset, budget=continuation.Budget(steps=3000))
    missed = turns - len(path.turning_points)
    right = path.status is continuation.Status.REACHED_TARGET and not missed
    return "" if right else f"{WRONG}: {path.status.name}, {missed} missed", path.counts.factorizations


CAMPAIGN = Campaign({f"{kind} {width:g}": cases(kind, width) for width in WIDTHS for kind in KINDS}, judge)

if __name__ == "__main__":
    sys.exit(CAMPAIGN.main(100))
