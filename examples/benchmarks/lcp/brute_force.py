"""Every claim of `lcp.solve` on random small problems, against enumeration of all faces in exact arithmetic.

    python examples/benchmarks/lcp/brute_force.py [NUMBER] [SEED]

Prints what was claimed, and every false claim or exception; the exit status is their number (at most 1).
"""

from __future__ import annotations

import sys
import time
from collections import Counter

import numpy as np

from problems import lcp

KINDS = ("dense", "sparse entries", "symmetric", "semidefinite", "skew plus diagonal", "nonnegative", "Z", "singular")


def random_problem(r: np.random.Generator) -> tuple[str, lcp.LCP]:
    """A problem with integer entries, n = 1 .. 5, of one of several kinds."""
    n = int(r.integers(1, 6))
    kind = KINDS[int(r.integers(len(KINDS)))]
    A = r.integers(-3, 4, (n, n))
    if kind == "sparse entries":
        A = A * (r.random((n, n)) < 0.4)
    elif kind == "symmetric":
        A = np.triu(A) + np.triu(A, 1).T
    elif kind == "semidefinite":
        A = A @ A.T
    elif kind == "skew plus diagonal":
        A = np.triu(A, 1) - np.triu(A, 1).T + np.diag(r.integers(0, 3, n))
    elif kind == "nonnegative":
        A = np.abs(A)
    elif kind == "Z":
        A = np.diag(r.integers(0, 6, n)) - np.abs(A) * (1 - np.eye(n, dtype=int))
    elif kind == "singular":
        A[:, -1] = A[:, 0]
    # Mostly with a planted solution, often a degenerate one; else q at random, where half have none.
    q = r.integers(-3, 4, n)
    if r.random() < 0.6:
        support = r.random(n) < 0.5
        x = np.where(support, r.integers(0, 4, n), 0)
        q = np.where(support, 0, r.integers(0, 3, n)) - A @ x
    return kind, lcp.LCP(A, q)


def main(number: int, seed: int) -> int:
    """Run and report."""
    r = np.random.default_rng(seed)
    claims: Counter[str] = Counter()
    missed: Counter[str] = Counter()
    wrong = 0
    began = time.perf_counter()
    for k in range(number):
        kind, problem = random_problem(r)
        try:
            solution = lcp.solve(problem, restarts=0 if k % 20 else 3)
        except Exception as error:
            wrong += 1
            print(f"EXCEPTION {type(error).__name__}: {error}\nA = {problem.A.tolist()}\nq = {problem.q.tolist()}")
            continue
        solvable = lcp.solve_by_enumeration(problem).solvable
        claims[solution.outcome.name] += 1
        solved = solution.outcome is lcp.Outcome.SOLVED
        if (solved and not solvable) or (solution.outcome is lcp.Outcome.UNSOLVABLE and solvable):
            wrong += 1
            where = f"A = {problem.A.tolist()}\nq = {problem.q.tolist()}\nx = {solution.x}"
            print(f"FALSE {solution.outcome.name}\n{where}")
        if solvable and not solved:
            missed[kind] += 1
    print(f"{number} problems, seed {seed}, {time.perf_counter() - began:.0f} s: {wrong} false claims or exceptions")
    print("claims", dict(claims))
    print("solvable but not solved (most without restarts)", sum(missed.values()), dict(missed))
    return min(wrong, 1)


if __name__ == "__main__":
    arguments = [int(a) for a in sys.argv[1:]]
    sys.exit(main(*(arguments + [100_000, 0][len(arguments) :])))
