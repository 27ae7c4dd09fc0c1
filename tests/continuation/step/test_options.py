"""The one list of options: documented, typed, checked, and the same for everything that takes options."""

import inspect
import re
from pathlib import Path as File

import attrs
import numpy as np
import pytest

from continuation import Budget, Path, Tracer, TurningPoint, trace
from continuation.archive import checkpoint, resume, trace_many
from continuation.chart import traced
from continuation.metric import Weighted
from continuation.predictors import Hermite
from continuation.step import presets
from continuation.step.options import DEFAULTS, OPTIONS, PART_OPTIONS, checked
from continuation.step.settings import Settings
from problems import lcp
from problems.bifurcation import Bratu1D, Circle

ROOT = File(__file__).parents[3]
LCP = lcp.LCP(np.eye(2), -np.ones(2))
TAKERS = {
    "trace": lambda **options: trace(Circle(), **options),
    "Tracer": lambda **options: Tracer(Circle(), **options),
    "trace_many": lambda **options: trace_many([Circle()], **options),
    "traced": lambda **options: traced("a method", **options),
    "solve": lambda **options: lcp.solve(LCP, **options),
}


def test_names_and_defaults_agree():
    course = ("tolerance", "budget", "target", "direction", "start", "finish", "max_step", "box")
    assert (*PART_OPTIONS, *course) == OPTIONS
    assert set(DEFAULTS) == set(OPTIONS)
    assert checked({}) == DEFAULTS


def test_settings_are_options_completed_and_what_an_archive_keeps():
    # A ceiling of the step is the controller's, and the faces of a box are events.
    others = {"preset", "start", "finish", "check_jacobian", "max_step", "box"}
    assert set(attrs.fields_dict(Settings)) == set(OPTIONS) - others
    assert tuple(attrs.fields_dict(Settings)) == checkpoint.OPTIONS


@pytest.mark.parametrize("taker", [trace, Tracer, resume])
def test_help_shows_every_option_with_its_default(taker):
    text = inspect.getdoc(taker)
    for name in OPTIONS:
        assert re.search(rf"^{name} : .*default ", text, re.MULTILINE), name
    assert "{" not in text


def test_help_of_the_solver_shows_the_parts_alone():
    text = inspect.getdoc(lcp.solve)
    assert all(f"\n{name} : " in text for name in PART_OPTIONS)
    assert "\ntarget : " not in text


def test_documented_defaults_are_those_that_hold():
    stated = dict(re.findall(r"^(\w+) : .*default (.*)$", inspect.getdoc(trace), re.MULTILINE))
    for name, value in DEFAULTS.items():
        assert stated[name] == ("DEFAULT" if name == "preset" else f"{value!r}") or eval(stated[name]) == value


@pytest.mark.parametrize("taker", TAKERS)
def test_an_unknown_option_is_refused_with_the_nearest_one(taker):
    with pytest.raises(TypeError, match=r"^predicter: expected one of the options .*; did you mean predictor\?$"):
        TAKERS[taker](predicter=Hermite())


def test_an_option_that_the_sweep_owns_is_refused():
    with pytest.raises(TypeError, match="start: expected no such option here, where every homotopy has its own"):
        trace_many([Circle()], start=(np.zeros(2), np.ones(2)))


