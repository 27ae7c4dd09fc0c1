"""Twelve problems, four presets, random units: the same status, the same events, the same work?

    python examples/benchmarks/units.py [NUMBER] [SEED] [PROBLEM ...]

NUMBER changes of units (default 200) y -> D y + c, lam -> a lam + b, H -> E H for each problem and preset. An event
agrees if it lies within 1e-8 of the path's extent, by component, from that of the path in its own units.
"""

import sys
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
from attrs import frozen
from campaign import WRONG, Campaign, Cases, Verdict
from rescaled import Rescaled, rescaled

import continuation
from problems.bifurcation import Aircraft, Bratu1D, Bratu2D, Circle, Cusp, ExponentialCosine, FreudensteinRoth
from problems.nonlinear import brown, fixed_point

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


PROBLEMS = {
    "circle": Problem(Circle),
    "cusp": Problem(Cusp),
    "Freudenstein-Roth": Problem(FreudensteinRoth),
    "Bratu 1D": Problem(lambda: Bratu1D(30), twice=1.0),
    "Bratu 2D": Problem(lambda: Bratu2D(8), twice=2.0),
    "aircraft": Problem(lambda: Aircraft(-0.008), turns=3, direction=-1),
    "Brown": Problem(lambda: fixed_point(brown(10), np.zeros(10), brown(10).jacobian)),
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


@cache
def reference(name: str, preset: continuation.Preset) -> continuation.Path:
    """The path in the problem's own units."""
    return PROBLEMS[name].trace(Rescaled(PROBLEMS[name].make()), preset)


def cases(name: str) -> Cases:
    """A problem in so many random units."""

    def draw(number: int, seed: int) -> Iterator[tuple[str, Rescaled]]:
        generator, homotopy = np.random.default_rng([seed, len(name)]), PROBLEMS[name].make()
        extent = extent_of(reference(name, continuation.DEFAULT))
        return ((name, rescaled(homotopy, extent, generator)) for _ in range(number))

    return draw


def judge(case: tuple[str, Rescaled], preset: continuation.Preset) -> Verdict:
    """The difference from the path in the problem's own units, and factorisations over those of that."""
    name, units = case
    path, own = PROBLEMS[name].trace(units, preset), reference(name, preset)
    found = difference(path, own, units)
    return f"{WRONG}: {found}" if found else "", path.counts.factorizations / own.counts.factorizations


CAMPAIGN = Campaign({name: cases(name) for name in PROBLEMS}, judge, cost="factorisations over those in own units")

if __name__ == "__main__":
    sys.exit(CAMPAIGN.main(200))
