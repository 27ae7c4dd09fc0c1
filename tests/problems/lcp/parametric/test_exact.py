"""Paths proved in rational numbers."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from attrs import evolve

from problems.lcp import LCP, UnprovenError, along, prove_path

from ..util import drawn
from . import util as known


def test_murtys_path_is_proved_and_is_the_only_one():
    problem = known.murty(5)
    path = along(problem, np.ones(5), (np.inf, 0.0))
    exact = prove_path(problem, np.ones(5), path)
    assert exact.single
    assert len(exact.points) == 33
    assert exact.points[-1] == (Fraction(16), *(Fraction(0),) * 5)
    assert np.array_equal(exact.u, path.u)


def test_paths_with_ties_are_proved():
    singles = []
    for seed in range(60):
        problem, d = known.integer_problem(seed)
        path = along(problem, d, (np.inf, 0.0))
        exact = prove_path(problem, d, path)
        assert exact.u == pytest.approx(path.u, abs=1e-12)
        singles.append(exact.single)
    assert singles.count(False) > 10


@pytest.mark.parametrize("seed", range(10))
def test_paths_between_bounds_are_proved(seed):
    random = np.random.default_rng(seed)
    problem, d = drawn(random, 5), random.normal(size=5)
    path = along(problem, d, (0.0, 10.0))
    exact = prove_path(problem, d, path)
    assert exact.single
    assert exact.u == pytest.approx(path.u, rel=1e-10)


def test_a_path_of_another_problem_is_not_proved():
    problem = known.murty(3)
    path = along(problem, np.ones(3), (np.inf, 0.0))
    with pytest.raises(UnprovenError, match="path: "):
        prove_path(LCP(problem.A, problem.q - [0.0, 0.0, 1.0]), np.ones(3), path)
    steps = [path.steps[0], *path.steps[2:]]
    with pytest.raises(UnprovenError, match="path: "):
        prove_path(problem, np.ones(3), evolve(path, steps=steps, events=[]))
