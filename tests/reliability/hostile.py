"""What cannot be meant, for every argument of everything public: a table of kinds of arguments and of calls.

`CALLS` gives to each callable a call that is right and the kind of each argument; `KINDS` gives to each kind the values
that are to be refused. A case is the call with one argument replaced.
"""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp

import continuation as c
from continuation import controllers, correctors, metric, predictors
from continuation.archive import ArchiveError, Limits, describe, trace_many
from continuation.controllers import Bounds
from continuation.linear import Banded
from continuation.testing import check_homotopy
from problems import bifurcation, lcp, nonlinear

NAN, INF = np.nan, np.inf
NO_NUMBERS = ("a", None, 1j, [1.0], {}, (), np.ones(2), object, len, Decimal("nan"))
NO_TRUTH = ("no", None, 1, 0.0, [], {}, NAN)
NO_HOMOTOPY = (None, 3, "cusp", bifurcation.Cusp, len, {}, [], np.ones(2))
NO_OBJECT = (None, 3, "a", [], {}, len)
NO_NAMES = (5, 1.5, b"a.h5", ["a.h5"], {}, len)


def vectors(n: int) -> tuple[Any, ...]:
    """What is no vector of n finite numbers."""
    return (
        "a", None, 5.0, {}, {1, 2}, len, [NAN] * n, [INF] * n, [1j] * n, ["a"] * n, [None] * n, np.ones(n + 1),
        np.ones((n, n)), np.zeros(n, "M8[s]"), np.ma.masked_array(np.ones(n), np.ones(n)), [[1.0], [1.0, 2.0]],
        [10**400] * n, np.array([object()] * n),
    )  # fmt: skip


