"""Many small LCPs: `lcp.solve_many` beside a loop over quantecon's Lemke, and whether it agrees with `lcp.solve`.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/many.py [NUMBER] [KIND ...]

quantecon (numba) is compared with where it is installed. Times are processor seconds.
"""

import math
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
from campaign import WRONG, Campaign, Cases, Verdict, asked, timed

from continuation.arrays import Array
from problems import lcp
from problems.lcp import LCP, Outcome

Stack = tuple[Array, Array]
Kind = Callable[[int, int, np.random.Generator], Stack]


def p_matrices(k: int, n: int, r: np.random.Generator) -> Stack:
    """Positive definite, not symmetric."""
    G, S = r.normal(size=(2, k, n, n))
    return G @ G.transpose(0, 2, 1) / n + 0.1 * np.eye(n) + 0.5 * (S - S.transpose(0, 2, 1)), r.normal(size=(k, n))


def p0_matrices(k: int, n: int, r: np.random.Generator) -> Stack:
    """Semidefinite of half the rank plus skew, with a planted solution."""
    G, S = r.normal(size=(k, n, (n + 1) // 2)), r.normal(size=(k, n, n))
    A = G @ G.transpose(0, 2, 1) + (S - S.transpose(0, 2, 1)) * (r.random((k, 1, 1)) < 0.5)
    return planted(A, r)


def indefinite(k: int, n: int, r: np.random.Generator) -> Stack:
    """Gaussian with a planted solution, or without one."""
    A = r.normal(size=(k, n, n))
    return A, np.where(r.random((k, 1)) < 0.5, planted(A, r)[1], r.normal(size=(k, n)))


def unsolvable(k: int, n: int, r: np.random.Generator) -> Stack:
    """Gaussian with a row of negative entries and a negative q."""
    A, q = r.normal(size=(k, n, n)), r.normal(size=(k, n))
    i = np.arange(k), r.integers(0, n, k)
    A[i], q[i] = -np.abs(A[i]), -np.abs(q[i])
    return A, q


def degenerate(k: int, n: int, r: np.random.Generator) -> Stack:
    """Of small integers, with ties."""
    return r.integers(-2, 3, (k, n, n)).astype(float), r.integers(-2, 3, (k, n)).astype(float)


def badly_scaled(k: int, n: int, r: np.random.Generator) -> Stack:
    """P-matrices in units 10^-6 to 10^6 for each row and column."""
    A, q = p_matrices(k, n, r)
    rows, columns = 10.0 ** r.uniform(-6, 6, (2, k, n))
    return rows[:, :, None] * A * columns[:, None, :], rows * q


def planted(A: Array, r: np.random.Generator) -> Stack:
    """With a solution of which half is zero."""
    k, n = A.shape[:2]
    x, w, on = r.uniform(0.5, 2.0, (k, n)), r.uniform(0.5, 2.0, (k, n)), r.random((k, n)) < 0.5
    x *= on
    return A, np.where(on, 0.0, w) - (A @ x[:, :, None])[:, :, 0]


KINDS = p_matrices, p0_matrices, indefinite, unsolvable, degenerate, badly_scaled


def together(n: int, k: int) -> str:
    """Microseconds each, certified, beside a loop over quantecon's Lemke, which certifies nothing."""
    A, q = p_matrices(k, n, np.random.default_rng(n))
    found, ours = timed(lambda: lcp.solve_many(A, q))
    line = f"n = {n}, {k} problems: {1e6 * ours / k:.1f} us each, {found.solved.sum()} certified, "
    line += f"{found.singly.size} one by one, relative residual {found.relative_residual.max():.0e}"
    if find_spec("quantecon"):
        lemke = import_module("quantecon.optimize").lcp_lemke
        lemke(A[0], q[0])
        _, theirs = timed(lambda: [lemke(*one) for one in zip(A, q)])
        line += f"; quantecon's Lemke {1e6 * theirs / k:.1f} us, ratio {ours / theirs:.2f}"
    sample = min(k, 300)
    _, singly = timed(lambda: [lcp.solve(LCP(*one)) for one in zip(A[:sample], q)])
    return f"{line}; `solve` {1e6 * singly / sample:.0f} us"


def agreeing(make: Kind) -> Cases:
    """Problems of a kind, n = 1 to 8, each with the outcome that `solve_many` says."""

    def draw(number: int, seed: int) -> Iterator[tuple[LCP, Outcome]]:
        for n in range(1, 9):
            A, q = make(max(number // 8, 1), n, np.random.default_rng([n, seed]))
            yield from zip(map(LCP, A, q), map(Outcome, lcp.solve_many(A, q).outcome))

    return draw


def judge(case: tuple[LCP, Outcome], way: Any) -> Verdict:
    """Whether `solve` says the same."""
    outcome, one = case[1], lcp.solve(case[0]).outcome
    return outcome.name if one is outcome else f"{WRONG}: {outcome.name}, `solve` {one.name}", math.nan


CAMPAIGN = Campaign({kind.__name__: agreeing(kind) for kind in KINDS}, judge, {"": None})

if __name__ == "__main__":
    names, numbers, _ = asked()
    number = numbers[0] if numbers else 100_000
    for n, k in ((5, number), (10, number // 4), (20, number // 10)):
        print(together(n, k), flush=True)
    sys.exit(min(CAMPAIGN.run(max(number // 100, 8), 1, names), 1))
