"""Problems that outsiders brought, on which `lcp.solve` was not tuned: how many are decided, in which time.

    python examples/benchmarks/outside.py [NUMBER] [SEED] [FAMILY ...] [--limit S] [--homotopy NAME]

Milliseconds of the processor, reading A and q left out; a problem that is not decided in the limit is "late". Another
checkout is measured with that in PYTHONPATH.
"""

import math
import signal
import sys
from collections.abc import Callable
from functools import partial

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
from bodies import arches, piles, stacks
from campaign import Campaign, Verdict, asked, drawn, timed
from scipy.optimize import linprog

from continuation import Budget
from continuation.arrays import Array
from problems import lcp
from problems.lcp import LCP
from problems.scenes.game import bimatrix


def box_qp(k: int, r: np.random.Generator) -> tuple[Array, Array]:
    """An indefinite Q of integers up to 50, and c, of the program min x'Qx/2 + c'x over 0 <= x <= 1, n = 20 to 100."""
    n, density = ((20, 1.0), (30, 0.6), (50, 0.5), (100, 0.25))[k % 4]
    Q = np.triu(r.integers(-50, 51, (n, n)) * (r.random((n, n)) < density)).astype(float)
    return Q + np.triu(Q, 1).T, r.integers(-50, 51, n).astype(float)


def boxes(k: int, r: np.random.Generator) -> lcp.Program:
    """With bounds, as a program."""
    return lcp.from_qp(*box_qp(k, r), lower=0.0, upper=1.0)


def optimality(k: int, r: np.random.Generator) -> LCP:
    """With multipliers, as an LCP."""
    (Q, c), one = box_qp(k, r), np.eye((20, 30, 50, 100)[k % 4])
    return LCP(np.block([[Q, one], [-one, 0.0 * one]]), np.append(c, np.ones(len(c))))


