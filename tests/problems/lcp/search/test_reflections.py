"""The search by reflections: what its sets are, in any units, and that it solves where paths seldom do."""

import math

import numpy as np
import pytest

from problems import lcp
from problems.lcp import LCP, MixedLCP
from problems.lcp.data.problem import BETWEEN, LOWER, UPPER
from problems.lcp.search.reflections import RUNS_AT_ONCE, Sets

from ..util import solution_of


def planted(n, seed, bounds=False):
    """Gaussian with a solution, half of it at a bound."""
    r = np.random.default_rng([n, seed])
    A, at, far = r.standard_normal((n, n)), r.random(n), r.uniform(0.1, 2.0, n)
    if not bounds:
        x = np.where(at < 0.5, far, 0.0)
        return LCP(A, np.where(at < 0.5, 0.0, r.uniform(0.1, 2.0, n)) - A @ x)
    lower = np.where(r.random(n) < 0.3, -np.inf, -far)
    upper = np.where(r.random(n) < 0.3, np.inf, far)
    low, high = (at < 0.3) & np.isfinite(lower), (at > 0.7) & np.isfinite(upper)
    x = np.where(low, lower, np.where(high, upper, 0.9 * far * r.uniform(-1.0, 1.0, n)))
    w = np.where(low, 1.0, np.where(high, -1.0, 0.0)) * r.uniform(0.1, 2.0, n)
    return MixedLCP(A, w - A @ x, lower, upper)


def nearest_by_trial(problem, x, w):
    """Each pair's nearest of its pieces, one after the other."""
    out = []
    for xi, wi, lo, hi in zip(x, w, problem.lower, problem.upper):
        pieces = [(lo, max(wi, 0.0), LOWER), (min(max(xi, lo), hi), 0.0, BETWEEN), (hi, min(wi, 0.0), UPPER)]
        out.append(min((p for p in pieces if math.isfinite(p[0])), key=lambda p: (p[0] - xi) ** 2 + (p[1] - wi) ** 2))
    return out


@pytest.mark.parametrize("bounds", [False, True])
def test_both_projections_are_the_nearest_points(bounds):
    problem, r = planted(6, 1, bounds), np.random.default_rng(0)
    sets = Sets.of(problem)
    z = r.standard_normal((12, RUNS_AT_ONCE)).astype(np.float32)
    near = sets.onto @ z + sets.nearest
    again = sets.onto @ near + sets.nearest
    np.testing.assert_allclose(again, near, atol=1e-5)
    # What is cut off is normal to the set, whose directions are the differences of its points.
    np.testing.assert_allclose((near[:, :1] - near).T @ (z - near), 0.0, atol=1e-4)
    own = MixedLCP(np.eye(6), np.zeros(6), sets.lower[:, 0].astype(float), sets.upper[:, 0].astype(float))
    state, b = sets._complementary(z)
    for j in range(RUNS_AT_ONCE):
        found = list(zip(b[:6, j], b[6:, j], state[:, j]))
        for (x, w, _), (x0, w0, _) in zip(found, nearest_by_trial(own, z[:6, j], z[6:, j])):
            assert (x, w) == pytest.approx((x0, w0), abs=1e-6)
        # The face is one that the point lies on.
        for (x, w, face), lo, hi in zip(found, own.lower, own.upper):
            assert w == 0.0 if face == BETWEEN else x == pytest.approx(lo if face == LOWER else hi)


def test_a_large_part_of_rank_one_is_not_what_units_are_taken_from():
    r = np.random.default_rng(6)
    game = LCP(r.standard_normal((40, 40)) + 1e4, -np.ones(40))
    # Along the others a step in x and one in w = A x weigh the same: of either a half is left.
    assert 0.3 < np.median(Sets.of(game).onto.diagonal()[:40]) < 0.7


def test_bounds_far_from_zero_are_those_of_the_sets():
    problem = planted(40, 8, bounds=True)
    off = 1e3 * np.random.default_rng(9).uniform(1.0, 2.0, 40)
    moved = MixedLCP(problem.A, problem.q - problem.A @ off, problem.lower + off, problem.upper + off)
    sets = Sets.of(moved)
    assert not sets.lower[np.isfinite(sets.lower)].any()  # the bound nearest to zero is where x begins
    assert lcp.solve(moved, restarts=0).solved


@pytest.mark.parametrize("bounds", [False, True])
@pytest.mark.parametrize("n", [50, 100])
def test_planted_problems_are_solved_before_any_path(n, bounds):
    for seed in range(5):
        problem = planted(n, seed, bounds)
        found = solution_of(problem, restarts=0)
        assert not found.paths
        assert lcp.certify(problem, found.x).solves(1e-10)


def test_a_hard_size_in_few_factorizations():
    # n = 300: half of such problems were solved in a minute by paths from random starts.
    found = lcp.solve(planted(300, 0), restarts=0)
    assert found.solved
    assert "reflections" in found.message
    assert found.counts.factorizations < 300


def test_what_has_no_solution_comes_to_an_end():
    r = np.random.default_rng(5)
    A, q = r.standard_normal((45, 45)), r.standard_normal(45)
    A[0], q[0] = -np.abs(A[0]), -1.0
    assert lcp.solve(LCP(A, q), restarts=0).outcome is lcp.Outcome.UNSOLVABLE
    assert next(over for over, _ in Sets.of(LCP(A, q)).rounds(np.random.default_rng(0)) if over) == 1


def test_no_unit_of_length_is_no_search():
    assert Sets.of(LCP(np.eye(2), np.zeros(2))) is None
    nothing = Sets.of(LCP(np.zeros((2, 2)), [-1.0, 1.0]))
    assert np.isfinite(nothing.onto).all()
