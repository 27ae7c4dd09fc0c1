"""The one list of options: checked, and the same for everything that takes options."""

import numpy as np
import pytest
from attrs import evolve

from continuation import CONSERVATIVE, DEFAULT, FAST, SERIES, Budget, Path, Tracer, TurningPoint, trace
from continuation.archive import trace_many
from continuation.chart import traced
from continuation.metric import Weighted
from continuation.predictors import Hermite
from problems import lcp
from problems.bifurcation import Circle

from ...util import by_preset

LCP = lcp.LCP(np.eye(2), -np.ones(2))
TAKERS = {
    "trace": lambda **options: trace(Circle(), **options),
    "Tracer": lambda **options: Tracer(Circle(), **options),
    "trace_many": lambda **options: trace_many([Circle()], **options),
    "traced": lambda **options: traced("a method", **options),
    "solve": lambda **options: lcp.solve(LCP, **options),
}
UNKNOWN = r"^predicter: expected one of the options .*; did you mean predictor\?$"
OWNED = "target", "direction", "start", "state", "observers"


@pytest.mark.parametrize(
    ("taker", "options", "error", "words"),
    [
        *((taker, {"predicter": Hermite()}, TypeError, UNKNOWN) for taker in TAKERS),
        *(("solve", {name: 0.5}, TypeError, f"^{name}: expected no such option here, solve says") for name in OWNED),
        ("trace_many", {"start": (np.zeros(2), np.ones(2))}, TypeError, "start: expected no such option here, where"),
        # Active sets alone solve this problem: no path is traced that could complain.
        ("solve", {"preset": "fast"}, TypeError, "preset: expected FAST, .*, found 'fast'"),
        ("solve", {"predictor": Hermite}, TypeError, r"predictor: .*, found the class Hermite; Hermite\(\)"),
        ("solve", {"events": [TurningPoint]}, TypeError, "events: .* found the class TurningPoint"),
        ("solve", {"events": 1}, TypeError, "events: expected a list"),
        ("solve", {"check_jacobian": "yes"}, TypeError, "check_jacobian: expected True or False, found 'yes'"),
        ("solve", {"examine": 2}, TypeError, "examine: expected True or False, found 2"),
        ("solve", {"tolerance": "a"}, ValueError, "tolerance: .* found 'a'"),
        ("solve", {"budget": 3}, TypeError, "budget: expected a Budget, found 3"),
        ("solve", {"finish": 3}, TypeError, "finish: expected True or False, found 3"),
        ("solve", {"seed": "a"}, ValueError, "seed: expected an integer, at least 0, found 'a'"),
        ("solve", {"budgett": 3}, TypeError, r"budgett: .*; did you mean budget\?"),
        ("trace", {"metric": Weighted(-1.0)}, ValueError, "y"),
        ("trace", {"events": [TurningPoint(component=7)]}, IndexError, "component"),
        ("trace", {"tolerance": "a"}, TypeError, "tolerance: expected a positive finite number or a Tol.*, found 'a'"),
        ("trace", {"tolerance": None}, TypeError, "tolerance: .* found None"),
        ("trace", {"tolerance": True}, TypeError, "tolerance: .* found True"),
        ("trace", {"tolerance": np.inf}, ValueError, "tolerance: .* found inf"),
        ("trace", {"start": (1, 2, 3)}, ValueError, r"start: expected a pair \(u, v\) of vectors, found 3 of them"),
        ("trace", {"start": (np.zeros(2),)}, ValueError, "start: expected a pair .* found 1 of them"),
        ("trace", {"start": 3}, ValueError, "start: expected a pair .* found 3"),
        ("trace", {"start": (np.zeros(2) + 1j, np.ones(2))}, ValueError, "start: expected real numbers, found complex"),
        ("trace", {"start": ("a", "b")}, ValueError, "start: expected real numbers, found 'a'"),
        ("trace", {"start": (np.zeros(2), np.ones(3))}, ValueError, "start: .* vectors of one size"),
        ("trace", {"start": (np.zeros(2), np.zeros(2))}, ValueError, "start: .* a direction that does not vanish"),
        ("trace", {"start": (np.ones(2), np.array([1.0, np.nan]))}, ValueError, "start: expected a finite point"),
        ("trace", {"start": (np.zeros(3), np.ones(3))}, ValueError, r"start: expected 1 unknowns, found 2"),
        ("trace", {"start": ([np.nan], 0.0)}, ValueError, "start: expected finite numbers"),
        ("trace", {"start": Path()}, ValueError, "start: expected a path with a point to go on from"),
        ("trace", {"direction": "up"}, ValueError, "direction: expected -1, 0 or 1, found 'up'"),
        ("trace", {"direction": np.ones(2)}, ValueError, "direction: expected -1, 0 or 1"),
        ("trace", {"direction": True}, ValueError, "direction: expected -1, 0 or 1, found True"),
        ("trace", {"check_jacobian": "yes"}, TypeError, "check_jacobian: expected True or False, found 'yes'"),
        ("trace", {"predictor": Hermite}, TypeError, "predictor: .* found the class Hermite"),
        ("trace", {"events": [TurningPoint]}, TypeError, "events: .* found the class TurningPoint"),
        ("trace", {"observers": [1]}, TypeError, "observers: expected an observer, found 1, which has no `step`"),
        ("trace", {"observers": 1}, TypeError, "observers: expected a list of observers, found 1"),
        ("trace", {"archive": 1}, TypeError, "archive: expected a path or a PathLog, found 1"),
        ("trace", {"target": np.ones(2)}, TypeError, "target: expected a finite number or None, found array"),
        ("trace", {"target": 1j}, TypeError, "target: expected a finite number or None, found 1j"),
        ("trace", {"target": True}, TypeError, "target: expected a finite number or None, found True"),
        ("trace", {"target": np.inf}, ValueError, "target: expected a finite number or None, found inf"),
        ("trace", {"max_step": 0.0}, ValueError, "max_step: expected a positive number, found 0.0"),
        ("trace", {"max_step": 1e-300}, ValueError, "max_step: expected at least the least step"),
        ("trace", {"finish": 3}, TypeError, r"finish: expected a function of \(y, lam\), found 3"),
        ("Tracer", {"state": 3}, TypeError, "state: expected the state of a tracer, or None, found 3"),
        ("Tracer", {"box": {"lam": (1.0, 0.0)}}, ValueError, "box: expected low < high for 'lam'"),
        ("Tracer", {"box": {"lam": (0.5, None)}}, ValueError, "box: expected the start inside, found 'lam' beyond 0.5"),
        ("Tracer", {"box": {1: (0.0, 1.0)}}, ValueError, "box: .* a number from 0 to 0, found 1"),
        ("Tracer", {"box": {"lam": 3}}, TypeError, "box: expected two numbers for 'lam'"),
        ("Tracer", {"box": {"lam": ("a", 3.0)}}, TypeError, "box: expected two numbers for 'lam'"),
        ("Tracer", {"box": {"z": (0.0, 1.0)}}, ValueError, "^box: "),
        ("Tracer", {"box": 3}, TypeError, "box: expected a mapping"),
    ],
)
def test_a_bad_option_is_named_with_what_was_found(taker, options, error, words):
    with pytest.raises(error, match=words):
        TAKERS[taker](**options)


