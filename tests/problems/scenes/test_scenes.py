"""What holds of every scene: its protocol, its minimal model, its picture; published answers are beside this file."""

from __future__ import annotations

import tomllib
from inspect import signature
from pathlib import Path

import attrs
import numpy as np
import pytest
from matplotlib.figure import Figure

from problems.charts.scenes import COUNTS
from problems.lcp import MixedLCP
from problems.scenes import available, error, find, order, solve
from problems.scenes.scene import conditions

from .util import EXACT_TO, FREE, MINIMAL, small

ROOT = Path(__file__).parents[3]
NAMES = list(available())


def test_every_scene_is_registered_and_installed():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    written = project["entry-points"]["continuation.scenes"]
    # Entry points are read from the installed package: `pip install -e .` after a change of pyproject.toml.
    assert {name: available()[name].points[0].value for name in written} == written
    parts = {"__init__", "pictures", "planar", "registry", "rivals", "scene"}
    files = {file.stem for file in (ROOT / "problems" / "scenes").glob("*.py")} - parts
    assert {value.partition(":")[0].rpartition(".")[2] for value in written.values()} == files
    assert set(NAMES) >= set(MINIMAL) == set(written)


@pytest.mark.parametrize("name", NAMES)
def test_a_scene_is_a_frozen_value_with_defaults(name):
    factory = find(name)
    scene = factory()
    assert scene.parameters == factory().parameters
    for value, attribute in ((scene, "units"), (scene.parameters, attrs.fields(type(scene.parameters))[0].name)):
        with pytest.raises(attrs.exceptions.FrozenInstanceError):
            setattr(value, attribute, 1.0)
    assert set(attrs.asdict(scene.parameters)) == set(signature(factory).parameters)


@pytest.mark.parametrize("name", NAMES)
def test_the_answer_has_units_and_is_the_exact_one_and_it_is_drawn(name):
    scene = small(name)
    solution = solve(scene)
    answer = scene.answer(solution)
    assert set(answer) == set(scene.units)
    assert all(np.isfinite(np.asarray(value, dtype=float)).all() for value in answer.values()), answer
    assert set(scene.exact()) <= set(answer)
    assert not scene.exact() or error(answer, scene.exact()) <= EXACT_TO[name]
    axes = Figure().subplots()
    scene.draw(solution, axes)
    assert axes.has_data()


@pytest.mark.parametrize("name", NAMES)
def test_no_scene_has_an_unknown_that_its_answer_does_not_need(name):
    scene = small(name)
    fewest, reason = MINIMAL[name]
    problem = conditions(scene.problem())
    assert order(scene.problem()) == fewest, reason
    if isinstance(problem, MixedLCP):
        free = np.isneginf(problem.lower) & np.isposinf(problem.upper)
        assert int(free.sum()) == FREE.get(name, (0, ""))[0]


@pytest.mark.parametrize("name", NAMES)
def test_rivals_that_are_installed_agree(name):
    scene = small(name)
    exact = {**scene.answer(solve(scene)), **scene.exact()}
    # Interior points leave no exact zeros to be counted, and are asked for 1e-10 of a residual, not of an answer.
    exact = {key: value for key, value in exact.items() if key not in COUNTS}
    for rival in scene.rivals:
        if rival.installed:
            assert error(rival.run(scene), exact) <= max(1e-3, EXACT_TO.get(name, 0.0)), rival.name
