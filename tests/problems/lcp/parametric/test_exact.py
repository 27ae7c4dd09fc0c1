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


def bounded(seed):
    """A problem between bounds, and a direction."""
    random = np.random.default_rng(seed)
    return drawn(random, 5), random.normal(size=5)


@pytest.mark.parametrize(
    ("make", "number", "t", "several"), [(known.integer_problem, 60, (np.inf, 0.0), 11), (bounded, 10, (0.0, 10.0), 0)]
)
def test_paths_with_ties_and_between_bounds_are_proved(make, number, t, several):
    singles = []
    for problem, d in map(make, range(number)):
        path = along(problem, d, t)
        exact = prove_path(problem, d, path)
        assert exact.u == pytest.approx(path.u, rel=1e-10, abs=1e-12)
        singles.append(exact.single)
    assert singles.count(False) >= several
    assert several or all(singles)


def test_a_path_of_another_problem_is_not_proved():
    problem = known.murty(3)
    path = along(problem, np.ones(3), (np.inf, 0.0))
    with pytest.raises(UnprovenError, match="path: "):
        prove_path(LCP(problem.A, problem.q - [0.0, 0.0, 1.0]), np.ones(3), path)
    steps = [path.steps[0], *path.steps[2:]]
    with pytest.raises(UnprovenError, match="path: "):
        prove_path(problem, np.ones(3), evolve(path, steps=steps, events=[]))
