"""What each method of `lcp.solve` is worth: a mix of problems with all of them, and with each taken out in turn.

    python examples/benchmarks/lcp/ablation.py [all] [each] [sets] [--seed S] [--limit S]

"all" prints each family, "each" a line for every row of the table that is taken out, "sets" one for a few kept alone.
"""

import argparse
import math
import signal
import time
from collections.abc import Callable, Iterator
from typing import Any

import bodies
import generators
import numpy as np
import outside
import units

from continuation import Budget
from problems import lcp
from problems.lcp.search import solver
from problems.lcp.search.table import AUTOMATIC
from problems.scenes.registry import available, make

Problem = Any
"""An LCP, one with bounds, or a program."""

WITHOUT_LCP = "arc length", "painleve rod", "bratu lid", "snap-through", "arch", "game"
"""Scenes that are paths, or take long to make."""


def random_kinds(seed: int) -> Iterator[Problem]:
    """The ten kinds of `units.py`, n = 2 to 80."""
    for k in range(100):
        r = np.random.default_rng([seed, k])
        n = round(2.0 * 40.0 ** r.random())
        yield lcp.LCP(*units.KINDS[k % 10](n, r))


def hostile(seed: int) -> Iterator[Problem]:
    """The same with every row and column in a unit of its own, or entries 10^U(-200, 200); n = 2 to 12."""
    for k in range(60):
        r = np.random.default_rng([seed, k, 1])
        A, q = units.KINDS[k % 10](int(r.integers(2, 13)), r)
        n = len(q)
        if k % 3:
            D, E = 10.0 ** r.uniform(-8, 8, (2, n))
            yield lcp.LCP(D[:, None] * A * E, D * q)
        else:
            yield lcp.LCP(A * 10.0 ** r.uniform(-200, 200, (n, n)), q * 10.0 ** r.uniform(-200, 200, n))


def published(seed: int) -> Iterator[Problem]:
    """The families of docs/lcp_benchmark.md, n = 20 to 300."""
    g = generators
    for n in (20, 100, 300):
        yield from (g.positive_definite(n, seed), g.semidefinite(n, seed), g.bimatrix(n, seed))
        yield from (g.frictional_contact(min(n, 100), seed + k) for k in range(3))
    yield from (f(n) for f in (g.murty, g.fathi) for n in (10, 20, 50))
    yield from (g.american_option(300), g.obstacle_1d(300), g.obstacle_2d(17))


def nonmonotone(seed: int) -> Iterator[Problem]:
    """Gaussian, with a planted solution, n = 20 to 300."""
    yield from (generators.random_planted(n, seed + k) for n in (20, 50, 100) for k in range(5))
    yield from (generators.random_planted(300, seed + k) for k in range(2))


def infeasible(seed: int) -> Iterator[Problem]:
    """No feasible point, n = 5 to 100."""
    for k in range(16):
        yield lcp.LCP(*units.infeasible((5, 15, 40, 100)[k % 4], np.random.default_rng([seed, k, 2])))


