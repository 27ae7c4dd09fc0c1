"""Time steps of many bodies in contact: two of each family and size of the benchmark, by work that no clock counts."""

import itertools

import numpy as np
import pytest

from continuation import Budget
from problems import lcp

from ....util import benchmark

outside = benchmark("outside.py")


@pytest.mark.parametrize("family", outside.FAMILIES)
def test_every_family_of_the_benchmark_is_decided(family):
    (problem,) = outside.FAMILIES[family](1, 7)
    outcome, _ = outside.measured(problem, limit=60.0)
    assert outcome not in ("late", "NOT_FOUND", "STATIONARY")


@pytest.mark.parametrize("family", ["stacks", "arches", "piles"])
def test_bodies_in_contact_are_solved_without_a_path(family):
    for problem in outside.FAMILIES[family](10, 46):
        found = lcp.solve(problem)
        assert found.solved
        assert found.relative_residual < 1e-11
        assert not found.paths
        assert found.counts.factorizations < 60


@pytest.mark.parametrize(("family", "most"), [("stacks", 60), ("arches", 120)])
def test_the_kkt_path_alone_solves_bodies_in_contact(family, most):
    """Factorisations in the mean: one stack takes 24 to 73, by the kernel, and of 40 others one 450."""
    found = [lcp.solve(problem, "kkt") for problem in itertools.islice(outside.FAMILIES[family](7, 46), 0, 7, 2)]
    assert all(one.solved for one in found)
    assert sum(one.counts.factorizations for one in found) < most * len(found)


@pytest.mark.parametrize(("name", "budget"), [("kkt", Budget(steps=30)), ("auto", Budget(factorizations=1))])
def test_the_nearest_point_is_returned_and_said_where_none_passes(name, budget):
    # The end of the pure path, and of active sets alone, is as near as a float can be to what is asked for in vain.
    r = np.random.default_rng(1)
    M, S = r.standard_normal((2, 41, 41))
    problem = lcp.LCP(M @ M.T / 41 + np.eye(41) + 0.3 * (S - S.T), r.standard_normal(41))
    found = lcp.solve(problem, name, tolerance=1e-25, budget=budget)
    assert found.outcome is lcp.Outcome.NOT_FOUND
    assert found.relative_residual < 1e-14
    assert f"The relative residual of the best point is {found.relative_residual:.1e}." in found.message
