"""S-bends of a thousandth to a tenth of the path's extent: how many of their turning points are missed.

    python examples/benchmarks/bends.py [NUMBER] [SEED] ["KIND WIDTH" ...]

lam = g(y) - a s((y - y0) / w) for y from 0 to 1, with a smooth step s of width w, on a straight and on a curved path.
"""

import sys
from collections.abc import Callable
from functools import cache

import numpy as np
from campaign import Campaign, Cases, Verdict
from ends import Case, wrong

import continuation
from continuation.arrays import Array

WIDTHS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3)

Function = Callable[[Array], Array]
KINDS: dict[str, tuple[Function, Function]] = {
    "tanh": (lambda y: y, np.tanh),
    "arctan": (lambda y: y, np.arctan),
    "curved": (lambda y: y + 0.3 * np.sin(2.0 * y), np.tanh),
}


@cache
def bend(kind: str, width: float, seed: int) -> Case:
    """A path with one S-bend, and the number of its turning points before the target."""
    g, step = KINDS[kind]
    r = np.random.default_rng([seed, round(-10.0 * np.log10(width)), len(kind)])
    y0, a = r.uniform(0.15, 0.85), width * r.uniform(1.3, 3.0)

    def f(y: Array) -> Array:
        return g(y) - a * step((y - y0) / width)

    table = f(np.linspace(0.0, 1.0, 400_001))
    target = float(table[-1])
    first = int(np.flatnonzero(np.diff(np.sign(table - target)) != 0.0)[0]) + 1
    turns = int(np.count_nonzero(np.diff(np.sign(np.diff(table[: first + 1]))) != 0.0))
    return Case(lambda y, lam: f(y) - lam, (np.zeros(1), float(table[0])), target, folds=turns)


def cases(kind: str, width: float) -> Cases:
    """So many bends, of seeds from one on."""
    return lambda number, first: (bend(kind, width, seed) for seed in range(first, first + number))


def judge(case: Case, preset: continuation.Preset) -> Verdict:
    """The fault of a path, and the number of factorisations."""
    path = continuation.trace(case.homotopy(), preset=preset, budget=continuation.Budget(steps=3000))
    return wrong(path, case), path.counts.factorizations


CAMPAIGN = Campaign({f"{kind} {width:g}": cases(kind, width) for width in WIDTHS for kind in KINDS}, judge)

if __name__ == "__main__":
    sys.exit(CAMPAIGN.main(100))
