"""Branch points on random paths: missed, invented, branches switched in silence, paths that stick; each preset.

python examples/benchmarks/crossings.py [NUMBER] [SEED] [FAMILY ...]
"""

import sys
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from campaign import WRONG, Campaign, Verdict
from crossed import Crossed, pairs, pitchfork, transcritical, transversal

import continuation as ct

FAMILIES: dict[str, Callable[..., Crossed]] = {
    "transversal": transversal,
    "apart": partial(transversal, near=False),
    "pairs": pairs,
    "pitchfork": pitchfork,
    "transcritical": transcritical,
}
LOCATED = 1e-10
"""Largest error of a crossing, relative to the path's extent (x_0 and s are of size one)."""


def judged(problem: Crossed, preset: ct.Preset) -> tuple[str, float, Any]:
    """The fault of a problem's trace, or ""; the largest error of a branch point; the path."""
    path = ct.trace(problem.homotopy, preset=preset, budget=ct.Budget(steps=1000))
    if not path.success:
        return f"stuck: {path.status.name}", np.nan, path
    found = [event for event in path.events if event.kind == ct.Kind.BRANCH_POINT]
    x, s = problem.original(path.endpoint.y, path.endpoint.lam)
    expected = problem.curve(s)
    if max(abs(x[0] - expected[0]), abs(s - expected[1])) > 1e-7:
        return ("switched, " + ("said" if len(found) % 2 != len(problem.crossings) % 2 else "silent")), np.nan, path
    if len(found) != len(problem.crossings):
        return f"found {len(found)} of {len(problem.crossings)}", np.nan, path
    places = [problem.original(event.y, event.lam) for event in found]
    error = max(max(abs(p[0] - q), abs(r - t)) for (p, r), (q, t) in zip(places, problem.crossings))
    return ("" if error <= LOCATED + problem.resolution else "badly located"), error, path


def drawn(name: str, count: int, seed: int) -> Iterator[Crossed]:
    """So many problems of a family, of 1 to 50 unknowns."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        n = int(rng.integers(1, 51)) if k % 2 else int(rng.integers(1, 6))
        yield FAMILIES[name](rng, n, float(rng.choice([0.0, 2.0, 6.0])))


def judge(problem: Crossed, preset: ct.Preset) -> Verdict:
    """The fault of a trace, and the number of factorisations."""
    wrong, _, path = judged(problem, preset)
    return f"{WRONG}: {wrong}" if wrong else "", path.counts.factorizations


CAMPAIGN = Campaign({name: partial(drawn, name) for name in FAMILIES}, judge)

if __name__ == "__main__":
    sys.exit(CAMPAIGN.main(100))
