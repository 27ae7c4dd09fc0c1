"""Cost against problem size."""

from __future__ import annotations

from collections.abc import Sequence

import continuation
from continuation.chart import END_POINT, Lines, Problem, Study, traced
from continuation.chart.study import Size
from problems import lcp
from problems.charts.lcp import RESIDUAL, direct_methods, path, problem, solver
from problems.charts.subjects import bratu, bratu_square


def studies(size: Size, compare: bool) -> Sequence[Study]:
    """Bifurcation problems and LCPs at one tolerance."""
    repeats = {"smoke": 0, "moderate": 1, "full": 3}[size]
    presets = (continuation.DEFAULT, continuation.FAST, continuation.SERIES)
    curves = Study(
        name="scaling-curves",
        title="Cost of a path round a fold against size",
        problems=_curves(size),
        methods=[traced(preset.name, preset=preset) for preset in presets],
        ladder=(1e-8,),
        errors=END_POINT,
        work=("seconds", "factorizations"),
        figures=[Lines("n", ("seconds", "factorizations"))],
        repeats=repeats,
    )
    sizes = {"smoke": (5, 10), "moderate": (10, 30, 100, 300), "full": (5, 10, 20, 50, 100, 200, 500, 1000)}[size]
    families = ("semidefinite",) if size == "smoke" else ("semidefinite", "scaled P", "obstacle")
    methods = [
        path("KKT", lcp.KKTHomotopy),
        *((path("KKT, series", lcp.KKTHomotopy, preset=continuation.SERIES),) if size == "full" else ()),
        path("Wang", lcp.WangHomotopy),
        path("Wang, series", lcp.WangHomotopy, preset=continuation.SERIES),
        solver("solve, auto"),
        *direct_methods(compare),
    ]
    complementarity = Study(
        name="scaling-lcp",
        title="Cost of a linear complementarity problem against its order",
        problems=[problem(family, n, 0) for family in families for n in sizes],
        methods=methods,
        ladder=(1e-8,),
        errors=RESIDUAL,
        work=("seconds", "factorizations"),
        figures=[Lines("n", ("seconds", "factorizations"))],
        repeats=repeats,
    )
    return [curves, complementarity]


def _curves(size: Size) -> list[Problem]:
    if size == "smoke":
        return [bratu(n) for n in (10, 20)]
    banded, sparse = {
        "moderate": ((30, 100, 300, 1000), (10, 20, 40)),
        "full": ((30, 100, 300, 1000, 3000, 10000), (10, 20, 40, 80)),
    }[size]
    return [*map(bratu, banded), *map(bratu_square, sparse)]
