"""Large games, traffic, random problems that are neither monotone nor P, indefinite programs in boxes; and quantecon.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/size/hard.py [TABLE ...] [--seeds K] [--size F] [--patience P]

Times are processor seconds, and so are the limits: a search has P times as many of the clock, for a machine that has
other work too.
"""

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp

sys.path.insert(0, str(Path(__file__).parents[1] / "lcp"))
from generators import random_planted
from outside import KINDS, Data, game_of, planted

from continuation.arrays import Array
from continuation.budget import Budget
from problems import lcp
from problems.lcp import LCP

STREETS = (
    "1-2 1-3 2-6 3-4 3-12 4-5 4-11 5-6 5-9 6-8 7-8 7-18 8-9 8-16 9-10 10-11 10-15 10-16 10-17 11-12 11-14 12-13 13-24 "
    "14-15 14-23 15-19 15-22 16-17 16-18 17-19 18-20 19-20 20-21 20-22 21-22 21-24 22-23 23-24"
)
"""The network of Sioux Falls: 24 crossings (LeBlanc, Morlok and Pierskalla, Transportation Research 9, 1975)."""


def traffic(destinations: int, seed: int) -> tuple[sp.csr_array, Array]:
    """Wardrop's equilibrium on that network, each street both ways, with linear delays and demands at random.

    Unknowns: the flow to each destination on each street, and the time from each crossing to each destination.
    """
    r = np.random.default_rng(seed)
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
    return A, np.concatenate([np.tile(empty, destinations), -r.uniform(0.1, 2.0, 23 * destinations)])


def seconds(call: Callable[..., Any], *given: Any, **options: Any) -> tuple[Any, float]:
    """What a call returns, and its processor time."""
    began = time.process_time()
    found = call(*given, **options)
    return found, time.process_time() - began


def games(seeds: int, size: float, patience: float) -> None:
    """Bimatrix games beside quantecon's Lemke-Howson with 200,000 pivots, 60 s each."""
    theory = import_module("quantecon.game_theory") if find_spec("quantecon") else None
    for n in (100, 300, 1000):
        m = max(int(0.5 * size * n), 2)
        for k, kind in enumerate(KINDS):
            ours: list[float] = []
            theirs: list[float] = []
            for seed in range(seeds):
                A, q = game_of(kind, m, np.random.default_rng([978, n, k, seed]))
                found, taken = seconds(lcp.solve, LCP(A, q), budget=Budget(seconds=60.0 * patience))
                ours += [taken] if found.solved and taken <= 60.0 else []
                if theory is not None:
                    one = theory.NormalFormGame([theory.Player(-A[:m, m:]), theory.Player(-A[m:, :m])])
                    theory.lemke_howson(one, max_iter=2)
                    (_, said), taken = seconds(theory.lemke_howson, one, max_iter=200_000, full_output=True)
                    theirs += [taken] if said.converged else []
            beside = f"; quantecon {told(theirs, seeds)}" if theory is not None else ""
            print(f"{kind}, n = {2 * m}: {told(ours, seeds)}{beside}", flush=True)


def told(times: list[float], seeds: int) -> str:
    """How many were solved, and in which time."""
    if not times:
        return f"0 of {seeds}"
    return f"{len(times)} of {seeds}, median {np.median(times):.4f} s, most {max(times):.4f} s"


def streets(seeds: int, size: float, patience: float) -> None:
    """Traffic with 6, 12 and 24 destinations beside quantecon's Lemke."""
    optimize = import_module("quantecon.optimize") if find_spec("quantecon") else None
    for destinations in (6, 12, 24):
        for seed in range(seeds):
            A, q = traffic(max(int(size * destinations), 1), seed)
            found, taken = seconds(lcp.solve, LCP(A, q), budget=Budget(seconds=300.0 * patience))
            line = f"n = {q.size}: {found.outcome.name}, {taken:.2f} s, residual {found.relative_residual:.0e}"
            if optimize is not None:
                optimize.lcp_lemke(np.eye(2), -np.ones(2))
                other, theirs = seconds(optimize.lcp_lemke, A.toarray(), q, max_iter=100_000)
                line += f"; quantecon {other.success}, {theirs:.2f} s, ratio {taken / theirs:.2f}"
            print(line, flush=True)


