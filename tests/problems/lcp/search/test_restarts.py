"""Restarts: reproducible, in any order, over an executor, and given up when they are not worth following."""

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import continuation
from problems import lcp
from problems.lcp.homotopies.starts import LOG_DEVIATION, START_DISTANCES, natural_units, typical_units
from problems.lcp.search.paths import Restart, light, trace_light

PLANTED = 30


def planted(seed, n=PLANTED):
    """A random problem that is neither monotone nor P, with a solution."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((n, n)) / np.sqrt(n)
    x = np.maximum(rng.standard_normal(n), 0.0)
    w = np.where(x == 0.0, np.abs(rng.standard_normal(n)), 0.0)
    return lcp.LCP(A, w - A @ x)


def restart(problem, k, **changes):
    settings = {"name": "kkt", "seed": 0, "tolerance": 1e-10, "options": {}} | changes
    return Restart(structure=lcp.Structure(problem), k=k, **settings)


def test_starts_are_centred_positive_and_at_their_distance():
    problem = planted(1)
    x, w = 2.0 * typical_units(problem)[0], typical_units(problem)[1]
    for k in range(20):
        start = lcp.random_start(problem, np.random.default_rng(k))
        assert min(a.min() for a in (start.x0, start.z1, start.z2, start.w0)) > 0.0
        first, second = start.x0 * start.z1, start.w0 * start.z2
        np.testing.assert_allclose(first, first[0], rtol=1e-12)
        np.testing.assert_allclose(second, second[0], rtol=1e-12)
        scale = np.sqrt(first[0] / (x * w))
        low, high = START_DISTANCES
        assert 10**low <= scale <= 10**high
        spread = np.log(start.x0 / (scale * x))
        assert 0.5 * LOG_DEVIATION <= spread.std() <= 1.5 * LOG_DEVIATION
        # Where the two products are equal a central point of the LCP is one of the path.
        assert 0.4 <= second[0] / first[0] <= 2.5


def test_a_restart_depends_on_seed_and_number_alone():
    problem = planted(2)
    first, again = restart(problem, 3).trace(continuation.Budget()), restart(problem, 3).trace(continuation.Budget())
    np.testing.assert_array_equal(first.u, again.u)
    other = restart(problem, 4).trace(continuation.Budget())
    assert not np.array_equal(first.steps[0].u, other.steps[0].u)
    reseeded = restart(problem, 3, seed=1).homotopy()
    assert not np.array_equal(reseeded.origin.x0, restart(problem, 3).homotopy().origin.x0)


def test_the_first_path_leaves_time_for_others(monkeypatch):
    monkeypatch.setattr("problems.lcp.search.paths.RESTART_STEPS", 4.5 - PLANTED)
    monkeypatch.setattr("problems.lcp.search.reflections.Sets.of", lambda problem: None)
    monkeypatch.setattr("problems.lcp.search.exclusion.LARGEST_TREE", 0)
    problem = next(p for p in map(planted, range(50)) if lcp.solve(p, restarts=0).paths)
    first = lcp.solve(problem, restarts=1).paths[0]
    assert "it has not ended after 9 steps" in first.message
    assert "it has not ended" not in lcp.solve(problem, restarts=0).paths[0].message
    # A path that is asked for, or its steps, is followed to its end.
    small = continuation.CONSERVATIVE
    for options in ({"finish": False}, {"preset": small}, {"finish": False, "preset": small}):
        assert "it has not ended" not in lcp.solve(problem, restarts=1, path=True, **options).paths[0].message


def test_one_row_in_other_units_hardly_moves_the_starts():
    problem = planted(1)
    units = np.ones(PLANTED)
    units[np.argmin(np.abs(problem.q))] = 4.0
    other = lcp.LCP(units[:, None] * problem.A, units * problem.q)
    assert natural_units(other)[0] < 0.5 * natural_units(problem)[0]
    assert typical_units(other)[0] > 0.75 * typical_units(problem)[0]
    assert lcp.default_start(other).x0[0] > 0.75 * lcp.default_start(problem).x0[0]


def test_a_hopeless_path_is_given_up_with_a_reason(monkeypatch):
    monkeypatch.setattr("problems.lcp.search.paths.RESTART_STEPS", 5 - PLANTED)
    problem = planted(3)
    paths = [restart(problem, k).trace(continuation.Budget()) for k in range(6)]
    given_up = [k for k, path in enumerate(paths) if "Given up: " in path.message]
    assert given_up
    for k in given_up:
        assert paths[k].status is continuation.Status.ABANDONED
        assert not lcp.certify(problem, np.maximum(paths[k].endpoint.y[:PLANTED], 0.0)).solves(1e-6)
    pure = restart(problem, given_up[0], tolerance=None).trace(continuation.Budget())
    assert "Given up" not in pure.message


def test_solve_restarts_reproducibly_and_says_how_often():
    problem = next(p for p in map(planted, range(50)) if not lcp.solve(p, "kkt", restarts=0).solved)
    solution = lcp.solve(problem, "kkt", restarts=300, seed=5)
    assert solution.solved
    assert lcp.certify(problem, solution.x).solves(1e-10)
    again = lcp.solve(problem, "kkt", restarts=300, seed=5)
    np.testing.assert_array_equal(again.x, solution.x)
    assert len(again.paths) == len(solution.paths)
    assert f"random start {len(solution.paths) - 1} (seed 5)" in solution.message
    assert solution.path is solution.paths[-1]


def test_an_executor_finds_what_one_process_finds():
    problem = next(p for p in map(planted, range(50)) if not lcp.solve(p, "kkt", restarts=0).solved)
    with ThreadPoolExecutor(2) as executor:
        solution = lcp.solve(problem, "kkt", restarts=300, executor=executor)
    assert solution.solved
    assert lcp.certify(problem, solution.x).solves(1e-10)
    assert all(len(path) <= 2 for path in solution.paths[1:])


def test_over_an_executor_restarts_are_the_same():
    problem = planted(17)
    alone = lcp.solve(problem, "kkt", restarts=300, seed=2)
    with ThreadPoolExecutor(2) as executor:
        spread = lcp.solve(problem, "kkt", restarts=300, seed=2, executor=executor)
    np.testing.assert_array_equal(alone.x, spread.x)
    assert len(alone.paths) == len(spread.paths) > 3


def test_an_executor_stops_at_the_count():
    problem = lcp.LCP([[0.0, 1.0], [0.0, 0.0]], [-1.0, 1.0])
    with ThreadPoolExecutor(2) as executor:
        solution = lcp.solve(problem, "kkt", restarts=5, executor=executor)
    assert solution.outcome is lcp.Outcome.STATIONARY
    assert len(solution.paths) == 6
    assert "Restarts from random starts: 5" in solution.message


def test_light_paths_keep_their_ends():
    path = restart(planted(0), 0).trace(continuation.Budget())
    first, last, points = path.steps[0], path.endpoint, len(path)
    kept = light(path)
    assert points > 2
    assert len(kept) == 2
    np.testing.assert_array_equal(kept.steps[0].u, first.u)
    np.testing.assert_array_equal(kept.endpoint.u, last.u)
    assert len(trace_light(restart(planted(0), 0), continuation.Budget())) == 2


def test_restarts_go_on_until_the_budget_is_used_up(monkeypatch):
    """Whatever it is; where it has no limit there is one to their number."""
    monkeypatch.setattr("problems.lcp.search.solver.MOST_RESTARTS", 3)
    A = np.eye(61)
    A[:2, :2] = [[0.0, 1.0], [0.0, 0.0]]
    problem = lcp.LCP(A, np.append([-1.0, 1.0], -np.ones(59)))
    endless = lcp.solve(problem, budget=continuation.Budget(steps=math.inf))
    assert "Restarts from random starts: 3" in endless.message
    assert not endless.solved
    limit = endless.counts.factorizations + 300
    found = lcp.solve(problem, restarts=1000, budget=continuation.Budget(steps=math.inf, factorizations=limit))
    assert f"The budget is used up: {limit} factorisations." in found.message
    assert limit <= found.counts.factorizations < limit + 200
    assert len(found.paths) > len(endless.paths)
