"""Twelve problems, four presets, random units: the same status, the same events, the same work?

    python examples/benchmarks/units/run.py [NUMBER] [SEED]

NUMBER changes of units (default 200) y -> D y + c, lam -> a lam + b, H -> E H for each problem and preset. An event
agrees if it lies within 1e-8 of the path's extent, by component, from that of the path in its own units.
"""

import sys
from collections.abc import Callable
from pathlib import Path as File
from typing import Any

import numpy as np
from attrs import frozen

import continuation
from problems.bifurcation import Aircraft, Bratu1D, Bratu2D, Circle, Cusp, ExponentialCosine, FreudensteinRoth
from problems.nonlinear import brown, fixed_point

sys.path.insert(0, str(File(__file__).parent))
from rescaled import Rescaled, plain, rescaled

PRESETS = (continuation.FAST, continuation.DEFAULT, continuation.CONSERVATIVE, continuation.SERIES)
AGREEMENT = 1e-8


@frozen
class Problem:
    """A homotopy, a turn at which its path ends or a value of the parameter that it takes twice, and a direction."""

    make: Callable[[], Any]
    turns: int = 0
    twice: float | None = None
    direction: int = 0

    def trace(self, homotopy: Rescaled, preset: continuation.Preset) -> continuation.Path:
        """The path in the given units."""
        events: list[Any] = [continuation.TurningPoint(terminal=self.turns)]
        if self.twice is not None:
            events.append(continuation.TargetValue(homotopy.a * self.twice + homotopy.b, terminal=2))
        budget = continuation.Budget(steps=3000)
        return continuation.trace(homotopy, preset=preset, events=events, direction=self.direction, budget=budget)


def _brown() -> Any:
    F = brown(10)
    return fixed_point(F, np.zeros(10), F.jacobian)


PROBLEMS = {
    "circle": Problem(Circle),
    "cusp": Problem(Cusp),
    "Freudenstein-Roth": Problem(FreudensteinRoth),
    "Bratu 1D": Problem(lambda: Bratu1D(30), twice=1.0),
    "Bratu 2D": Problem(lambda: Bratu2D(8), twice=2.0),
    "aircraft": Problem(lambda: Aircraft(-0.008), turns=3, direction=-1),
    "Brown": Problem(_brown),
    **{f"exponential-cosine {n}": Problem(lambda n=n: ExponentialCosine(n)) for n in range(2, 7)},
}


def difference(path: continuation.Path, reference: continuation.Path, units: Rescaled) -> str:
    """In what a path differs from the one in its own units; empty if in nothing."""
    if path.status is not reference.status:
        return f"{path.status.name} instead of {reference.status.name}"
    if len(path.events) != len(reference.events):
        return f"{len(path.events)} events instead of {len(reference.events)}"
    extent = extent_of(reference)
    off = [np.abs((units.original(e.u) - f.u) / extent).max() for e, f in zip(path.events, reference.events)]
    return f"an event is off by {max(off):.1g}" if off and max(off) > AGREEMENT else ""


def extent_of(path: continuation.Path) -> Any:
    """How far each component goes."""
    extent = np.ptp(path.u, axis=0)
    return np.where(extent > 0.0, extent, 1.0)


def compare(name: str, preset: continuation.Preset, number: int, seed: int) -> tuple[list[str], list[float], int]:
    """The differences, the factorisations of the others relative to those in the problem's units, and those."""
    problem, generator = PROBLEMS[name], np.random.default_rng([seed, len(name)])
    homotopy = problem.make()
    reference = problem.trace(plain(homotopy), preset)
    wrong, ratios = [], []
    for _ in range(number):
        units = rescaled(homotopy, extent_of(reference), generator)
        path = problem.trace(units, preset)
        found = difference(path, reference, units)
        if found:
            wrong.append(found)
        else:
            ratios.append(path.counts.factorizations / reference.counts.factorizations)
    return wrong, ratios, reference.counts.factorizations


def main(number: int, seed: int) -> int:
    """Print a line a problem and preset; how many paths differ."""
    total = 0
    for name in PROBLEMS:
        for preset in PRESETS:
            wrong, ratios, work = compare(name, preset, number, seed)
            total += len(wrong)
            spread = f"{min(ratios):.2f} to {max(ratios):.2f}" if ratios else "-"
            print(f"{name:22s} {preset.name:13s} {work:5d} factorisations, ratio {spread}; "
                  f"{len(wrong)} of {number} differ {sorted(set(wrong))[:3]}", flush=True)  # fmt: skip
    print(f"{total} of {number * len(PROBLEMS) * len(PRESETS)} differ")
    return total


if __name__ == "__main__":
    arguments = [int(value) for value in sys.argv[1:]]
    sys.exit(min(main(*(arguments + [200, 0][len(arguments) :])), 1))
