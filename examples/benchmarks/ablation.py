"""The worth of each method of `lcp.solve`: a mix of problems with all methods, without each one, and with few.

    python examples/benchmarks/ablation.py [NUMBER] [SEED] [--limit S]

NUMBER problems of each family of `outside.py` and of each kind of `claims.py`, hostile ones, some with bounds, and all
scenes that are one problem.
"""

import sys
from collections.abc import Iterator
from typing import Any

import claims
import numpy as np
import outside
from campaign import Campaign, Verdict, asked

from problems import lcp
from problems.lcp.search import solver
from problems.lcp.search.at_once import at_once
from problems.lcp.search.table import AUTOMATIC
from problems.scenes.registry import available, make

ROWS = tuple(row.name for row in AUTOMATIC)
SETS = {
    "active sets, pivots": ("active sets", "pivots"),
    "without exclusion": ("active sets", "pivots", "reflections", "paths", "reflections, further", "restarts"),
    "paths, restarts": ("paths", "restarts"),
}


def mix(number: int, seed: int) -> Iterator[Any]:
    """Everything."""
    for family in outside.FAMILIES.values():
        yield from family(number, seed)
    for k in range(number):
        r = np.random.default_rng([seed, k])
        yield from (lcp.LCP(*kind(round(2.0 * 40.0 ** r.random()), r)) for kind in claims.KINDS.values())
        yield lcp.LCP(*claims.hostile(k, r))
        yield claims.random_problem(r)
    problems = [getattr(make(name), "problem", None) for name in available()]
    yield from (one for one in (make_it() for make_it in problems if make_it) if isinstance(one, outside.Problem))


def judge(problem: Any, kept: tuple[str, ...], limit: float) -> Verdict:
    """The outcome, and milliseconds, with some rows of the table."""
    solver.AUTOMATIC = tuple(row for row in AUTOMATIC if row.name in kept)
    solver.at_once = at_once if "active sets" in kept else lambda *_: None
    return outside.measured(problem, limit)


if __name__ == "__main__":
    _, numbers, options = asked(5, 5, limit=1.5)
    ways = {"the table": ROWS} | {f"without {name}": tuple(n for n in ROWS if n != name) for name in ROWS} | SETS
    campaign = Campaign({"the mix": mix}, lambda problem, kept: judge(problem, kept, options.limit), ways, "ms")
    sys.exit(campaign.run(*numbers))
