"""Performance profiles on random problems."""

from __future__ import annotations

from collections.abc import Sequence

import continuation
from continuation.chart import Profile, Study
from continuation.chart.study import Size
from problems.charts.families import FAMILIES
from problems.charts.lcp import RESIDUAL, direct_methods, path, problem, solver
from problems.lcp.homotopies.registry import HOMOTOPIES


def studies(size: Size, compare: bool) -> Sequence[Study]:
    """The chart's panels: one a family of random problems, with a solution planted in each.

    `compare`: add other software.
    """
    orders, seeds = {"smoke": ((5,), 1), "moderate": ((6, 12), 4), "full": ((5, 10, 20, 50), 25)}[size]
    families = ("semidefinite", "N") if size == "smoke" else [name for name in FAMILIES if name != "obstacle"]
    methods = [
        *(path(one.title, one.make) for one in HOMOTOPIES.values()),
        *((path("KKT, series", HOMOTOPIES["kkt"].make, preset=continuation.SERIES),) if size == "full" else ()),
        solver("KKT, finish", homotopy="kkt"),
        solver("solve, auto", restarts=5),
        *direct_methods(compare),
    ]
    return [
        Study(
            name="robustness",
            title="Random problems with a planted solution",
            problems=[problem(family, n, seed) for family in families for n in orders for seed in range(seeds)],
            methods=methods,
            ladder=(1e-8,),
            errors=RESIDUAL,
            work=("factorizations", "solves", "seconds"),
            figures=[Profile("factorizations")],
            repeats={"smoke": 0, "moderate": 0, "full": 1}[size],
        )
    ]
