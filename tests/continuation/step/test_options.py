"""The one list of options: documented, typed, checked, and the same for everything that takes options."""

import inspect
import re

import attrs
import numpy as np
import pytest

from continuation import Budget, Path, Tracer, TurningPoint, from_functions, trace
from continuation.archive import checkpoint, resume, trace_many
from continuation.chart import traced
from continuation.controllers import Bounds
from continuation.metric import Weighted
from continuation.predictors import Hermite
from continuation.step.options import DEFAULTS, OPTIONS, PART_OPTIONS, checked
from continuation.step.settings import Settings
from problems import lcp
from problems.bifurcation import Bratu1D, Circle

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
        ({"predictor": "tangent"}, TypeError, "predictor"),
        ({"corrector": Hermite()}, TypeError, "corrector"),
        ({"controller": 0.1}, TypeError, "controller"),
        ({"metric": "euclidean"}, TypeError, "metric"),
        ({"metric": Weighted(-1.0)}, ValueError, "y"),
        ({"preset": "FAST"}, TypeError, "preset"),
        ({"budget": 100}, TypeError, "budget"),
        ({"events": TurningPoint()}, TypeError, "events"),
        ({"events": [lambda u, v: 0.0]}, TypeError, "events"),
        ({"tolerance": 0.0}, ValueError, "tolerance"),
        ({"tolerance": -1e-8}, ValueError, "tolerance"),
        ({"start": (np.zeros(3), np.ones(3))}, ValueError, "start"),
        ({"start": (np.zeros(2), np.zeros(2))}, ValueError, "start"),
        ({"direction": 2}, ValueError, "direction"),
        ({"target": np.nan}, ValueError, "target"),
        ({"target": "there"}, ValueError, "target"),
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


@pytest.mark.parametrize(
    ("homotopy", "error", "words"),
    [
        (Without(start=lambda: (np.zeros(1), 0.0)), TypeError, "residual"),
        (Without(residual=lambda y, lam: y), TypeError, "start"),
        (Without(start=lambda: np.zeros(2), residual=lambda y, lam: y), ValueError, "start"),
        (from_functions(lambda y, lam: y, start=([np.nan], 0.0)), ValueError, "start"),
        (from_functions(lambda y, lam: y, start=([0.0], np.inf)), ValueError, "start"),
        (from_functions(lambda y, lam: y, start=([], 0.0)), ValueError, "start"),
        (Without(start=lambda: ([1j], 0.0), residual=abs), ValueError, "start: expected real numbers, found compl"),
        (Without(start=lambda: ([1.0], 1j), residual=abs), ValueError, "start: expected real numbers, found compl"),
        (Without(start=lambda: ([1.0], [0.0, 1.0]), residual=abs), ValueError, "start: expected lam0 to be one"),
        (from_functions(lambda y, lam: y, start=(np.zeros((2, 2)), 0.0)), ValueError, "start"),
        (from_functions(lambda y, lam: np.append(y, lam), start=([0.0], 0.0)), ValueError, "residual"),
        (from_functions(lambda y, lam: y + 1j, start=([0.0], 0.0)), ValueError, "residual"),
    ],
)
def test_what_is_wrong_with_a_homotopy_is_named(homotopy, error, words):
    with pytest.raises(error, match=words):
        trace(homotopy)


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Budget(steps=0), "steps"),
        (lambda: Budget(seconds=-1.0), "seconds"),
        (lambda: TurningPoint(direction=2), "direction"),
        (lambda: TurningPoint(terminal=-1), "terminal"),
        (lambda: Bounds(maximum=0.0), "maximum"),
        (lambda: trace(Circle(), events=[TurningPoint(component=7)]), "component"),
    ],
)
def test_bad_settings_are_named(make, name):
    with pytest.raises((IndexError, ValueError), match=name):
        make()


def test_a_class_is_not_taken_for_a_homotopy():
    with pytest.raises(TypeError, match=r"homotopy: expected an object, found the class Bratu1D; make one"):
        trace(Bratu1D)


@pytest.mark.parametrize("target", ["there", np.nan, np.ones(2), 1j])
def test_a_homotopys_own_target_is_checked(target):
    homotopy = from_functions(lambda y, lam: y - lam, start=([0.0], 0.0), target=target)
    with pytest.raises((TypeError, ValueError), match="target: expected a finite number or None, found"):
        Tracer(homotopy)


def test_numbers_of_numpy_are_numbers():
    options = {"tolerance": np.float32(1e-6), "direction": np.int64(1), "examine": np.bool_(False)}
    assert isinstance(trace(Circle(), budget=Budget(steps=np.int64(3)), **options), Path)


def test_a_misspelt_option_fails_in_mypy(tmp_path):
    api = pytest.importorskip("mypy.api")
    program = "import continuation\ncontinuation.trace(None, budgett=3)\ncontinuation.trace(None, tolerance=1e-6)\n"
    said, _, status = api.run(["-c", program, "--follow-imports=silent", f"--cache-dir={tmp_path}", "--config-file="])
    assert status == 1
    assert 'error: Unexpected keyword argument "budgett"' in said
    assert "Found 1 error" in said