def collapse(k: int, r: np.random.Generator) -> LCP:
    """An elastic, perfectly plastic truss, loaded beyond what it can carry: multipliers of both yield limits."""
    bars = (6, 10, 16, 25)[k % 4]
    B, E = r.standard_normal((bars // 2, bars)), np.diag(r.uniform(1.0, 3.0, bars))
    load, limit = r.standard_normal(bars // 2), r.uniform(0.5, 1.5, bars)
    elastic = E @ B.T @ np.linalg.inv(B @ E @ B.T)
    S = E - elastic @ B @ E
    # The largest multiple of the load with stresses in equilibrium within the limits.
    program = linprog(np.append(np.zeros(bars), -1.0), A_eq=np.column_stack([B, -load]), b_eq=np.zeros(bars // 2),
                      bounds=[*zip(-limit, limit), (0.0, None)])  # fmt: skip
    N = np.column_stack([np.eye(bars), -np.eye(bars)])
    factor = program.x[-1] * (1.02, 1.5)[k % 2]
    return LCP(N.T @ S @ N, np.append(limit, limit) - N.T @ (elastic @ load) * factor)


def unsolvable(k: int, r: np.random.Generator) -> LCP:
    """Feasible, without a solution, n <= 12: two unknowns that have none beside others that do, in random order."""
    while True:
        A, q = r.integers(-2, 3, (2, 2)).astype(float), r.integers(-2, 3, 2).astype(float)
        feasible = linprog(np.zeros(2), A_ub=-A, b_ub=q).status == 0
        if feasible and not lcp.solve_by_enumeration(LCP(A, q)).solvable:
            break
    n = int(r.integers(3, 13))
    G, order = r.standard_normal((n - 2, n - 2)), r.permutation(n)
    whole = sl.block_diag(A, G @ G.T / n + 0.5 * np.eye(n - 2))
    return LCP(whole[np.ix_(order, order)], np.append(q, r.standard_normal(n - 2))[order])


def unit_vectors(Y: Array, r: np.random.Generator) -> tuple[Array, Array]:
    """Each column of the one player's costs has one entry; the other's are uniform."""
    m = len(Y)
    Y = -r.random((m, m))
    return -np.eye(m)[:, r.integers(0, m, m)], Y


def dual_cyclic(Y: Array, r: np.random.Generator) -> tuple[Array, Array]:
    """Costs from two polytopes on the moment curve."""
    m = len(Y)
    V = np.vander(np.linspace(-1.0, 1.0, 2 * m), m + 1, increasing=True)[:, 1:]
    V = V - V.mean(axis=0)
    return -V[m:], -V[:m][r.permutation(m)].T


KINDS: dict[str, Callable[[Array, Array, np.random.Generator], tuple[Array, Array]]] = {
    "normal": lambda X, Y, r: (X, Y),
    "0-1": lambda X, Y, r: ((X < 0.0).astype(float), (Y < 0.0).astype(float)),
    **{
        f"covariant {rho}": lambda X, Y, r, rho=rho: (X, rho * X + math.sqrt(1.0 - rho * rho) * Y)
        for rho in (-0.9, 0.5)
    },
    "zero-sum": lambda X, Y, r: (X, -X),
    "unit vectors": lambda X, Y, r: unit_vectors(Y, r),
    "dual cyclic": lambda X, Y, r: dual_cyclic(Y, r),
    "uniform": lambda X, Y, r: tuple(r.random((2, *X.shape))),
}


def game_of(kind: str, m: int, r: np.random.Generator) -> LCP:
    """A game with m actions a player, of one of `KINDS`, made of normal costs."""
    X, Y = KINDS[kind](*r.standard_normal((2, m, m)), r)
    return bimatrix(X - X.min() + 1.0, Y - Y.min() + 1.0)


def games(k: int, r: np.random.Generator, actions: tuple[int, ...] = (20, 50, 150)) -> LCP:
    """Games of all kinds, n = 40, 100, 300."""
    return game_of([*KINDS][k % 8], actions[k // 8 % len(actions)], r)


STREETS = (
    "1-2 1-3 2-6 3-4 3-12 4-5 4-11 5-6 5-9 6-8 7-8 7-18 8-9 8-16 9-10 10-11 10-15 10-16 10-17 11-12 11-14 12-13 13-24 "
    "14-15 14-23 15-19 15-22 16-17 16-18 17-19 18-20 19-20 20-21 20-22 21-22 21-24 22-23 23-24"
)
"""The network of Sioux Falls: 24 crossings (LeBlanc, Morlok and Pierskalla, Transportation Research 9, 1975)."""


def traffic(destinations: int, r: np.random.Generator) -> LCP:
    """Wardrop's equilibrium on that network, each street both ways, with linear delays and demands at random.

    Unknowns: the flow to each destination on each street, and the time from each crossing to each destination.
    """
    there = np.array([[int(place) - 1 for place in street.split("-")] for street in STREETS.split()])
    begin, end = np.concatenate([there, there[:, ::-1]]).T
    k = begin.size
    empty = np.tile(r.integers(2, 11, k // 2), 2).astype(float)
    slope = 0.6 * empty / np.tile(r.uniform(4.8, 26.0, k // 2), 2)
    one, street = np.ones(k), np.arange(k)
    whole = sp.csr_array((np.concatenate([one, -one]), (np.concatenate([begin, end]), np.tile(street, 2))))
    N = sp.block_diag([whole[np.arange(24) != goal] for goal in range(destinations)])
    loads = sp.kron(np.ones((destinations, destinations)), sp.diags_array(slope))
    A = sp.csr_array(sp.block_array([[loads, -N.T], [N, None]]))
    return LCP(A, np.concatenate([np.tile(empty, destinations), -r.uniform(0.1, 2.0, 23 * destinations)]))


def planted(A: Array, r: np.random.Generator) -> LCP:
    """With a q that has a solution."""
    x, w = r.uniform(0.1, 2.0, (2, A.shape[0]))
    support = r.random(A.shape[0]) < 0.5
    return LCP(A, np.where(support, 0.0, w) - A @ np.where(support, x, 0.0))


def gaussian(k: int, r: np.random.Generator) -> LCP:
    """Neither monotone nor P, n = 100, 300, 600."""
    n = (100, 300, 600)[k % 3]
    return planted(r.standard_normal((n, n)) / math.sqrt(n), r)


def nonmonotone(k: int, r: np.random.Generator) -> LCP:
    """Cauchy, n = 30; -1, 0 and 1; Hankel; rows and columns in units; symmetric integers, n = 100; sparse, n = 200."""
    n = (30, 100, 100, 100, 100, 200)[k % 6]
    X, unit = r.standard_normal((n, n)), 10.0 ** r.uniform(-4.0, 4.0, (2, n))
    A = (
        r.standard_cauchy((n, n)), r.integers(-1, 2, (n, n)) * 1.0, sl.hankel(X[0], X[1]),
        unit[0][:, None] * X * unit[1], np.rint(2.0 * (X + X.T)), sp.csr_array(X * (r.random((n, n)) < 0.05)),
    )[k % 6]  # fmt: skip
    return planted(A, r)


Problem = LCP | lcp.MixedLCP | lcp.Program


FAMILIES = {
    make.__name__: drawn(make)
    for make in (boxes, optimality, collapse, unsolvable, games, gaussian, nonmonotone, stacks, arches, piles)
} | {
    "large games": drawn(partial(games, actions=(500,))),
    "traffic": drawn(lambda k, r: traffic((6, 12, 24)[k % 3], r)),
}  # fmt: skip


def late(*_: object) -> None:
    """Ends a solve at the limit."""
    raise TimeoutError


def measured(problem: Problem, limit: float, homotopy: str = "auto") -> Verdict:
    """The outcome, and milliseconds of the processor, the least of three below 50; "late" at the limit of that time."""
    signal.signal(signal.SIGPROF, late)

    def solved() -> str:
        signal.setitimer(signal.ITIMER_PROF, limit)
        try:
            return lcp.solve(problem, homotopy, budget=Budget(steps=math.inf)).outcome.name
        except TimeoutError:
            return "late"
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)

    outcome, seconds = timed(solved)
    if seconds <= 0.05:
        seconds = min(seconds, timed(solved, 2)[1])
    return outcome, 1e3 * seconds


if __name__ == "__main__":
    names, numbers, options = asked(24, 2026, limit=10.0, homotopy="auto")
    ways = {options.homotopy: options.homotopy}
    campaign = Campaign(FAMILIES, lambda case, way: measured(case, options.limit, way), ways, "ms")
    sys.exit(campaign.run(*numbers, names))