def _integers(n: int, r: np.random.Generator, A: Array) -> Data:
    """With a planted solution of integers."""
    x, w = r.integers(1, 6, (2, n)).astype(float)
    support = r.random(n) < 0.5
    return A.astype(float), np.where(support, 0.0, w) - A @ np.where(support, x, 0.0)


def _scaled(n: int, r: np.random.Generator) -> Data:
    A, q = planted(r.standard_normal((n, n)) / np.sqrt(n), r)
    rows, columns = 10.0 ** r.uniform(-4.0, 4.0, (2, n))
    return rows[:, None] * A * columns, rows * q


def _symmetric(n: int, r: np.random.Generator) -> Data:
    A = r.integers(-5, 6, (n, n))
    return _integers(n, r, np.triu(A) + np.triu(A, 1).T)


RANDOM: dict[str, tuple[int, float, Callable[[int, np.random.Generator], Data]]] = {
    "Cauchy": (30, 60.0, lambda n, r: planted(r.standard_cauchy((n, n)), r)),
    "ternary": (100, 60.0, lambda n, r: _integers(n, r, r.integers(-1, 2, (n, n)))),
    "Hankel": (100, 60.0, lambda n, r: planted(sl.hankel(*r.standard_normal((2, n))), r)),
    "rows and columns times 1e-4..1e4": (100, 60.0, _scaled),
    "symmetric integers": (100, 60.0, _symmetric),
}


def _each(seeds: int, size: float) -> Iterator[tuple[str, float, list[LCP]]]:
    first = 3000
    for n, limit in ((100, 5.0), (300, 60.0), (600, 300.0)):
        order = max(int(size * n), 3)
        yield f"Gaussian, n = {order}", limit, [random_planted(order, first + seed) for seed in range(seeds)]
    for name, (n, limit, make) in RANDOM.items():
        order = max(int(size * n), 3)
        problems = [LCP(*make(order, np.random.default_rng([979, n, seed]))) for seed in range(seeds)]
        yield f"{name}, n = {order}", limit, problems


def nonmonotone(seeds: int, size: float, patience: float) -> None:
    """Random problems that are neither monotone nor P, with a planted solution."""
    for name, limit, problems in _each(seeds, size):
        times = []
        for problem in problems:
            found, taken = seconds(lcp.solve, problem, budget=Budget(seconds=limit * patience))
            times += [taken] if found.solved and taken <= limit else []
        print(f"{name}: {told(times, seeds)} (limit {limit:.0f} s)", flush=True)


def boxes(seeds: int, size: float, patience: float) -> None:
    """Min x'Qx/2 + c'x over 0 <= x <= 1, half of Q zero, integers up to 50: with bounds, and as LCPs."""
    for order in (20, 50, 100):
        n = max(int(size * order), 2)
        times: dict[str, list[float]] = {"with bounds": [], "as an LCP": []}
        for seed in range(seeds):
            r = np.random.default_rng([981, order, seed])
            Q = np.triu(r.integers(-50, 51, (n, n)) * (r.random((n, n)) < 0.5)).astype(float)
            Q, c, one = Q + np.triu(Q, 1).T, r.integers(-50, 51, n).astype(float), np.eye(n)
            plain = LCP(np.block([[Q, one], [-one, 0.0 * one]]), np.append(c, np.ones(n)))
            for kind, problem in zip(times, (lcp.from_qp(Q, c, lower=0.0, upper=1.0), plain)):
                found, taken = seconds(lcp.solve, problem, budget=Budget(seconds=5.0 * patience))
                times[kind] += [taken] if found.solved and taken <= 5.0 else []
        for kind, solved in times.items():
            print(f"box, n = {n}, {kind}: {told(solved, seeds)} (limit 5 s)", flush=True)


TABLES = {"games": games, "traffic": streets, "nonmonotone": nonmonotone, "boxes": boxes}


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tables", nargs="*", default=[], choices=[*TABLES, []])
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--size", type=float, default=1.0, help="times the orders")
    parser.add_argument("--patience", type=float, default=1.0)
    arguments = parser.parse_args()
    for name, table in TABLES.items():
        if not arguments.tables or name in arguments.tables:
            print(f"-- {name}: {table.__doc__}")
            table(arguments.seeds, arguments.size, arguments.patience)


if __name__ == "__main__":
    main()