def optional(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """The same, where None is allowed."""
    return tuple(value for value in values if value is not None)


NO_MATRICES = (
    "a", None, 5, {}, {1, 2}, len, np.ndarray, [], [1, 2], np.ones((2, 3)), np.ones((2, 2, 2)), [[1, 2], [3]],
    [[NAN, 1], [1, 2]], [[INF, 1], [1, 2]], np.eye(2) + 1j, [["a", "b"], ["c", "d"]], [[None, 1], [1, 2]],
    np.zeros((2, 2), "M8[s]"), b"abcd", np.ma.masked_array(np.eye(2), np.eye(2)), sp.csr_array([[NAN, 1], [1, 2]]),
    sp.csr_array(np.eye(2) + 1j), sp.csr_array(np.ones((2, 3))), sp.coo_array(np.ones(2)),
    np.array([[object()] * 2] * 2),
)  # fmt: skip

POSITIVE = (*NO_NUMBERS, 0, -1.0, NAN, -INF, True)
KINDS: Mapping[str, tuple[Any, ...]] = {
    "positive": POSITIVE,
    "positive, finite": (*POSITIVE, INF),
    "positive or None": optional(POSITIVE),
    "not negative or inf": (*NO_NUMBERS, -1.0, NAN, True),
    "fraction": (*POSITIVE, INF, 1.0, 2),
    "share": (*NO_NUMBERS, -0.1, NAN, INF, 1.1, True),
    "factor": (*POSITIVE, INF, 1.0, 0.5),
    "finite": (*NO_NUMBERS, NAN, INF, -INF, True),
    "finite or None": (*optional(NO_NUMBERS), NAN, INF, -INF, True),
    "not negative": (*NO_NUMBERS, -1.0, NAN, INF, True),
    "count": (*NO_NUMBERS, 0, -3, 2.5, NAN, INF, True),
    "count or None": (*optional(NO_NUMBERS), -3, 2.5, NAN, INF),
    "from 0": (*NO_NUMBERS, -1, 2.5, NAN, INF, True),
    "integer": (*NO_NUMBERS, 2.5, NAN, INF, True),
    "sign": (*NO_NUMBERS, 2, -2, 0.5, NAN, INF),
    "truth": NO_TRUTH,
    "text": (5, None, b"a", [], {}, len, NAN),
    "function": (5, None, "f", [], {}, NAN, 1j),
    "function or None": (5, "f", [], {}, NAN, 1j),
    "homotopy": NO_HOMOTOPY,
    "homotopy with pieces": (*NO_HOMOTOPY, bifurcation.Cusp()),
    "family": (None, 3, "a", [], {}, np.ones(2)),
    "path": (*NO_OBJECT, c.Path, np.ones(3)),
    "event": (*NO_OBJECT, c.TurningPoint(), np.ones(3)),
    "events": (None, 3, "turning", len, [len], [3], [None], c.TurningPoint(), [c.TurningPoint], {}),
    "observers": (None, 3, "log", len, [len], [3], [None], object()),
    "budget": (5, "5", NAN, {"steps": 3}, c.Budget, [], len),
    "tolerance": (*POSITIVE, INF, 1e300, 1.0, c.Tolerance, "1e-8"),
    "tolerance of a solution": (*POSITIVE, INF, 1.0, 2, "1e-8", c.Tolerance()),
    "target": (*optional(NO_NUMBERS), NAN, INF, -INF, "x"),
    "start": (3, "a", (np.zeros(5), np.ones(5)), ("a", "b"), (np.full(2, NAN), np.ones(2)), (np.zeros(2), np.zeros(2)),
              [], {}, (1, 2, 3)),
    "state": (5, "a", {}, [], c.Tracer, np.ones(2)),
    "preset": ("fast", None, 5, [], c.FAST.predictor, type(c.FAST)),
    "predictor": ("tangent", 5, [], predictors.Tangent, correctors.BorderedNewton(), len),
    "corrector": ("newton", 5, [], correctors.BorderedNewton, predictors.Tangent(), len),
    "controller": ("fixed", 5, [], controllers.Fixed, Bounds(), len),
    "metric": ("rms", 5, [], metric.RootMeanSquare, len),
    "box": (3, "lam", [], {"lam": 3}, {"x": (0, 1)}, {"lam": (1, 0)}, {"lam": (NAN, 1)}, {"lam": ("a", "b")},
            {9: (0, 1)}, {"lam": (0, 1, 2)}, len),
    "bounds": (None, 5, "a", [], {}, Bounds, (0.1, 1.0)),
    "limits": ((1, 2, 3), 5, "a", {}, Limits),
    "order 2 or 4": (*optional(NO_NUMBERS), None, 0, 3, 99, 2.5, NAN, INF),
    "order 2 to 4": (*optional(NO_NUMBERS), None, 0, 1, 99, 2.5, NAN, INF),
    "order": (*optional(NO_NUMBERS), 0, 1, -2, 2.5, NAN, INF, True, 10**6),
    "degree": (*NO_NUMBERS, 0, 1, -2, 2.5, NAN, INF, True, 10**6),
    "name of a file": (*NO_NAMES, None),
    "name of a new file": NO_NAMES,
    "archive": (*NO_OBJECT, "a.h5"),
    "homotopies": (None, 3, bifurcation.Cusp(), len),
    "executor": (5, "threads", [], len, c.Tracer),
    "progress": (5, "yes", True, []),
    "seconds": (*optional(NO_NUMBERS), 0, -1.0, NAN, True),
    "point": (*vectors(2), np.ones(1)),
    "places": ("a", 1j, None, {}, -1.0, 1e9, NAN, [0.0, NAN], ["a"], len),
    "matrix": (*NO_MATRICES, [[10**400, 1], [1, 2]]),
    "vector": vectors(2),
    "vector of any size": vectors(2)[:11] + vectors(2)[12:],
    "vector or None": optional(vectors(2)),
    "level": (*NO_NUMBERS[:1], *NO_NUMBERS[2:3], -1.0, NAN, INF, [1.0, NAN], np.ones(3), {}, len),
    "lower": ("a", 1j, NAN, [NAN, 0.0], INF, np.ones(3), {}, len, ["a", "b"], np.zeros((2, 2))),
    "upper": ("a", 1j, NAN, [NAN, 0.0], -INF, np.ones(3), {}, len, ["a", "b"], np.zeros((2, 2))),
    "exact matrix": NO_MATRICES,
    "problem": ((np.eye(2), np.ones(2)), None, 3, "a", np.eye(2), lcp.LCP, [], {}, len),
    "guess": (3, "a", np.ones(2), lcp.Solution, [], {}, len),
    "name of a homotopy": ("simplex", None, 3, "KKT", ["kkt"], lcp.KKTHomotopy, {}, b"kkt"),
    "start of an LCP": (*optional(vectors(2)), [-1.0, 1.0], [True, True], np.ones(1)),
    "positive start": (*optional(vectors(2)), [-1.0, 1.0], [0.0, 1.0], [True, True], np.ones(1)),
    "generator": (None, 3, "a", [], {}, len),
    "interval": (None, 3, "a", (1.0,), (NAN, 1.0), ("a", "b"), (1.0, 1.0), {}, len),
    "source": (None, 3, "a", [], {}, np.ones(2)),
    "vector of one": tuple(value for value in optional(vectors(1)) if not isinstance(value, float)),
    "point of two": optional(vectors(2)),
    "pair": (None, 3, "a", [], {}, (1,), (1, 2, 3), ([0.0], [1.0, 2.0]), (["a"], 0.0), ([0.0], "a"),
             ([1j], 0.0)),
}  # fmt: skip


class Call(NamedTuple):
    """A call that is right, and the kinds of its arguments."""

    function: Callable[..., Any]
    right: Mapping[str, Any]
    kinds: Mapping[str, str]


class World(NamedTuple):
    """What calls need: made once."""

    homotopy: Any
    path: Any
    event: Any
    pitchfork: Any
    branch: Any
    problem: Any
    program: Any


def world() -> World:
    """A path, a branch point, an LCP."""
    cusp, pitchfork = bifurcation.Cusp(), bifurcation.Pitchfork()
    path = c.trace(cusp)
    branch = next(event for event in c.trace(pitchfork).events if event.kind == c.Kind.BRANCH_POINT)
    problem = lcp.LCP([[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0])
    return World(cusp, path, path.events[0], pitchfork, branch, problem, lcp.from_qp(np.eye(2), -np.ones(2)))


OPTIONS = {
    "preset": "preset", "predictor": "predictor", "corrector": "corrector", "controller": "controller",
    "metric": "metric", "events": "events", "check_jacobian": "truth", "examine": "truth",
}  # fmt: skip
COURSE = {
    "tolerance": "tolerance", "budget": "budget", "target": "target", "direction": "sign", "start": "start",
    "finish": "function or None", "max_step": "positive or None", "box": "box",
}  # fmt: skip
RUN = {"observers": "observers", "state": "state"}


def parts() -> Iterator[Call]:
    """Settings, and the parts of a trace."""
    yield Call(c.Budget, {}, dict.fromkeys(("steps", "seconds", "factorizations", "arclength"), "positive"))
    yield Call(c.Tolerance, {}, {"relative": "fraction", "residual": "positive"})
    yield Call(Bounds, {}, {"minimum": "positive, finite", "maximum": "positive", "initial": "positive or None"})
    yield Call(Limits, {}, {"rows": "count", "nbytes": "count", "seconds": "not negative or inf"})
    ending = {"terminal": "from 0", "direction": "sign"}
    yield Call(c.TurningPoint, {}, {"component": "integer", **ending})
    yield Call(c.TargetValue, {"value": 0.0}, {"value": "finite", "component": "integer", **ending})
    yield Call(c.Monitor, {"function": len}, {"function": "function", "name": "text", **ending})
    yield Call(c.BranchPoint, {}, {"terminal": "from 0"})
    yield Call(c.KinkPoint, {}, {"terminal": "from 0"})
    yield Call(metric.Automatic, {}, {"share": "fraction"})
    yield Call(metric.Relative, {}, dict.fromkeys(("floor", "lam"), "positive, finite"))
    yield Call(metric.Weighted, {}, {"lam": "positive, finite"})
    for corrector, more in (
        (correctors.BorderedNewton, {"reuse": "share"}),
        (correctors.NaturalParameter, {"reuse": "share"}),
        (correctors.Broyden, {}),
        (correctors.Chord, {}),
        (correctors.MoorePenrose, {}),
    ):
        yield Call(corrector, {}, {"max_iterations": "count", "max_contraction": "positive", **more})
    yield Call(predictors.RungeKutta, {}, {"order": "order 2 or 4"})
    yield Call(predictors.AdamsBashforth, {}, {"order": "order 2 to 4"})
    yield Call(predictors.Polynomial, {}, {"degree": "degree"})
    series = {"order": "order", "accuracy": "fraction", "safety": "positive, finite", "rational": "truth"}
    yield Call(predictors.Taylor, {}, series)
    angle, bounds = {"max_angle": "positive"}, {"bounds": "bounds"}
    measures = dict.fromkeys(("contraction", "distance", "angle"), "positive")
    speeds = dict.fromkeys(("deceleration", "acceleration"), "factor")
    yield Call(controllers.AllgowerGeorg, {}, {**measures, **speeds, **bounds})
    yield Call(
        controllers.Curvature, {},
        {"contraction": "fraction", "initial_distance": "positive", "growth": "factor", **angle, **bounds},
    )  # fmt: skip
    yield Call(controllers.Fixed, {}, {**angle, **bounds})
    yield Call(controllers.Geometric, {}, {"ratio": "fraction", **bounds})
    yield Call(
        controllers.IterationCount, {},
        {"target": "count", "grow": "factor", "shrink": "fraction", **angle, **bounds},
    )  # fmt: skip
    yield Call(controllers.SeriesRange, {}, {"distance": "positive", **angle, **bounds})
    yield Call(Banded, {"ab": np.ones((3, 4)), "lower": 1, "upper": 1}, {"lower": "from 0", "upper": "from 0"})


def traced(**options: Any) -> Any:
    """A `Tracer`, run: a start of another size shows at its first step."""
    return c.Tracer(**options).run()


def engine(w: World) -> Iterator[Call]:
    """Functions of the engine, and of archives."""
    options = {"homotopy": "homotopy", **OPTIONS, **COURSE}
    right = {"homotopy": w.homotopy}
    flags = {"progress": "truth", "certified": "truth", "archive": "name of a new file"}
    yield Call(c.trace, right, {**options, **RUN, **flags})
    yield Call(traced, right, {**OPTIONS, **COURSE, **RUN})
    both = {name: kind for name, kind in options.items() if name != "direction"}
    yield Call(c.trace_both, right, {**both, "progress": "truth", "archive": "name of a new file"})
    yield Call(
        trace_many, {"homotopies": [w.homotopy]},
        {"homotopies": "homotopies", "executor": "executor", "progress": "progress", "timeout": "seconds",
         "archive": "name of a new file"},
    )  # fmt: skip
    on_path = {"homotopy": w.homotopy, "path": w.path}
    kinds = {"homotopy": "homotopy", "path": "path"}
    yield Call(c.arclength, on_path, {**kinds, "metric": "metric"})
    yield Call(c.audit, on_path, {**kinds, "metric": "metric", "tolerance": "tolerance", "backwards": "truth"})
    yield Call(c.certify, on_path, kinds)
    yield Call(c.refine, {**on_path, "s": 0.1}, {**kinds, "s": "finite", "tolerance": "tolerance"})
    yield Call(
        c.solve_at, {**right, "lam": 0.1}, {"homotopy": "homotopy", "lam": "finite", "guess": "vector of one",
                                            "tolerance": "tolerance"},
    )  # fmt: skip
    branch = {"homotopy": w.pitchfork, "event": w.branch}
    yield Call(c.switch_branch, branch, {"homotopy": "homotopy", "event": "event", "step": "positive, finite"})
    yield Call(c.branch_directions, branch, {"homotopy": "homotopy", "event": "event"})
    yield Call(c.check_jacobian, right, {"homotopy": "homotopy", "u": "point of two"})
    yield Call(c.cite, {"source": w.path}, {"source": "source"})
    yield Call(
        c.from_functions, {"residual": len, "start": ([0.0], 0.0)},
        {"residual": "function", "jacobian": "function or None", "start": "pair"},
    )  # fmt: skip
    yield Call(w.path, {"s": 0.1}, {"s": "places"})
    family = c.Family(w.homotopy, "splitting")
    yield Call(c.Family, {**right, "name": "splitting"}, {"name": "text"})
    yield Call(c.Curve, {"family": family, "event": w.event}, {"family": "family"})
    yield Call(check_homotopy, right, {"steps": "count or None"})
    yield Call(describe, {"archive": None}, {"archive": "archive"})


def solver(w: World) -> Iterator[Call]:
    """The LCP."""
    data = {"A": np.eye(2), "q": -np.ones(2)}
    yield Call(lcp.LCP, data, {"A": "matrix", "q": "vector", "primal": "from 0"})
    yield Call(
        lcp.MixedLCP, data,
        {"A": "matrix", "q": "vector", "lower": "lower", "upper": "upper", "primal": "from 0"},
    )  # fmt: skip
    right, kinds = {"problem": w.problem}, {"problem": "problem"}
    limits = {"seed": "from 0", "budget": "budget", "tolerance": "tolerance of a solution"}
    search = {"homotopy": "name of a homotopy", "guess": "guess", "finish": "truth", "path": "truth",
              "restarts": "count or None", "archive": "name of a new file", "progress": "truth",
              "executor": "executor", "x0": "start of an LCP"}  # fmt: skip
    yield Call(lcp.solve, right, {**kinds, **search, **limits, **OPTIONS})
    yield Call(lcp.Solver, {"A": np.eye(2)}, {"A": "matrix", "tolerance": "tolerance of a solution"})
    yield Call(lcp.Solver(np.eye(2)).solve, {"q": -np.ones(2)}, {"q": "vector"})
    yield Call(lcp.solutions, right, {**kinds, "enumerate_faces": "truth", **limits})
    along = {"problem": w.problem, "d": np.ones(2)}
    yield Call(
        lcp.along, along,
        {**kinds, "d": "vector", "t": "interval", "level": "level", "budget": "budget",
         "archive": "name of a new file"},
    )  # fmt: skip
    line = {**along, "path": lcp.along(**along)}
    yield Call(lcp.prove_path, line, {**kinds, "d": "vector", "path": "path", "level": "level"})
    for certify in (lcp.certify, lcp.certify_exactly):
        yield Call(certify, {**right, "x": np.ones(2)}, {**kinds, "x": "vector"})
    for function in (
        lcp.farkas, lcp.empty_interior, lcp.solve_by_enumeration, lcp.strictly_feasible_start, lcp.default_start,
        lcp.Structure,
    ):  # fmt: skip
        yield Call(function, right, kinds)
    yield Call(
        lcp.random_start, {**right, "generator": np.random.default_rng(0)},
        {**kinds, "generator": "generator", "distance": "interval"},
    )  # fmt: skip
    yield Call(lcp.classify, {"A": np.eye(2)}, {"A": "exact matrix"})
    ends = {"x0": "positive start", "y0": "positive start"}
    for two in (lcp.WangHomotopy, lcp.YuHomotopy, lcp.XuHomotopy, lcp.ZhaoHomotopy, lcp.KojimaMegiddoMizunoHomotopy):
        yield Call(two, {**right, "x0": np.full(2, 9.0)}, {**kinds, **ends})
    yield Call(lcp.KKTHomotopy, right, {**kinds, **dict.fromkeys(("x0", "z1", "z2", "w0"), "positive start")})
    rows = {"G": np.ones((1, 2)), "h": np.ones(1)}
    costs = {"c": "vector of any size", "lower": "lower", "upper": "upper"}
    yield Call(lcp.from_qp, {"P": np.eye(2), "c": np.ones(2), **rows}, {"P": "matrix", **costs})
    yield Call(lcp.from_lp, {"c": np.ones(2), **rows}, costs)


def others() -> Iterator[Call]:
    """The other problems."""
    target = {"target": "finite or None"}
    yield Call(bifurcation.Cusp, {}, {"splitting": "finite", **target})
    yield Call(bifurcation.Pitchfork, {}, {"imperfection": "finite", **target})
    yield Call(bifurcation.Aircraft, {}, {"elevator": "finite", **target})
    yield Call(bifurcation.ExponentialCosine, {}, {"n": "count", **target})
    yield Call(bifurcation.Bratu1D, {}, {"n": "count", **target})
    yield Call(bifurcation.Bratu2D, {}, {"m": "count", **target})
    yield Call(bifurcation.FreudensteinRoth, {}, target)
    for make in (nonlinear.fixed_point, nonlinear.newton):
        right = {"F": np.cos, "a": np.ones(2)}
        yield Call(make, right, {"F": "function", "a": "vector of any size", "jacobian": "function or None"})
    yield Call(nonlinear.brown, {"n": 3}, {"n": "count"})
    yield Call(nonlinear.bratu_under_obstacle, {}, {"n": "count", "psi": "finite", **target})
    yield Call(
        nonlinear.NormalMap, {"F": len, "x0": np.ones(2), "lam0": 0.0},
        {"F": "function", "x0": "vector of any size", "lam0": "finite", **target},
    )  # fmt: skip
    right = {"F": np.cos, "lower": np.zeros(2)}
    yield Call(nonlinear.MixedComplementarity, right, {"F": "function", "jacobian": "function or None"})
    given = {"problem": nonlinear.MixedComplementarity(**right)}
    settings = {"x0": "vector or None", "tolerance": "tolerance of a solution", "budget": "budget"}
    yield Call(nonlinear.solve_complementarity, given, {"problem": "problem", **settings})
    kinked = {"homotopy": nonlinear.bratu_under_obstacle(1, 0.5), "u": np.array([0.5, 1.0])}
    yield Call(c.kink_rays, kinked, {"homotopy": "homotopy with pieces", "u": "vector"})


REFUSALS = (TypeError, ValueError, LookupError, ArchiveError)


def verdict(call: Call, argument: str, value: Any) -> str:
    """What comes of a case: "refused", or what is wrong."""
    with warnings.catch_warnings(record=True) as leaked:
        warnings.simplefilter("always")
        try:
            call.function(**{**call.right, argument: value})
            found = "ACCEPTED"
        except REFUSALS as error:
            text = str(error.args[0] if isinstance(error, KeyError) and error.args else error)
            clear = text.startswith(f"{argument}: ") and "\n" not in text and len(text) < 400
            found = "refused" if clear else f"OBSCURE: {type(error).__name__}: {text[:100]!r}"
        except Exception as error:
            found = f"OBSCURE: {type(error).__name__}: {str(error)[:100]!r}"
    return f"WARNING: {leaked[0].message}" if leaked else found


def calls() -> list[Call]:
    """All of the table."""
    w = world()
    return [*parts(), *engine(w), *solver(w), *others()]


def cases() -> Iterator[tuple[Call, str, Any]]:
    """Each call with each argument replaced by each value of its kind."""
    for call in calls():
        for argument, kind in call.kinds.items():
            for value in KINDS[kind]:
                yield call, argument, value


def name_of(call: Call) -> str:
    """Of the function, for a report."""
    return getattr(call.function, "__qualname__", type(call.function).__name__)


def bad_input() -> Counter[str]:
    """All cases, by what came of them."""
    seen: Counter[str] = Counter()
    for call, argument, value in cases():
        found = verdict(call, argument, value)
        seen["refused" if found == "refused" else f"{name_of(call)}({argument}={value!r:.60}): {found}"] += 1
    return seen


if __name__ == "__main__":
    tally = bad_input()
    for what, number in sorted(tally.items()):
        print(f"{number:5} {' '.join(what.split())[:230]}")
