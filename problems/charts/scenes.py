"""Scenes: time against error, ours and rivals'."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from attrs import asdict

from continuation.chart import Answer, Dumbbell, Error, Failure, Method, Problem, Rung, Study, observed
from continuation.chart.study import Size
from continuation.counts import Counts
from problems.charts.rivals import notes
from problems.scenes import Rival, available, error, make, order, solve

WRONG = 1e-2
"""Larger relative errors fail."""


COMPILING = 30.0
"""Seconds of a first run still repeated: quantecon and numba compile in it."""

ERROR = observed("answer", "error of the answer, relative")
# Recreated outside of the timed run.
ORDER = Error("unknowns", "unknowns of the model", lambda problem, answer: float(
    order(_refined(problem, answer.observed.get("factor", 1.0)).problem())))  # fmt: skip

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
    "svm": {"samples": 200, "width": 1.0},
    "torsion": {"twist": 1.0},
    "traffic": {"side": 12},
    "unmixing": {"substances": 60, "channels": 400},
}
"""Parameters large enough to separate methods."""


def studies(size: Size, compare: bool) -> Sequence[Study]:
    """Scenes with a refined mesh, and scenes exact to round-off."""
    factors = {"smoke": (0.2,), "moderate": (0.5, 1.0, 2.0), "full": (0.5, 1.0, 2.0, 4.0, 8.0)}[size]
    names = ("string", "cournot") if size == "smoke" else tuple(available())
    larger: dict[str, dict[str, Any]] = {} if size == "smoke" else LARGER
    meshes = [_problem(name, make(name, larger.get(name))) for name in names if name in MESHES]
    exact = [_problem(name, make(name, larger.get(name))) for name in names if name not in MESHES]
    common: dict[str, Any] = {
        "errors": (ERROR, ORDER), "work": ("seconds",),
        "figures": [Dumbbell("answer", "seconds", every=every) for every in (False, True)],
        "repeats": {"smoke": 0, "moderate": 1, "full": 3}[size], "patience": COMPILING,
    }  # fmt: skip
    ladder = tuple(Rung("mesh", factor) for factor in factors)
    return [
        Study(name="scenes-meshes", title="Scenes with a mesh", problems=meshes, ladder=ladder,
              methods=_methods(meshes, True, compare), notes=_notes(meshes, compare), **common),
        Study(name="scenes-exact", title="Scenes without a mesh", problems=exact,
              methods=_methods(exact, False, compare), notes=_notes(exact, compare), **common),
    ]  # fmt: skip


def _problem(name: str, scene: Any) -> Problem:
    """Known: the closed form, else our certified answer."""
    known = scene.exact()
    if name not in MESHES:
        known = {**scene.answer(solve(scene)), **known}
    known = {key: value for key, value in known.items() if key not in COUNTS}
    return Problem(name, scene, options={"true": known}, n=order(scene.problem()), family=name)


def _methods(problems: Sequence[Problem], mesh: bool, compare: bool) -> list[Method]:
    """Ours, each rival once, outside packages if requested."""
    rivals: dict[str, Rival] = {}
    for problem in problems:
        rivals.update({rival.name: rival for rival in problem.subject.rivals})
    taken = [rival for rival in rivals.values() if not rival.module or (compare and rival.installed)]
    ours = _method(OURS, mesh, lambda scene: scene.answer(solve(scene)))
    return [ours, *(_rival(rival.name, mesh) for rival in taken)]


def _notes(problems: Sequence[Problem], compare: bool) -> list[str]:
    return notes([rival.module for problem in problems for rival in problem.subject.rivals if rival.module], compare)


def _refined(problem: Problem, factor: float) -> Any:
    if problem.name not in MESHES:
        return problem.subject
    values = asdict(problem.subject.parameters)
    # Refine price and time alike.
    finer = {key: max(least, round(factor * values[key])) for key, least in (("n", 4), ("steps", 2)) if key in values}
    return make(problem.name, {**values, **finer})


def _method(
    name: str, mesh: bool, ask: Callable[[Any], Any], applies: Callable[[Problem], bool] | None = None
) -> Method:
    """A method for scenes, or for those that `applies` selects."""

    def run(problem: Problem, rung: Rung) -> Answer:
        factor = rung.value if mesh else 1.0
        found = ask(_refined(problem, factor))
        off = error(found, problem.options["true"])
        well = math.isfinite(off) and off <= WRONG
        message = "" if well else f"the answer is off by {off:.1e}"
        failure = Failure.NONE if well else Failure.WRONG_END
        return Answer(Counts(), observed={"answer": off, "factor": factor}, failure=failure, message=message)

    return Method(name, run, mesh, applies or (lambda problem: True), outside=applies is not None)


def _rival(name: str, mesh: bool) -> Method:
    def ask(scene: Any) -> Any:
        return next(rival for rival in scene.rivals if rival.name == name).run(scene)

    return _method(name, mesh, ask, lambda problem: any(rival.name == name for rival in problem.subject.rivals))
