"""What cannot be meant, for every argument of everything public: a table of kinds of arguments and of calls.

`CALLS` gives to each callable a call that is right and the kind of each argument; `KINDS` gives to each kind the values
that are to be refused. A case is the call with one argument replaced.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

import continuation as c
from continuation import controllers, correctors, metric, predictors
from continuation.archive import Limits, describe, trace_many
from continuation.controllers import Bounds
from continuation.linear import Banded
from continuation.testing import check_homotopy
from problems import bifurcation, lcp, nonlinear, orbits

from ..util import refused
from .kinds import KINDS, NAN


class Call(NamedTuple):
    """A call that is right, and of its arguments the kinds, or what is wrong for one alone."""

    function: Callable[..., Any]
    right: Mapping[str, Any]
    kinds: Mapping[str, str | tuple[Any, ...]]


def world() -> SimpleNamespace:
    """What calls need, made once: a path, a branch point, an LCP."""
    cusp, pitchfork = bifurcation.Cusp(), bifurcation.Pitchfork()
    path = c.trace(cusp)
    branch = next(event for event in c.trace(pitchfork).events if event.kind == c.Kind.BRANCH_POINT)
    problem = lcp.LCP([[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0])
    return SimpleNamespace(
        homotopy=cusp, path=path, event=path.events[0], pitchfork=pitchfork, branch=branch, problem=problem,
    )  # fmt: skip


OPTIONS = {
    "preset": "preset", "predictor": "predictor", "corrector": "corrector", "controller": "controller",
    "metric": "metric", "events": "events", "guards": "guards", "check_jacobian": "truth", "examine": "truth",
}  # fmt: skip
COURSE = {
    "tolerance": "tolerance", "budget": "budget", "target": "target", "direction": "sign", "start": "start",
    "finish": "function or None", "max_step": "positive or None", "box": "box",
}  # fmt: skip
RUN = {"observers": "observers", "state": "state"}


def parts() -> Iterator[Call]:
    """Settings, and the parts of a trace."""
    ending = {"terminal": "from 0", "direction": "sign"}
    series = {"order": "order", "accuracy": "fraction", "safety": "positive, finite", "rational": "truth"}
    angle, bounds = {"max_angle": "positive"}, {"bounds": "bounds"}
    measures = dict.fromkeys(("contraction", "distance", "angle"), "positive")
    speeds = dict.fromkeys(("deceleration", "acceleration"), "factor")
    yield from (
        Call(c.Budget, {}, dict.fromkeys(("steps", "seconds", "factorizations", "arclength"), "positive")),
        Call(c.Tolerance, {}, {"relative": "fraction", "residual": "positive"}),
        Call(Bounds, {}, {"minimum": "positive, finite", "maximum": "positive", "initial": "positive or None"}),
        Call(Bounds, {"initial": 0.1}, {"minimum": (1.0,)}),
        Call(Bounds, {"minimum": 0.01}, {"maximum": (0.001,)}),
        Call(Limits, {}, {"rows": "count", "nbytes": "count", "seconds": "not negative or inf"}),
        Call(c.TurningPoint, {}, {"component": "integer", **ending}),
        Call(c.TargetValue, {"value": 0.0}, {"value": "finite", "component": "integer", **ending}),
        Call(c.Monitor, {"function": len}, {"function": "function", "name": "text", **ending}),
        Call(c.BranchPoint, {}, {"terminal": "from 0"}),
        Call(c.KinkPoint, {}, {"terminal": "from 0"}),
        Call(metric.Automatic, {}, {"share": "fraction"}),
        Call(metric.Relative, {}, dict.fromkeys(("floor", "lam"), "positive, finite")),
        Call(metric.Weighted, {}, {"lam": "positive, finite"}),
        *(
            Call(corrector, {}, {"max_iterations": "count", "max_contraction": "positive", **more})
            for corrector, more in (
                (correctors.BorderedNewton, {"reuse": "share"}),
                (correctors.NaturalParameter, {"reuse": "share"}),
                (correctors.MoorePenrose, {}),
            )
        ),
        Call(predictors.Taylor, {}, series),
        Call(controllers.AllgowerGeorg, {}, {**measures, **speeds, **bounds}),
        Call(controllers.Fixed, {}, {"ratio": "fraction", **angle, **bounds}),
        Call(controllers.SeriesRange, {}, {"distance": "positive", **angle, **bounds}),
        Call(Banded, {"ab": np.ones((3, 4)), "lower": 1, "upper": 1}, {"lower": "from 0", "upper": "from 0"}),
    )  # fmt: skip


def traced(**options: Any) -> Any:
    """A `Tracer`, run: a start of another size shows at its first step."""
    return c.Tracer(**options).run()


def engine(w: SimpleNamespace) -> Iterator[Call]:
    """Functions of the engine, and of archives."""
    options = {"homotopy": "homotopy", **OPTIONS, **COURSE}
    right = {"homotopy": w.homotopy}
    flags = {"progress": "truth", "certified": "truth", "archive": "name of a new file"}
    both = {name: kind for name, kind in options.items() if name != "direction"}
    on_path = {"homotopy": w.homotopy, "path": w.path}
    kinds = {"homotopy": "homotopy", "path": "path"}
    branch = {"homotopy": w.pitchfork, "event": w.branch}
    family = c.Family(w.homotopy, "splitting")
    watch = {"side": "sign, not 0", "k": "count from 1 or None", "terminal": "from 0"}
    yield from (
        Call(c.trace, right, {**options, **RUN, **flags}),
        Call(c.trace, right, {"max_step": (1e-30,)}),
        Call(traced, right, {**OPTIONS, **COURSE, **RUN}),
        Call(c.trace_both, right, {**both, "progress": "truth", "archive": "name of a new file"}),
        Call(
            trace_many, {"homotopies": [w.homotopy]},
            {"homotopies": "homotopies", "executor": "executor", "progress": "progress", "timeout": "seconds",
             "archive": "name of a new file"},
        ),
        Call(c.arclength, on_path, kinds),
        Call(c.audit, on_path, {**kinds, "metric": "metric", "tolerance": "tolerance", "backwards": "truth"}),
        Call(c.certify, on_path, kinds),
        Call(c.refine, {**on_path, "s": 0.1}, {**kinds, "s": "finite", "tolerance": "tolerance"}),
        Call(c.refine, {**on_path, "s": 0.1}, {"s": (1e9,)}),
        Call(c.Path(), {}, {"s": (0.0,)}),
        Call(
            c.solve_at, {**right, "lam": 0.1}, {"homotopy": "homotopy", "lam": "finite", "guess": "vector of one",
                                                "tolerance": "tolerance"},
        ),
        Call(c.switch_branch, branch, {"homotopy": "homotopy", "event": "event", "step": "positive, finite"}),
        Call(c.switch_branch, branch, {"event": (w.event,)}),
        Call(c.branch_directions, branch, {"homotopy": "homotopy", "event": "event"}),
        Call(c.check_jacobian, right, {"homotopy": "homotopy", "u": "point of two"}),
        Call(c.cite, {"source": w.path}, {"source": "source"}),
        Call(
            c.from_functions, {"residual": len, "start": ([0.0], 0.0)},
            {"residual": "function", "jacobian": "function or None", "start": "pair"},
        ),
        Call(w.path, {"s": 0.1}, {"s": "places"}),
        Call(c.Family, {**right, "name": "splitting"}, {"name": "text"}),
        Call(c.Curve, {"family": family, "event": w.event}, {"family": "family"}),
        Call(c.Stability, {}, watch),
        Call(c.HopfPoint, {}, {**watch, "direction": "sign"}),
        Call(
            c.diagram, {"homotopy": w.pitchfork, "box": {"lam": (-1.0, 1.0)}},
            {"box": ({"lam": (0.0, 2.0)}, {}, {"lam": (None, float("inf"))}), "starts": ([3],), "direction": (1,),
             "homotopy": "homotopy", "branches": "count", "generations": "count or None", "step": "positive, finite",
             "stability": "stability", "executor": "executor", "archive": "name of a new file", "deflate": "values",
             "resume": "truth", "keep": "text"},
        ),
        Call(
            c.Deflated,
            {**right, "known": [np.zeros(1)]},
            {"homotopy": "homotopy", "known": "known points", "power": "positive, finite", "shift": "not negative"},
        ),
        Call(check_homotopy, right, {"steps": "count or None"}),
        Call(describe, {"archive": None}, {"archive": "archive"}),
    )  # fmt: skip


def solver(w: SimpleNamespace) -> Iterator[Call]:
    """The LCP."""
    data = {"A": np.eye(2), "q": -np.ones(2)}
    right, kinds = {"problem": w.problem}, {"problem": "problem"}
    limits = {"seed": "from 0", "budget": "budget", "tolerance": "tolerance of a solution"}
    search = {"homotopy": "name of a homotopy", "guess": "guess", "finish": "truth", "path": "truth",
              "restarts": "count or None", "archive": "name of a new file", "progress": "truth",
              "x0": "start of an LCP", "sparse": "name of a factorisation"}  # fmt: skip
    by_path = {"problem": w.problem, "homotopy": "kkt"}
    larger = lcp.solve(lcp.LCP(np.eye(3), -np.ones(3)))
    along = {"problem": w.problem, "d": np.ones(2)}
    line = {**along, "path": lcp.along(**along)}
    longer = lcp.along(lcp.LCP(np.eye(3), -np.ones(3)), np.ones(3))
    ends = {"x0": "positive start", "y0": "positive start"}
    rows = {"G": np.ones((1, 2)), "h": np.ones(1)}
    costs = {"c": "vector of any size", "lower": "lower", "upper": "upper"}
    yield from (
        Call(lcp.LCP, data, {"A": "matrix", "q": "vector", "primal": "from 0"}),
        Call(lcp.LCP, data, {"q": (np.array(["-1e4000", "1"], np.longdouble),)}),
        Call(lcp.MixedLCP, data, {"A": "matrix", "q": "vector", "lower": "lower", "upper": "upper",
                                  "primal": "from 0"}),
        Call(lcp.solve, right, {**kinds, **search, **limits, **OPTIONS}),
        Call(lcp.solve, by_path, {**search, **limits, **OPTIONS, "target": "target", "direction": "sign"}),
        Call(lcp.solve, right, {"guess": (larger,), "colour": ("red",)}),
        Call(
            lcp.solve_many, {"A": np.eye(2), "q": -np.ones((3, 2))},
            {"A": "matrix", "q": "vectors", "tolerance": "tolerance of a solution", "budget": "budget",
             "executor": "executor"},
        ),
        Call(lcp.Solver, {"A": np.eye(2)}, {"A": "matrix", "tolerance": "tolerance of a solution"}),
        Call(lcp.Solver(np.eye(2)).solve, {"q": -np.ones(2)}, {"q": "vector", "active": ([True],)}),
        Call(lcp.solutions, right, {**kinds, "enumerate_faces": "truth", **limits}),
        Call(
            lcp.along, along,
            {**kinds, "d": "vector", "t": "interval", "level": "level", "budget": "budget",
             "archive": "name of a new file", "ray": ([1.0],)},
        ),
        Call(lcp.along, {**along, "t": (1.0, 0.0)}, {"x": (np.ones(2),), "level": (1.0,)}),
        Call(lcp.prove_path, line, {**kinds, "d": "vector", "path": "path", "level": "level"}),
        Call(lcp.prove_path, line, {"path": (longer,)}),
        *(
            Call(certify, {**right, "x": np.ones(2)}, {**kinds, "x": "vector"})
            for certify in (lcp.certify, lcp.certify_exactly)
        ),
        *(
            Call(function, right, kinds)
            for function in (
                lcp.farkas, lcp.solve_by_enumeration, lcp.strictly_feasible_start,
                lcp.default_start, lcp.Structure,
            )
        ),
        Call(lcp.random_start, {**right, "generator": np.random.default_rng(0)}, {**kinds, "generator": "generator"}),
        Call(lcp.classify, {"A": np.eye(2)}, {"A": "exact matrix"}),
        *(
            Call(two, {**right, "x0": np.full(2, 9.0)}, {**kinds, **ends})
            for two in (
                lcp.WangHomotopy, lcp.YuHomotopy, lcp.XuHomotopy, lcp.ZhaoHomotopy, lcp.KojimaMegiddoMizunoHomotopy,
            )
        ),
        Call(lcp.KKTHomotopy, right, {**kinds, **dict.fromkeys(("x0", "z1", "z2", "w0"), "positive start")}),
        Call(lcp.from_qp, {"P": np.eye(2), "c": np.ones(2), **rows}, {"P": "matrix", **costs}),
        Call(lcp.from_lp, {"c": np.ones(2), **rows}, costs),
    )  # fmt: skip


def others() -> Iterator[Call]:
    """The other problems."""
    target = {"target": "finite or None"}
    fixed = {"F": np.cos, "a": np.ones(2)}
    right = {"F": np.cos, "lower": np.zeros(2)}
    given = {"problem": nonlinear.MixedComplementarity(**right)}
    settings = {"x0": "vector or None", "tolerance": "tolerance of a solution", "budget": "budget"}
    kinked = {"homotopy": nonlinear.bratu_under_obstacle(1, 0.5), "u": np.array([0.5, 1.0])}
    yield from (
        Call(bifurcation.Cusp, {}, {"splitting": "finite", **target}),
        Call(bifurcation.Pitchfork, {}, {"imperfection": "finite", **target}),
        Call(bifurcation.Aircraft, {}, {"elevator": "finite", **target}),
        Call(bifurcation.ExponentialCosine, {}, {"n": "count", **target}),
        Call(bifurcation.Bratu1D, {}, {"n": "count", **target}),
        Call(bifurcation.Bratu2D, {}, {"m": "count", **target}),
        Call(bifurcation.FreudensteinRoth, {}, target),
        *(
            Call(make, fixed, {"F": "function", "a": "vector of any size", "jacobian": "function or None"})
            for make in (nonlinear.fixed_point, nonlinear.newton)
        ),
        Call(nonlinear.brown, {"n": 3}, {"n": "count"}),
        Call(nonlinear.bratu_under_obstacle, {}, {"n": "count", "psi": "finite", **target}),
        Call(
            nonlinear.NormalMap, {"F": len, "x0": np.ones(2), "lam0": 0.0},
            {"F": "function", "x0": "vector of any size", "lam0": "finite", "lower": (np.inf,), **target},
        ),
        Call(nonlinear.MixedComplementarity, right, {"F": "function", "jacobian": "function or None"}),
        Call(nonlinear.solve_complementarity, given, {"problem": "problem", **settings}),
        Call(c.kink_rays, kinked, {"homotopy": "homotopy with pieces", "u": "vector"}),
    )  # fmt: skip


def cycles() -> Iterator[Call]:
    """Periodic orbits."""
    f, t = orbits.models.brusselator, np.linspace(0.0, 20.0, 80)
    circle = np.stack([np.cos(t), np.sin(t)], axis=1)
    mesh = ("a", None, 0, 1, 2.5, [0.0, 1.0], [0.0, 0.7, 0.3, 1.0])
    fine = {"intervals": ("a", None, 0, 1, 2.5, [1.0]), "degree": "degree"}
    hopf = {"f": f, "point": (np.array([1.0, 2.0]), 2.0)}
    points = (None, 3, "a", (np.ones(2), 0.5))
    kinds = {"f": "function", "point": points, "radius": "positive, finite", **fine}
    right = {"homotopy": orbits.from_model(intervals=4), "budget": c.Budget(steps=1)}
    run = {**OPTIONS, "tolerance": "tolerance", "budget": "budget", "archive": "name of a new file"}
    yield from (
        Call(
            orbits.PeriodicOrbit, {"f": f, "states": circle, "period": 6.0, "parameter": 2.0},
            {"f": "function", "period": "positive, finite", "parameter": "finite", "degree": "degree", "mesh": mesh,
             "states": ("a", None, np.ones(3), np.full((80, 2), NAN), np.ones((79, 2))), "jacobian": "function or None",
             "smallest": "positive, finite", "scale": ("a", [1.0], [1.0, 0.0], [1.0, NAN])},
        ),
        Call(orbits.PeriodicOrbit.from_hopf, hopf, kinds),
        Call(orbits.from_model, {}, {"model": ("a", None, 3), "radius": "positive, finite", **fine}),
        Call(c.follow, right, {"homotopy": (None, 3, "a", [], bifurcation.Cusp()), "every": "count", **run}),
    )  # fmt: skip


def verdict(call: Call, argument: str, value: Any) -> str:
    """What comes of a case: "refused", by the name of the argument and what was expected, or what is wrong."""
    with warnings.catch_warnings(record=True) as leaked:
        warnings.simplefilter("always")
        try:
            refused(argument, lambda: call.function(**{**call.right, argument: value}), "expected|not finite")
            found = "refused"
        except (Exception, pytest.fail.Exception) as error:
            found = f"ACCEPTED, OR OBSCURE: {type(error).__name__}: {str(error)[:100]!r}"
    return f"WARNING: {leaked[0].message}" if leaked else found


def calls() -> list[Call]:
    """All of the table."""
    w = world()
    return [*parts(), *engine(w), *solver(w), *others(), *cycles()]


def cases() -> Iterator[tuple[Call, str, Any]]:
    """Each call with each argument replaced by each value of its kind."""
    for call in calls():
        for argument, kind in call.kinds.items():
            for value in KINDS[kind] if isinstance(kind, str) else kind:
                yield call, argument, value


def name_of(call: Call) -> str:
    """Of the function, for a report."""
    return getattr(call.function, "__qualname__", type(call.function).__name__)
