"""Small problems with bounds, against all 3^n pieces in exact arithmetic: no outcome may be false.

python examples/benchmarks/mixed/pieces.py [number] [seed]
"""

import sys
import time
from collections import Counter

import numpy as np

from problems import lcp
from problems.lcp.reference.enumeration import exhaust


def random_problem(rng):
    """Integers, n <= 6, bounds of all kinds mixed; singular and infeasible problems among them."""
    n = int(rng.integers(1, 7))
    A, q = rng.integers(-3, 4, (n, n)).astype(float), rng.integers(-4, 5, n).astype(float)
    change = rng.random(4) < 0.3
    if change[0]:
        A[rng.integers(n)] = A[rng.integers(n)]
    if change[1]:
        A[:, rng.integers(n)] = 0.0
    if change[2]:
        A = A + A.T
    if change[3]:
        A = A @ A.T
    kind = rng.integers(0, 6, n)  # lower, box, upper, free, lower, fixed
    lower = np.where(np.isin(kind, [0, 1, 4, 5]), rng.integers(-2, 3, n), -np.inf)
    width = np.where(kind == 5, 0, rng.integers(0, 4, n))
    upper = np.where(np.isin(kind, [1, 5]), lower + width, np.where(kind == 2, rng.integers(-2, 3, n), np.inf))
    return lcp.MixedLCP(A, q, lower, upper)


def main(number=50_000, seed=0):
    rng, counts, false, began = np.random.default_rng(seed), Counter(), 0, time.perf_counter()
    for i in range(number):
        problem = random_problem(rng)
        solution = lcp.solve(problem)
        solvable = exhaust(problem).solvable
        counts[f"{solution.outcome.name}, {'solvable' if solvable else 'not solvable'}"] += 1
        wrong = solution.success != solvable or (solution.outcome is lcp.Outcome.UNSOLVABLE and solvable)
        if wrong:
            false += 1
            print("FALSE", repr(problem), solution.message)
        if (i + 1) % 10_000 == 0:
            print(i + 1, dict(counts), f"{time.perf_counter() - began:.0f} s", flush=True)
    print(f"{number} problems, {false} false outcomes, {dict(counts)}")
    return false


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])) > 0)