def with_bounds(seed: int) -> Iterator[Problem]:
    """Programs in a box, with rows, and problems with bounds of no program, n = 5 to 100."""
    for k in range(30):
        r = np.random.default_rng([seed, k, 3])
        n = (5, 20, 60)[k % 3]
        M = r.standard_normal((n, n if k % 2 else n // 2 + 1))
        P = M @ M.T / n if k < 20 else (M @ M.T if k % 2 else np.triu(r.integers(-9, 10, (n, n)), 1)) * 1.0
        P = P if k < 20 or k % 2 else P + P.T
        lower, upper = -r.random(n), r.random(n)
        if k % 5 == 0:
            A = r.standard_normal((n, n))
            x = np.clip(r.normal(0.0, 1.0, n), lower, upper)
            w = np.where(x == lower, 1.0, np.where(x == upper, -1.0, 0.0)) * r.random(n)
            yield lcp.MixedLCP(A, w - A @ x, lower, upper)
        elif k % 5 < 3:
            yield lcp.from_qp(P, r.standard_normal(n), lower=lower, upper=upper)
        else:
            G = r.standard_normal((n // 2, n))
            yield lcp.from_qp(P, r.standard_normal(n), G, G @ np.full(n, 0.1), lower=np.zeros(n))


def scenes(seed: int) -> Iterator[Problem]:
    """All scenes that are one problem."""
    for name in available():
        if name not in WITHOUT_LCP:
            try:
                problem = make(name).problem
            except (AttributeError, TypeError):
                continue
            problem = problem() if callable(problem) else problem
            if isinstance(problem, (lcp.LCP, lcp.MixedLCP, lcp.Program)):
                yield problem


def some(family: Callable[[int], Iterator[outside.Data]], most: int) -> Callable[[int], Iterator[Problem]]:
    """So many problems of a family of `outside.py`."""

    def chosen(seed: int) -> Iterator[Problem]:
        problems = list(family(seed))
        for i in np.unique(np.linspace(0, len(problems) - 1, most).round().astype(int)):
            yield lcp.LCP(*problems[i])

    return chosen


MIX: dict[str, Callable[[int], Iterator[Problem]]] = {
    "ten random kinds": random_kinds, "hostile": hostile, "published": published, "nonmonotone": nonmonotone,
    "infeasible": infeasible, "with bounds": with_bounds, "scenes": scenes,
    **{f.__name__: some(f, k) for f, k in ((outside.box_qp, 10), (outside.collapse, 15), (outside.contact, 10),
       (outside.unsolvable, 15), (outside.games, 14), (outside.monotone, 12), (outside.small, 40), (outside.grids, 6),
       (bodies.stacks, 10), (bodies.arches, 10), (bodies.piles, 10))},
}  # fmt: skip


SETS = {
    "active sets, pivots": ("active sets", "pivots"),
    "without reflections": ("active sets", "all faces", "pivots", "root", "few groups of faces", "groups of faces",
                            "paths", "restarts"),
    "without exclusion": ("active sets", "pivots", "reflections", "paths", "reflections, further", "restarts"),
    "without paths": ("active sets", "all faces", "pivots", "root", "few groups of faces", "reflections",
                      "groups of faces", "reflections, further"),
    "paths, restarts": ("paths", "restarts"),
}  # fmt: skip
"""Rows of the table that are kept."""

DECIDED = ("SOLVED", "SOLVED_TO_PRECISION", "UNSOLVABLE", "INFEASIBLE_TO_PRECISION")


def late(*_: object) -> None:
    """Ends a solve at the limit."""
    raise TimeoutError


def measured(problem: Problem, limit: float) -> tuple[str, float]:
    """Outcome and seconds of the processor."""
    began = time.thread_time()
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        outcome = lcp.solve(problem, budget=Budget(steps=math.inf)).outcome.name
    except TimeoutError:
        outcome = "late"
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    return outcome, time.thread_time() - began


def line(title: str, found: list[tuple[str, float]]) -> str:
    """A row of a table in Markdown: solved, proved, left, seconds together and in the median."""
    outcomes = [outcome for outcome, _ in found]
    solved, decided = (sum(o in DECIDED[:k] for o in outcomes) for k in (2, 4))
    seconds = [s for _, s in found]
    counts = f"{solved} | {decided - solved} | {len(found) - decided}"
    return f"| {title} | {counts} | {sum(seconds):.1f} s | {1e3 * float(np.median(seconds)):.2f} ms |"


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser()
    parser.add_argument("what", nargs="*", default=["all"])
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--limit", type=float, default=1.5)
    arguments = parser.parse_args()
    signal.signal(signal.SIGPROF, late)
    problems = {name: list(family(arguments.seed)) for name, family in MIX.items()}
    every = [problem for family in problems.values() for problem in family]
    print("| | solved | proved to have no solution | left | all | median |\n|---|---:|---:|---:|---:|---:|")
    if "all" in arguments.what:
        for name, family in problems.items():
            print(line(name, [measured(problem, arguments.limit) for problem in family]), flush=True)
    kept = {"the table": tuple(row.name for row in AUTOMATIC)}
    if "each" in arguments.what:
        kept |= {f"without {row.name}": tuple(r.name for r in AUTOMATIC if r is not row) for row in AUTOMATIC}
    kept |= SETS if "sets" in arguments.what else {}
    for title, names in kept.items():
        solver.AUTOMATIC = tuple(row for row in AUTOMATIC if row.name in names)
        print(line(title, [measured(problem, arguments.limit) for problem in every]), flush=True)


if __name__ == "__main__":
    main()