def test_numbers_of_numpy_are_numbers():
    options = {"tolerance": np.float32(1e-6), "direction": np.int64(1), "examine": np.bool_(False)}
    assert isinstance(trace(Circle(), budget=Budget(steps=np.int64(3)), **options), Path)


@by_preset(FAST, DEFAULT, CONSERVATIVE, SERIES)
@pytest.mark.parametrize("longest", [0.05, 3.0, 1e6])
def test_a_longest_step_with_any_preset(preset, longest):
    path = trace(Circle(), preset=preset, max_step=longest, budget=Budget(steps=20))
    assert max(step.step_length for step in path.steps[1:]) <= longest


def test_a_path_is_a_start():
    whole = trace(Circle())
    after = trace(Circle(), start=whole[:5], budget=Budget(steps=3))
    np.testing.assert_array_equal(after.u[0], whole.u[4])
    (a, b), (c, d) = after.steps[0].tangent, whole.steps[4].tangent
    # The same ray, in the metric of another start.
    assert abs(a * d - b * c) < 1e-12
    assert a * c + b * d > 0.0
    # Without a tangent, as at a singular end, the last chord tells the direction.
    whole.steps[4] = evolve(whole.steps[4], tangent=np.full(2, np.nan))
    after = trace(Circle(), start=whole[:5], budget=Budget(steps=3))
    assert np.dot(after.u[-1] - after.u[0], whole.u[5] - whole.u[4]) > 0.0
