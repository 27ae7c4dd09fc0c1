"""Pivots by the methods of Lemke and of Lemke and Howson, and from a nearby problem's solution.

An almost complementary path ends at a solution or on a ray, which proves infeasibility for semidefinite A.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Mask
from problems.lcp.data.problem import LCP, active_state
from problems.lcp.pivoting.almost import AlmostComplementary, Ended
from problems.lcp.pivoting.starts import Game, covering, unit_of
from problems.lcp.proof.farkas import infeasibility
from problems.lcp.search.search import Nearby, Search

LARGEST_TABLE = 3000
"""Largest order that is pivoted: each pivot visits all 72 MB of the table."""

COVERINGS = 5
"""Covering vectors for a quadratic program: 5 with entries 10^U(-3, 0) suffice on 40 indefinite box QPs."""

SHORT_PATHS = 8
"""Labels per unit of work, tried up to n / 2 pivots: 6 to 14 % of a game's (order 1000) have such a path."""

GAME_WORK = 1_000_000_000
"""Most table entries that a game's path visits: covariant games of order 300 take up to 17,000 pivots, 0.6 s."""


def most_pivots(n: int, per_order: float = 10.0) -> int:
    """Pivots worth trying before a path, fewer per order for large n: a second at n = 1000, where a path takes ten."""
    return min(int(per_order * n), LARGEST_TABLE**2 // n)


def pivotable(search: Search) -> bool:
    """Whether the problem is an LCP with a small table, and the finish is on."""
    return search.problem.standard and search.problem.n <= LARGEST_TABLE and search.finish is not None


def game(search: Search) -> bool:
    """Whether the problem is a bimatrix game."""
    problem = search.problem
    first = not problem.sparse and problem.A[0, 0] == 0.0
    return first and isinstance(problem, LCP) and Game.of(problem) is not None


@frozen(eq=False)
class Pivots:
    """Almost complementary paths of one problem."""

    search: Search

    def run(self, work: float) -> str:
        """Pivot up to `work` times the order."""
        problem = self.search.problem
        assert isinstance(problem, LCP)
        played = Game.of(problem)
        paths = self._lemke(problem, work) if played is None else self._lemke_howson(played, work)
        for path, most in paths:
            if reached(self.search, path, most):
                method = "Lemke's method" if played is None else "the method of Lemke and Howson"
                return f"By {method}, before any path."
        return ""

    def _lemke(self, problem: LCP, work: float) -> Iterator[tuple[AlmostComplementary | None, int]]:
        """Paths from random covering vectors for programs, then from e."""
        most, unit = most_pivots(problem.n, work), unit_of(problem)
        bounds = constraints(problem)
        if bounds.any():
            random = np.random.default_rng(self.search.asked.seed)
            for _ in range(COVERINGS):
                d = np.where(bounds, 0.0, unit * 10.0 ** random.uniform(-3.0, 0.0, problem.n))
                yield covering(problem, d), 2 * most
        yield covering(problem, np.full(problem.n, unit)), most

    def _lemke_howson(self, played: Game, work: float) -> Iterator[tuple[AlmostComplementary, int]]:
        """Long paths from one label of each player, then short ones from many labels.

        References
        ----------
        Codenotti, De Rossi and Pagan, arXiv 0811.3247, 2008.
        """
        n, m = played.problem.n, played.actions
        most = max(int(work * n), GAME_WORK // (m * (n - m)))
        yield from ((played.path(label), most) for label in (0, n - 1))
        labels = np.random.default_rng(self.search.asked.seed).permutation(n)
        yield from ((played.path(int(label)), n // 2) for label in labels[: int(SHORT_PATHS * work)])


def reached(search: Search, path: AlmostComplementary | None, most: int) -> bool:
    """Follow a path; return whether it settled the problem."""
    ended = None if path is None else path.run(most)
    if path is None or ended not in (Ended.REACHED, Ended.RAY):
        return False
    if ended is Ended.RAY:
        search.proof = infeasibility(search.problem, guess=path.ray())
        return search.proof is not None
    # Rounding may make the last basis singular.
    if search.settle(active_state(path.active)):
        return True
    return search.finish is not None and search.found(search.finish.take(path.values()))


def by_guess(search: Search, guess: Nearby) -> bool:
    """Follow LCP(q + t (q' - q), A) from t = 1 to 0; the guess x solves LCP(q', A) with q' = w - A x."""
    problem, x = search.problem, np.maximum(guess.x, 0.0)
    w = np.where(x > 0.0, 0.0, np.maximum(guess.w, 0.0))
    return from_nearby(search, w - problem.w(x), x > 0.0) is not None


def from_nearby(search: Search, d: Array, active: Mask | None) -> Mask | None:
    """Pivot from t = 1, whose solution has this active set, or from infinity; return the last basis if it solves.

    References
    ----------
    Cottle, Pang and Stone, section 4.5.
    """
    problem = search.problem
    assert isinstance(problem, LCP)
    path = covering(problem, d, active) if np.isfinite(d).all() else None
    if path is None or path.run(most_pivots(problem.n)) is not Ended.REACHED:
        return None
    return path.active if search.settle(active_state(path.active)) else None


def constraints(problem: LCP) -> Mask:
    """The rows b - B x >= 0, b >= 0, of a quadratic program's optimality conditions, where d is zero.

    ``A = [[Q, B'], [-B, 0]]``. With t in the rows of Q alone, LCP(q + t d, A) is the program with cost c + t d; for
    large t and bounded x its only stationary point is x = 0 (Eaves, Management Science 17,
    1971).
    """
    rows: Mask = (problem.q >= 0.0) & (problem.A.diagonal() == 0.0)
    none = np.zeros_like(rows)
    if not rows.any():
        return none
    dense = problem.A.toarray() if problem.sparse else problem.A
    signs = np.sign(dense[rows])
    rows[rows] = (signs == -np.sign(dense[:, rows].T)).all(axis=1) & signs.any(axis=1)
    return rows if not dense[np.ix_(rows, rows)].any() else none
