"""Pivoting as an attempt of `solve`: Lemke's method and that of Lemke and Howson, certified and limited in pivots."""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen
from scipy.linalg.lapack import dgetrf

from continuation.arrays import Array, largest
from problems.lcp.active_set.face import Mask
from problems.lcp.active_set.iteration import Policy
from problems.lcp.data.matrix_structure import Structure
from problems.lcp.data.problem import LCP, active_state
from problems.lcp.parametric.basis import SingularBasisError
from problems.lcp.parametric.start import from_solution
from problems.lcp.parametric.trail import state_at
from problems.lcp.pivoting.almost import AlmostComplementary, Ended
from problems.lcp.pivoting.dictionary import Indices
from problems.lcp.pivoting.starts import Game, covering, unit_of
from problems.lcp.proof.farkas import infeasibility
from problems.lcp.search.search import Search

LARGEST_TABLE = 1000
"""A larger order is not pivoted: a table is n^2 numbers, and a pivot goes through all of them."""

LARGEST_CONVEX = 3000
"""Of the conditions of a convex program, on which Lemke's method ends, a larger one is: 72 MB. Traffic takes 1,224
pivots at n = 1188 and 2,427 at 2376, 0.2 and 1.2 s, where a path takes 2 s at n = 1188,"""

MANY_ENTRIES = 10
"""if its rows have so many entries on average, so that factors fill: a stencil has 5 to 9, and paths are quicker."""

CONVEX_PIVOTS = 3
"""Times the order: what they may take."""

PIVOTS_PER_ORDER = 10
"""So many pivots times the order are done at most,"""

PIVOT_WORK = 1_000_000
"""and so many over the order, which is less from order 316 on: a second, where a path of order 1000 takes ten."""

COVERINGS = 5
"""Covering vectors that are tried on a quadratic program, with twice the pivots each,"""

SPREAD = (-3.0, 0.0)
"""and the decimal logarithms of their entries. On 40 indefinite box QPs (n = 40 to 200): 5 suffice, the first mostly,
with 20 n pivots; with 10 n up to 6 are needed; entries from 0.1 to 3 need up to 51 with 10 n, 4 with 20 n."""

LABELS = (0, -1)
"""One of each player: where a path from one is long those from the others mostly are (covariant games of order 300)."""

SHORT_PATHS = 4
"""But of uniform and normal games of order 1000, where these take more than 10,000 pivots, 6 to 14 % of the labels
have a path of less than n / 2, half of them of less than n / 4: at first so many labels are tried as one long path
takes pivots, later twice as many with twice the pivots."""

GAME_WORK = 1_000_000_000
"""Entries of its table that a path of a game goes through at most; its pivots are doubled, label by label, up to there.
Covariant games (rho = -.9) of order 300 take 5,000 to 17,000 pivots, 0.15 to 0.6 s; by other paths 2 s, where these
arrive, which is in two of three."""

ENOUGH, ROUNDING = 64, 1e-10
"""Equations of the first face of which is asked how many are independent; a pivot that is rounding is smaller than this
beside the largest."""

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
    return min(PIVOTS_PER_ORDER * n, PIVOT_WORK // n) if n <= LARGEST_TABLE else CONVEX_PIVOTS * n


def convex(structure: Structure) -> bool:
    """Whether a problem beyond `LARGEST_TABLE` is that of a convex program with constraints that is worth its pivots.

    Parameters
    ----------
    structure : Structure
    """
    problem = structure.problem
    if not problem.sparse or problem.n > LARGEST_CONVEX or problem.A.nnz < MANY_ENTRIES * problem.n:
        return False
    return not structure.problem.A.diagonal().all() and structure.definite_where_it_has_entries()


def independent(problem: LCP) -> float:
    """How many equations of the first face, where q < 0, are independent but for rounding, as a share of the first few.

    Parameters
    ----------
    problem : LCP
        Dense.
    """
    inside = (problem.q < 0.0).nonzero()[0][:ENOUGH]
    pivots = np.abs(dgetrf(problem.A[inside][:, inside])[0].diagonal())
    return float(np.count_nonzero(pivots > ROUNDING * largest(pivots)) / pivots.size)


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


def by_lemke_howson(search: Search, seed: int) -> bool:
    """The method of Lemke and Howson from `LABELS`, and from many others, shortly; whether it led to a solution.

    Parameters
    ----------
    search : Search
        Takes up what is found.
    seed : int
        Of the order of the labels.

    References
    ----------
    Codenotti, De Rossi and Pagan, "An experimental analysis of Lemke-Howson algorithm", arXiv 0811.3247, 2008.
    """
    assert isinstance(search.problem, LCP)
    game = Game.of(search.problem)
    if game is None:
        return False
    n, m = search.problem.n, game.actions

    def leads(path: AlmostComplementary, most: int) -> bool:
        return path.ended is None and _reached(search, path, path.run(most, search.seconds_left))

    def shortly(labels: Indices, most: int) -> bool:
        return any(leads(game.path(int(label)), most) for label in labels)

    most, batch = PIVOTS_PER_ORDER * n, SHORT_PATHS * PIVOTS_PER_ORDER
    labels = np.random.default_rng(seed).permutation(n)
    paths = [game.path(LABELS[0] % n)]
    if leads(paths[0], most):
        return True
    paths += [game.path(label % n) for label in LABELS[1:]]
    while 2 * most <= GAME_WORK // (m * (n - m)) and any(path.ended is None for path in paths):
        most *= 2
        if any(leads(path, most) for path in paths):
            return True
    return shortly(labels[:batch], n // SHORT_PATHS) or shortly(labels[batch : 3 * batch], 2 * n // SHORT_PATHS)


def _reached(search: Search, path: AlmostComplementary, ended: Ended) -> bool:
    search.compiled = path.compiled
    # A first active set that was looked at, and not tried since, is counted here.
    looked = not search.counts.factorizations and search.looked is not None
    if ended is not Ended.REACHED:
        return False
    # Where rounding has made the last basis singular its own point may do.
    if not search.settle(active_state(path.active), AT_END) and not search.take(path.values()):
        return False
    search.counts.factorizations += looked
    return True
