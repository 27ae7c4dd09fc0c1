"""Arguments of the engine's functions that cannot be meant: each is refused in one line that names it."""

import numpy as np
import pytest

from continuation import (
    Budget,
    Kind,
    Monitor,
    Path,
    Tolerance,
    TurningPoint,
    branch_directions,
    check_jacobian,
    from_functions,
    refine,
    switch_branch,
    trace,
)
from continuation.archive import PathLog, trace_many
from continuation.controllers import AllgowerGeorg, Bounds
from continuation.correctors import BorderedNewton
from continuation.events import TargetValue
from continuation.metric import RootMeanSquare
from continuation.predictors import Tangent
from continuation.presets import Preset
from problems.bifurcation import Cusp, ExponentialCosine, Pitchfork
from problems.nonlinear import fixed_point

from .util import refused

NAN, INF = np.nan, np.inf
CUSP = Cusp()
PATH = trace(CUSP)
POINT, TANGENT = PATH.steps[0].u, PATH.steps[0].tangent

OPTIONS = {
    "tolerance": (0, -1, NAN, INF, "1e-8", None, 1e-8j, np.array([1e-8, 1e-8]), Tolerance, True),
    "budget": (5, Budget, {"steps": 3}, "5", NAN),
    "target": (NAN, INF, "x", [1.0], 1j),
    "direction": (2, None, "+", 0.5, NAN),
    "events": (None, TurningPoint(), [TurningPoint], [len], "turning", 3),
    "observers": (None, object(), [object()], [PathLog], 5),
    "preset": ("fast", None, Preset, 5),
    "predictor": (Tangent, "tangent", BorderedNewton()),
    "corrector": (BorderedNewton, Tangent(), "newton"),
    "controller": (AllgowerGeorg, Bounds(), 5),
    "metric": (RootMeanSquare, "rms", 5),
    "start": (POINT, (np.zeros(5), np.ones(5)), (np.full(2, NAN), TANGENT), (POINT, np.zeros(2)), ("a", "b"), 3),
    "archive": (5, PathLog, ["a.h5"], b"a.h5"),
}


@pytest.mark.parametrize(("name", "value"), [(name, value) for name in OPTIONS for value in OPTIONS[name]], ids=repr)
def test_an_option(name, value):
    refused(name, lambda: trace(CUSP, **{name: value}))


@pytest.mark.parametrize("value", [Cusp, None, 3, "cusp", len, {}], ids=repr)
@pytest.mark.parametrize("call", [trace, check_jacobian], ids=lambda call: call.__name__)
def test_a_homotopy(call, value):
    refused("homotopy", lambda: call(value))


PARTS = [
    (Budget, {"steps": value}, "steps") for value in (0, -1, NAN, "9", None, 1j)
] + [
    (Budget, {"seconds": value}, "seconds") for value in (0, -1, NAN, "9")
] + [
    (Budget, {"factorizations": value}, "factorizations") for value in (0, -3, NAN)
] + [
    (Tolerance, {"absolute": value}, "absolute") for value in (0, NAN, INF, "a", -1)
] + [
    (Tolerance, {"relative": value}, "relative") for value in (-1, NAN, "a")
] + [
    (TurningPoint, {"component": 1.5}, "component"),
    (TurningPoint, {"terminal": -1}, "terminal"),
    (TurningPoint, {"terminal": 1.5}, "terminal"),
    (TurningPoint, {"direction": 2}, "direction"),
    (TargetValue, {"value": NAN}, "value"),
    (TargetValue, {"value": "a"}, "value"),
    (Monitor, {"function": 5}, "function"),
    (Monitor, {"function": len, "name": 5}, "name"),
    (Cusp, {"splitting": NAN}, "splitting"),
    (Cusp, {"splitting": "a"}, "splitting"),
    (ExponentialCosine, {"n": 0}, "n"),
    (ExponentialCosine, {"n": 2.5}, "n"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "values", "name"), PARTS, ids=repr)
def test_a_part(make, values, name):
    refused(name, lambda: make(**values))


FUNCTIONS = [
    ("residual", lambda: from_functions(None, start=([0.0], 0.0))),
    ("jacobian", lambda: from_functions(len, 5, start=([0.0], 0.0))),
    ("start", lambda: from_functions(len, start=None)),
    ("start", lambda: trace(from_functions(lambda y, lam: y - lam, start=([NAN], 0.0)))),
    ("F", lambda: fixed_point(None, [0.0])),
    ("a", lambda: fixed_point(lambda x: x, [NAN])),
]
SWEEPS = [
    ("homotopies", lambda: trace_many(None)),
    ("homotopies", lambda: trace_many(CUSP)),
    ("executor", lambda: trace_many([CUSP], 5)),
    ("executor", lambda: trace_many([CUSP], type("Executor", (), {"submit": None}))),
    ("progress", lambda: trace_many([CUSP], progress=5)),
    ("progress", lambda: trace_many([CUSP], progress=True)),
    ("timeout", lambda: trace_many([CUSP], timeout=0)),
    ("timeout", lambda: trace_many([CUSP], timeout="1")),
    ("timeout", lambda: trace_many([CUSP], timeout=NAN)),
    ("archive", lambda: trace_many([CUSP], archive=5)),
]
AFTERWARDS = [
    *[("s", lambda s=s: PATH(s)) for s in (-1.0, 1e9, NAN, "a", 1j, None, [0.0, NAN])],
    ("s", lambda: Path()(0.0)),
    ("s", lambda: refine(CUSP, PATH, NAN)),
    ("s", lambda: refine(CUSP, PATH, 1e9)),
    ("event", lambda: switch_branch(CUSP, PATH.events[0])),
    ("event", lambda: switch_branch(CUSP, None)),
    ("event", lambda: branch_directions(CUSP, 5)),
    ("u", lambda: check_jacobian(CUSP, [1.0])),
    ("u", lambda: check_jacobian(CUSP, [NAN, NAN])),
]


@pytest.mark.parametrize(("name", "call"), FUNCTIONS + SWEEPS + AFTERWARDS)
def test_a_function(name, call):
    refused(name, call)


@pytest.mark.parametrize("step", [0.0, -1.0, NAN, INF, "a", None])
def test_the_step_to_another_branch(step):
    homotopy = Pitchfork()
    event = next(event for event in trace(homotopy).events if event.kind == Kind.BRANCH_POINT)
    refused("step", lambda: switch_branch(homotopy, event, step=step))
