"""Pivoting as an attempt of `solve`: Lemke's method and that of Lemke and Howson, certified and limited in pivots."""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from problems.lcp.active_set.face import Mask
from problems.lcp.active_set.iteration import Policy
from problems.lcp.data.problem import LCP, active_state
from problems.lcp.parametric.basis import SingularBasisError
from problems.lcp.parametric.start import from_solution
from problems.lcp.parametric.trail import state_at
from problems.lcp.pivoting.almost import AlmostComplementary, Ended
from problems.lcp.pivoting.starts import Game, covering, unit_of
from problems.lcp.proof.farkas import infeasibility
from problems.lcp.search.search import Search

LARGEST = 1000
"""A larger order is not pivoted: a table is n^2 numbers, and a pivot goes through all of them."""

AT_ORDER = 10
"""So many pivots times the order are done at most,"""

WORK = 1_000_000
"""and so many over the order, which is less from order 316 on: a second, where a path of order 1000 takes ten."""

COVERINGS = 5
"""Covering vectors that are tried on a quadratic program, with twice the pivots each,"""

SPREAD = (-3.0, 0.0)
"""and the decimal logarithms of their entries. On 40 indefinite box QPs (n = 40 to 200): 5 suffice, the first mostly,
with 20 n pivots; with 10 n up to 6 are needed; entries from 0.1 to 3 need up to 51 with 10 n, 4 with 20 n."""

LABELS = (0, -1)
"""One of each player: where a path from one is long those from the others are (covariant games of order 300)."""

GAME_WORK = 1_000_000_000
"""Entries of its table that a path of a game goes through at most; its pivots are doubled, label by label, up to there.
Covariant games (rho = -.9) of order 300 take 5,000 to 17,000 pivots, 0.15 to 0.6 s; by other paths 2 s, where these
arrive, which is in two of three."""

AT_END = Policy(steps=2)
"""Corrections of the active set of the last basis, which is right but for rounding."""


@frozen(eq=False)
class Nearby:
    """The solution of a problem nearby: x, and w = A x + q there."""

    x: Array
    w: Array


def most_pivots(n: int) -> int:
    """How many pivots are worth their time before a path.

    Parameters
    ----------
    n : int
    """
    return min(AT_ORDER * n, WORK // n)


def by_lemke(search: Search, seed: int) -> bool:
    """Lemke's method; whether it led to a solution, or its ray to a proof that there is none.

    Parameters
    ----------
    search : Search
        Takes up what is found.
    seed : int
        Of covering vectors.
    """
    problem = search.problem
    assert isinstance(problem, LCP)
    most, unit = most_pivots(problem.n), unit_of(problem)
    bounds = constraints(problem)
    if bounds.any():
        random = np.random.default_rng(seed)
        for _ in range(COVERINGS):
            path = covering(problem, np.where(bounds, 0.0, unit * 10.0 ** random.uniform(*SPREAD, problem.n)))
            if path is not None and _reached(search, path, path.run(2 * most, search.seconds_left)):
                return True
    path = covering(problem, np.full(problem.n, unit))
    if path is None:
        return False
    ended = path.run(most, search.seconds_left)
    if ended is Ended.RAY:
        search.proof = infeasibility(problem, guess=path.ray())
        return search.proof is not None
    return _reached(search, path, ended)


def by_guess(search: Search, guess: Nearby) -> bool:
    """Follow LCP(q + t (q' - q), A) from t = 1, where the guess is the solution, to 0; whether that led to one.

    q' = w - A x with x and w those of the guess: whatever problem it is the solution of, it solves that for q' too.

    Parameters
    ----------
    search : Search
        Takes up what is found.
    guess : Nearby
        In the units of the search.

    References
    ----------
    Cottle, Pang and Stone, section 4.5.
    """
    problem = search.problem
    x = problem.clipped(guess.x)
    low, high = x <= problem.lower, x >= problem.upper
    w = np.where(low & ~problem.fixed, np.maximum(guess.w, 0.0), np.where(high, np.minimum(guess.w, 0.0), 0.0))
    dense = problem.A.toarray() if problem.sparse else problem.A
    d = w - (dense @ x + problem.q)
    if not np.isfinite(d).all():
        return False
    try:
        walk = from_solution(evolve(problem, A=dense), d, np.zeros(problem.n), x, 1.0, -1.0)
    except SingularBasisError:
        return False
    state = None if walk is None else state_at(walk, 0.0, most_pivots(problem.n))
    return state is not None and search.settle(state, AT_END)


def constraints(problem: LCP) -> Mask:
    """The rows b - B x >= 0, b >= 0, of a quadratic program's optimality conditions: those without a share of t.

    ``A = [[Q, B'], [-B, 0]]`` but for units and order. With t in the rows of Q alone LCP(q + t d, A) is the program
    with the cost c + t d. For large t, and bounded x, its only stationary point is x = 0: no other ray comes back.

    Parameters
    ----------
    problem : LCP

    References
    ----------
    Eaves, "On quadratic programming", Management Science 17, 1971.
    """
    rows: Mask = (problem.q >= 0.0) & (problem.A.diagonal() == 0.0)
    none = np.zeros_like(rows)
    if not rows.any():
        return none
    dense = problem.A.toarray() if problem.sparse else problem.A
    signs = np.sign(dense[rows])
    rows[rows] = (signs == -np.sign(dense[:, rows].T)).all(axis=1) & signs.any(axis=1)
    return rows if not dense[np.ix_(rows, rows)].any() else none


def by_lemke_howson(search: Search) -> bool:
    """The method of Lemke and Howson from `LABELS`; whether it led to a solution.

    Parameters
    ----------
    search : Search
        Takes up what is found.
    """
    assert isinstance(search.problem, LCP)
    game = Game.of(search.problem)
    if game is None:
        return False
    n, m = search.problem.n, game.actions
    paths: list[AlmostComplementary] = []
    most = AT_ORDER * n
    last = max(most, GAME_WORK // (m * (n - m)))
    while most <= last and (not paths or any(path.ended is None for path in paths)):
        for k, label in enumerate(LABELS):
            if k == len(paths):
                paths.append(game.path(label % n))
            if paths[k].ended is None and _reached(search, paths[k], paths[k].run(most, search.seconds_left)):
                return True
        most *= 2
    return False


def _reached(search: Search, path: AlmostComplementary, ended: Ended) -> bool:
    return ended is Ended.REACHED and search.settle(active_state(path.active), AT_END)
