"""Branch points on random paths: missed, invented, branches switched in silence, paths that stick; each preset.

python examples/benchmarks/crossings.py [NUMBER] [SEED] [FAMILY ...]
"""

import sys
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from campaign import WRONG, Campaign, Cases, Verdict
from crossed import Crossed, arm, pairs, pitchfork, transcritical, transversal

import continuation as ct

FAMILIES: dict[str, Callable[..., Crossed]] = {
    "transversal": transversal,
    "apart": partial(transversal, near=False),
    "pairs": pairs,
    "pitchfork": pitchfork,
    "arm": arm,
    "transcritical": transcritical,
}
LOCATED = 1e-10
"""Largest error of a crossing, relative to the path's extent (x_0 and s are of size one)."""


def options(problem: Crossed, on_arm: bool, preset: ct.Preset) -> dict[str, Any]:
    """How a problem is traced; on an arm to an event, as the parameter takes each value twice."""
    given: dict[str, Any] = {"preset": preset, "budget": ct.Budget(steps=1000)}
    if not on_arm:
        return given
    end = ct.Monitor(lambda u, v: problem.first(u[:-1], float(u[-1]))[0] - problem.end, name="the end", terminal=1)
    trunk = problem.point(0.0, problem.curve(0.0)[1] - 2.0)[1]
    return given | {"target": None, "direction": -1, "events": [end, ct.TargetValue(trunk)]}


def judged(problem: Crossed, on_arm: bool, preset: ct.Preset) -> tuple[str, float, Any]:
    """The fault of a problem's trace, or ""; the largest error of a branch point; the path."""
    path = ct.trace(problem, **options(problem, on_arm, preset))
    if not path.success:
        return f"stuck: {path.status.name}", np.nan, path
    found = [event for event in path.events if event.kind == ct.Kind.BRANCH_POINT]
    x, s = problem.first(path.endpoint.y, path.endpoint.lam)
    expected = (problem.end, problem.curve(problem.end)[1]) if on_arm else problem.curve(s)
    if max(abs(x - expected[0]), abs(s - expected[1])) > 1e-7:
        return ("switched, " + ("said" if len(found) % 2 != len(problem.crossings) % 2 else "silent")), np.nan, path
    if len(found) != len(problem.crossings):
        return f"found {len(found)} of {len(problem.crossings)}", np.nan, path
    places = [problem.first(event.y, event.lam) for event in found]
    error = max(max(abs(p - q), abs(r - t)) for (p, r), (q, t) in zip(places, problem.crossings))
    return ("" if error <= LOCATED + problem.resolution else "badly located"), error, path


def drawn(name: str, count: int, seed: int) -> Iterator[Crossed]:
    """So many problems of a family, of 1 to 50 unknowns."""
    rng = np.random.default_rng(seed)
    for k in range(count):
        n = int(rng.integers(1, 51)) if k % 2 else int(rng.integers(1, 6))
        yield FAMILIES[name](rng, n, float(rng.choice([0.0, 2.0, 6.0])))


def judge(case: tuple[Crossed, bool], preset: ct.Preset) -> Verdict:
    """The fault of a trace, and the number of factorisations."""
    wrong, _, path = judged(*case, preset)
    return f"{WRONG}: {wrong}" if wrong else "", path.counts.factorizations


def cases(name: str) -> Cases:
    """So many problems of a family, by its name."""
    return lambda number, seed: ((problem, name == "arm") for problem in drawn(name, number, seed))


CAMPAIGN = Campaign({name: cases(name) for name in FAMILIES}, judge)

if __name__ == "__main__":
    sys.exit(CAMPAIGN.main(100))
