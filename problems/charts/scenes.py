"""Scenes: time against error, ours and rivals'."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from attrs import asdict

from continuation.chart import Answer, Method, Problem, Profile, Study
from continuation.chart.study import WRONG, Size
from continuation.counts import Counts
from problems.scenes import available, error, make, order, solve

ERROR = {"answer": "error of the answer, relative"}

OURS = "ours"

MESHES = ("american-put", "bearing", "bratu-lid", "converter", "membrane", "string", "torsion")
"""Scenes whose error is the mesh's, for any method of solution."""

COUNTS = ("jumps", "steps", "support vectors")
"""Counts that need exact zeros."""

LARGER: dict[str, dict[str, Any]] = {
    "arch": {"stones": 60},
    "converter": {"capacity": 1.0, "load": 36.0},
    "denoising": {"samples": 1000},
    "isotonic": {"samples": 1000},
    "lasso": {"samples": 300, "features": 100},
    "portfolio": {"correlation": 0.3},
    "puck": {"edges": 64},
    "regulator": {"horizon": 50},
    "spatial-prices": {"offers": [4.0 + k for k in range(12)], "bids": [20.0 + 2.0 * k for k in range(12)]},
    "svm": {"samples": 200},
    "torsion": {"twist": 1.0},
    "traffic": {"side": 12},
    "unmixing": {"substances": 60, "channels": 400},
}
"""Parameters large enough to separate methods."""


def studies(size: Size, compare: bool) -> Sequence[Study]:
    """All scenes, those with a mesh on several."""
    names = ("string", "cournot") if size == "smoke" else tuple(available())
    larger: dict[str, dict[str, Any]] = {} if size == "smoke" else LARGER
    factors = {"smoke": (0.2,), "moderate": (0.5, 1.0, 2.0), "full": (0.5, 1.0, 2.0, 4.0, 8.0)}[size]
    problems = [_problem(name, make(name, larger.get(name))) for name in names]
    rivals = {rival.name: rival for problem in problems for rival in problem.subject.rivals}
    taken = [name for name, rival in rivals.items() if not rival.module or (compare and rival.installed)]
    return [
        Study(
            name="scenes",
            title="Scenes: time to the answer",
            problems=problems,
            methods=[_method(OURS, lambda scene: scene.answer(solve(scene))), *map(_rival, taken)],
            ladder=factors,
            varied="mesh",
            errors=ERROR,
            work=("seconds",),
            figures=[Profile("seconds", by="problem"), Profile("seconds")],
            repeats={"smoke": 0, "moderate": 1, "full": 3}[size],
        )
    ]


def _problem(name: str, scene: Any) -> Problem:
    """Known: the closed form, else our certified answer."""
    known = scene.exact()
    if name not in MESHES:
        known = {**scene.answer(solve(scene)), **known}
    known = {key: value for key, value in known.items() if key not in COUNTS}
    return Problem(name, scene, options={"true": known}, n=order(scene.problem()), family=name)


def _refined(problem: Problem, factor: float) -> Any:
    if problem.name not in MESHES:
        return problem.subject
    values = asdict(problem.subject.parameters)
    # Refine price and time alike.
    finer = {key: max(least, round(factor * values[key])) for key, least in (("n", 4), ("steps", 2)) if key in values}
    return make(problem.name, {**values, **finer})


def _method(name: str, ask: Callable[[Any], Any], applies: Callable[[Problem], bool] | None = None) -> Method:
    def run(problem: Problem, rung: float) -> Answer:
        off = error(ask(_refined(problem, rung)), problem.options["true"])
        well = math.isfinite(off) and off <= WRONG
        message = "" if well else f"the answer is off by {off:.1e}"
        return Answer(Counts(), observed={"answer": off}, failure="" if well else "wrong end", message=message)

    return Method(name, run, applies or (lambda problem: True), outside=applies is not None)


def _rival(name: str) -> Method:
    def ask(scene: Any) -> Any:
        return next(rival for rival in scene.rivals if rival.name == name).run(scene)

    return _method(name, ask, lambda problem: any(rival.name == name for rival in problem.subject.rivals))