@pytest.mark.parametrize("name", ["target", "direction", "start", "state", "observers"])
def test_an_option_that_the_solver_owns_is_refused(name):
    with pytest.raises(TypeError, match=f"^{name}: expected no such option here, solve says"):
        lcp.solve(LCP, **{name: 0.5})


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"preset": "fast"}, TypeError, "preset: expected FAST, .*, found 'fast'"),
        ({"predictor": Hermite}, TypeError, r"predictor: expected a predictor, found the class Hermite; Hermite\(\)"),
        ({"events": [TurningPoint]}, TypeError, "events: .* found the class TurningPoint"),
        ({"events": 1}, TypeError, "events: expected a list"),
        ({"check_jacobian": "yes"}, TypeError, "check_jacobian: expected True or False, found 'yes'"),
        ({"examine": 2}, TypeError, "examine: expected True or False, found 2"),
        ({"tolerance": "a"}, ValueError, "tolerance: .* found 'a'"),
        ({"budget": 3}, TypeError, "budget: expected a Budget, found 3"),
        ({"finish": 3}, TypeError, "finish: expected True or False, found 3"),
        ({"seed": "a"}, ValueError, "seed: expected an integer, at least 0, found 'a'"),
        ({"budgett": 3}, TypeError, r"budgett: .*; did you mean budget\?"),
    ],
    ids=repr,
)
def test_the_solver_refuses_at_once_what_its_paths_would_refuse(options, error, words):
    """Active sets alone solve this problem: no path is traced that could complain."""
    with pytest.raises(error, match=words):
        lcp.solve(LCP, **options)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"metric": Weighted(-1.0)}, ValueError, "y"),
        ({"events": [TurningPoint(component=7)]}, IndexError, "component"),
        ({"tolerance": "a"}, TypeError, "tolerance: expected a positive finite number or a Tolerance, found 'a'"),
        ({"tolerance": None}, TypeError, "tolerance: .* found None"),
        ({"tolerance": True}, TypeError, "tolerance: .* found True"),
        ({"tolerance": np.inf}, ValueError, "tolerance: .* found inf"),
        ({"start": (1, 2, 3)}, ValueError, r"start: expected a pair \(u, v\) of vectors, found 3 of them"),
        ({"start": (np.zeros(2),)}, ValueError, "start: expected a pair .* found 1 of them"),
        ({"start": 3}, ValueError, "start: expected a pair .* found 3"),
        ({"start": (np.zeros(2) + 1j, np.ones(2))}, ValueError, "start: expected real numbers, found complex128"),
        ({"start": ("a", "b")}, ValueError, "start: expected real numbers, found 'a'"),
        ({"start": (np.zeros(2), np.ones(3))}, ValueError, "start: .* vectors of one size"),
        ({"direction": "up"}, ValueError, "direction: expected -1, 0 or 1, found 'up'"),
        ({"direction": np.ones(2)}, ValueError, "direction: expected -1, 0 or 1"),
        ({"direction": True}, ValueError, "direction: expected -1, 0 or 1, found True"),
        ({"check_jacobian": "yes"}, TypeError, "check_jacobian: expected True or False, found 'yes'"),
        ({"examine": 2}, TypeError, "examine: expected True or False, found 2"),
        ({"predictor": Hermite}, TypeError, "predictor: .* found the class Hermite"),
        ({"events": [TurningPoint]}, TypeError, "events: .* found the class TurningPoint"),
        ({"observers": [1]}, TypeError, "observers: expected an observer, found 1, which has no `step`"),
        ({"observers": 1}, TypeError, "observers: expected a list of observers, found 1"),
        ({"archive": 1}, TypeError, "archive: expected a path or a PathLog, found 1"),
        ({"target": np.ones(2)}, TypeError, "target: expected a finite number or None, found array"),
        ({"target": 1j}, TypeError, "target: expected a finite number or None, found 1j"),
        ({"target": True}, TypeError, "target: expected a finite number or None, found True"),
    ],
)
def test_a_bad_option_is_named_with_what_was_found(options, error, words):
    with pytest.raises(error, match=words):
        trace(Circle(), **options)


class Without:
    def __init__(self, **methods):
        self.__dict__.update(methods)


def test_a_class_is_not_taken_for_a_homotopy():
    with pytest.raises(TypeError, match=r"homotopy: expected an object, found the class Bratu1D; make one"):
        trace(Bratu1D)


def test_numbers_of_numpy_are_numbers():
    options = {"tolerance": np.float32(1e-6), "direction": np.int64(1), "examine": np.bool_(False)}
    assert isinstance(trace(Circle(), budget=Budget(steps=np.int64(3)), **options), Path)


def test_a_misspelt_option_fails_in_mypy(tmp_path):
    api = pytest.importorskip("mypy.api")
    program = "import continuation\ncontinuation.trace(None, budgett=3)\ncontinuation.trace(None, tolerance=1e-6)\n"
    # The configuration of `make types`, so that what it has left is used: numpy's types alone take seconds.
    settings, left = tmp_path / "pyproject.toml", ROOT / ".mypy_cache"
    settings.write_text((ROOT / "pyproject.toml").read_text().replace('packages = ["continuation", "problems"]', ""))
    cache = left if left.exists() else tmp_path
    said, _, status = api.run(["-c", program, f"--cache-dir={cache}", f"--config-file={settings}"])
    assert status == 1
    assert 'error: Unexpected keyword argument "budgett"' in said
    assert "Found 1 error" in said


@pytest.mark.parametrize("preset", [presets.FAST, presets.DEFAULT, presets.CONSERVATIVE, presets.SERIES])
def test_a_longest_step_with_any_preset(preset):
    for longest in (0.05, 3.0, 1e6):
        path = trace(Circle(), preset=preset, max_step=longest, budget=Budget(steps=20))
        assert max(step.step_length for step in path.steps[1:]) <= longest


def test_a_path_is_a_start():
    whole = trace(Circle())
    after = trace(Circle(), start=whole[:5], budget=Budget(steps=3))
    assert np.array_equal(after.u[0], whole.u[4])
    (a, b), (c, d) = after.steps[0].tangent, whole.steps[4].tangent
    # The same ray, in the metric of another start.
    assert abs(a * d - b * c) < 1e-12
    assert a * c + b * d > 0.0
    with pytest.raises(ValueError, match="start: expected a path with a point to go on from"):
        trace(Circle(), start=Path())
