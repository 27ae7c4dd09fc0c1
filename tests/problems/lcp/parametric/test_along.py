"""`lcp.along`: known numbers of kinks, closed forms, and all pieces by brute force."""

from __future__ import annotations

import numpy as np
import pytest

from continuation.archive import open_archive
from continuation.status import Kind, Status
from problems.lcp import LCP, MixedLCP, along, solve
from problems.lcp.parametric.along import natural_residuals

from ..util import drawn
from . import util as known

lasso, murty = known.lasso, known.murty

ENDS = (Status.REACHED_TARGET, Status.DIVERGED, Status.CLOSED, Status.DEAD_END)
"""What a path may end as; that no other ray leaves a dead end is among what is compared."""


@pytest.mark.parametrize("n", [2, 5, 8])
def test_murtys_example_has_all_its_kinks(n):
    path = along(murty(n), np.ones(n), (np.inf, 0.0))
    assert path.status is Status.REACHED_TARGET
    assert len(path.kinks) == 2**n - 1
    assert np.array_equal(path(t=0.0)[:n], np.append(2.0 ** (n - 1), np.zeros(n - 1)))


@pytest.mark.parametrize("p", [1, 3, 5, 7])
def test_the_lasso_path_of_mairal_and_yu_has_all_its_kinks(p):
    assert len(lasso(*known.mairal_yu(p)).kinks) == (3**p - 1) // 2


def test_random_paths_with_ties_are_those_of_all_pieces():
    kinks = degenerate = branching = 0
    for seed in range(150):
        problem, d = known.integer_problem(seed)
        path = along(problem, d, (np.inf, -np.inf))
        assert path.status in ENDS or "goes round" in path.message
        # Between its points a path of solutions is straight: whatever is not zero all the way is nowhere zero inside.
        for u in (*path.u, *(0.5 * (path.u[1:] + path.u[:-1]))):
            there = LCP(problem.A, problem.q + u[-1] * d)
            assert there.natural_residual(u[:-1]) <= 1e-12 * (1.0 + np.abs(u).max())
        for kink in path.kinks:
            rays = known.all_rays(problem, d, kink.u)
            if rays is not None:
                assert len(rays) == len(kink.rays)
                assert all(np.abs(kink.rays - ray).max(axis=1).min() <= 1e-8 for ray in rays)
                kinks, branching = kinks + 1, branching + (len(rays) > 2)
                degenerate += len(kink.switches) > 1
    assert kinks > 400
    assert degenerate > 40
    assert branching > 10


@pytest.mark.parametrize("seed", range(20))
def test_bounds_of_all_kinds(seed):
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 9))
    problem, d = drawn(random, n), random.normal(size=n)
    path = along(problem, d, (0.0, 10.0))
    end = MixedLCP(problem.A, problem.q + 10.0 * d, problem.lower, problem.upper)
    assert path.endpoint.y == pytest.approx(solve(end).x, abs=1e-9)
    assert np.abs(natural_residuals(problem, d, np.zeros(n), path.u)).max() <= 1e-11


def test_t_stands_still_where_a_block_is_singular():
    # x_0 grows along t = 1 from w_0 = 0 on, until w_1 vanishes.
    path = along(LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, 2.0]), [1.0, 0.0], (np.inf, 0.0))
    assert path.success
    assert path.u[1:] == pytest.approx(np.array([[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 1.0, 0.0]]), abs=1e-15)


def test_columns_that_are_alike():
    random = np.random.default_rng(3)
    X, y = random.integers(-2, 3, (12, 4)).astype(float), random.integers(-3, 4, 12).astype(float)
    X = np.column_stack([X, X[:, 0], -X[:, 2]])
    path = lasso(X, y)
    assert path.success
    for u in path.u[1:]:
        slope = X.T @ (X @ u[:-1] - y)
        assert np.abs(slope + np.clip(-slope, -u[-1], u[-1])).max() <= 1e-13


def test_a_closed_curve_closes():
    # Between the faces of w_0 x_0 = 0 and x_1 w_1 = 0 the solutions go round.
    closed = []
    for seed in range(200):
        random = np.random.default_rng(seed)
        A, x = random.normal(size=(3, 3)), np.maximum(random.normal(size=3), 0.0)
        problem = LCP(A, np.where(x > 0.0, 0.0, random.random(3)) - A @ x)
        path = along(problem, random.normal(size=3), (0.0, 50.0))
        closed += [path] if path.status is Status.CLOSED else []
    assert closed
    for path in closed:
        assert path.u[-1] == pytest.approx(path.u[0], abs=1e-12)


def test_crossings_of_a_value():
    path = along(murty(3), [1.0, 1.0, 1.0], (np.inf, -np.inf))
    for t in (0.0, 1.5, 3.0):
        there = path.crossings(t)
        assert np.array_equal(path(t=t), there[0])
        assert max(LCP(murty(3).A, murty(3).q + t).natural_residual(u[:3]) for u in there) <= 1e-14
    assert path.crossings(1e6).shape == (0, 4)


def test_an_archive_holds_the_path_its_kinks_and_their_rays(tmp_path):
    problem, d = known.integer_problem(9)
    path = along(problem, d, (np.inf, -np.inf), archive=tmp_path / "path.h5")
    with open_archive(tmp_path / "path.h5") as archive:
        (again,) = archive
    assert np.array_equal(again.u, path.u)
    for one, other in zip(again.kinks, path.kinks, strict=True):
        assert (one.name, one.switches, one.kind) == (other.name, other.switches, Kind.KINK)
        assert np.array_equal(one.rays, other.rays)
    middle = 0.5 * (path.arclength[1:] + path.arclength[:-1])
    assert again(middle) == pytest.approx(path(middle), abs=1e-12)


def test_a_path_that_comes_back_to_a_branching_kink_ends_there():
    problem, d = known.integer_problem(922)
    path = along(problem, d, (np.inf, -np.inf))
    assert path.status is Status.UNRESOLVED_KINK
    assert "goes round from here" in path.message
    assert len(path) < 20


@pytest.mark.parametrize("m", [11, 30])
def test_more_pairs_at_once_than_all_pieces_can_be_tried_for(m):
    for rho in (0.0, 0.5):
        path = along(MixedLCP((1.0 - rho) * np.eye(m) + rho, -np.ones(m)), np.zeros(m), (np.inf, 0.0), level=1.0)
        assert path.status is Status.REACHED_TARGET
        assert [kink.switches for kink in path.kinks] == [tuple(range(m))]
        assert np.abs(path.endpoint.y * (1.0 + rho * (m - 1)) - 1.0).max() < 1e-14
    # All x that are not zero turn t back at t = 1.
    path = along(LCP(-np.eye(m), -np.ones(m)), np.ones(m), (np.inf, 0.0))
    assert path.status is Status.DIVERGED
    assert [(kink.name, kink.switches, kink.lam) for kink in path.kinks] == [("turning kink", tuple(range(m)), 1.0)]
