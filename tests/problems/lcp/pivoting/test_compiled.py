"""The loop that numba compiles takes the pivots that numpy takes: as plain Python here, compiled where numba is."""

import sys
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from problems import lcp
from problems.lcp import LCP
from problems.lcp.pivoting import almost, compiled
from problems.lcp.pivoting.starts import Game, covering


def problem(seed):
    """Small integers, so that most ratio tests have ties; nonnegative ones end on a solution."""
    r = np.random.default_rng([19, seed])
    n = int(r.integers(2, 9))
    return LCP(r.integers(-3 if seed % 2 else 0, 4, (n, n)), r.integers(-3, 2, n))


def game(seed):
    r = np.random.default_rng([20, seed])
    m, n = r.integers(2, 7, 2)
    A = np.zeros((m + n, m + n))
    A[:m, m:], A[m:, :m] = r.integers(1, 4, (m, n)), r.integers(1, 4, (n, m))
    return Game.of(LCP(A, -np.ones(m + n)))


def end(make, on, most):
    """How a path ends, and where: by steps, or by the loop; None where there is no path."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(almost, "available", lambda: on)
        path = make()
        if path is None:
            return None
        path.run(most)
    tables = [] if path.ended is almost.Ended.PATH_LEFT else [d.table.ravel() for d in path.dictionaries]
    return path.ended, path.pivots, path.entering, path.active.tolist(), np.concatenate([*tables, []])


def same(make, most=200):
    by_steps, by_loop = (end(make, on, most) for on in (False, True))
    if by_steps is None:
        assert by_loop is None
        return None
    assert by_steps[:4] == by_loop[:4]
    np.testing.assert_allclose(by_steps[4], by_loop[4], rtol=1e-9, atol=1e-9)
    return by_steps[0]


@pytest.fixture
def plain(monkeypatch):
    monkeypatch.setattr(almost, "kernel", lambda: compiled.pivots)


def agreed():
    """How often paths of Lemke's method reach their end, and how often a ray, where all of games end."""
    ends = [same(partial(covering, one, np.ones(one.n))) for one in map(problem, range(80))]
    assert {same(lambda seed=seed: game(seed).path(seed % 4)) for seed in range(20)} == {almost.Ended.REACHED}
    return ends.count(almost.Ended.REACHED), ends.count(almost.Ended.RAY)


def test_the_loop_takes_the_pivots_of_the_steps(plain):
    reached, rays = agreed()
    assert reached > 20
    assert rays > 10


@pytest.mark.parametrize("most", [0, 1, 5, 100])
def test_the_loop_stops_where_pivots_are_used_up_and_tables_are_made_afresh(plain, monkeypatch, most):
    monkeypatch.setattr(almost, "REBUILT_AFTER", -3)
    one = LCP(np.eye(9) + np.triu(np.full((9, 9), 2.0), 1), -np.ones(9))
    same(lambda: covering(one, np.arange(1.0, 10.0)), most)


def test_it_is_used_where_the_program_has_imported_numba_and_said_so(monkeypatch):
    asked, one = [], game(3).problem

    def njit(function=None, cache=False):
        asked.append(cache)
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return function

    monkeypatch.delitem(sys.modules, "numba", raising=False)
    without = lcp.solve(LCP(one.A, one.q))
    assert "Lemke and Howson, before" in without.message
    monkeypatch.setitem(sys.modules, "numba", SimpleNamespace(njit=njit))
    monkeypatch.setattr(almost, "kernel", compiled.kernel.__wrapped__)
    found = lcp.solve(one)
    assert asked == [True, False]
    assert "Lemke and Howson (pivots compiled by numba)" in found.message
    np.testing.assert_array_equal(found.x, without.x)


def test_a_game_is_left_where_the_table_of_either_player_is_singular(monkeypatch):
    monkeypatch.setattr(almost, "REBUILT_AFTER", -100)
    for lost in (0, 1):
        path = game(15).path(0)
        monkeypatch.setattr(
            almost.Dictionary, "rebuilt", lambda one, at=path.dictionaries[lost]: np.nan if one is at else 0.0
        )
        assert path.run(200) is almost.Ended.PATH_LEFT


def test_numba_compiles_it():
    pytest.importorskip("numba")
    assert agreed()[0] > 20
