"""Many small LCPs: `lcp.solve_many` beside a loop over quantecon's Lemke, and whether it agrees with `lcp.solve`.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/size/run.py [TABLE ...] [--number K]

quantecon (numba) is compared with where it is installed. Times are processor seconds.
"""

import argparse
import time
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np

from continuation.arrays import Array
from problems import lcp
from problems.lcp import LCP, Outcome

Stack = tuple[Array, Array]


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


KINDS: tuple[Callable[[int, int, np.random.Generator], Stack], ...] = (
    p_matrices, p0_matrices, indefinite, unsolvable, degenerate, badly_scaled,
)  # fmt: skip


def together(number: int) -> None:
    """Microseconds each, certified, beside a loop over quantecon's Lemke, which certifies nothing."""
    for n, k in ((5, number), (10, number // 4), (20, number // 10)):
        A, q = p_matrices(k, n, np.random.default_rng(n))
        began = time.process_time()
        found = lcp.solve_many(A, q)
        ours = (time.process_time() - began) / k
        line = f"n = {n}, {k} problems: {1e6 * ours:.1f} us each, {found.solved.sum()} certified, "
        line += f"{found.singly.size} one by one, relative residual {found.relative_residual.max():.0e}"
        if find_spec("quantecon"):
            from quantecon.optimize import lcp_lemke

            lcp_lemke(A[0], q[0])
            began = time.process_time()
            for matrix, constant in zip(A, q):
                lcp_lemke(matrix, constant)
            theirs = (time.process_time() - began) / k
            line += f"; quantecon's Lemke {1e6 * theirs:.1f} us, ratio {ours / theirs:.2f}"
        sample = min(k, 300)
        began = time.process_time()
        for matrix, constant in zip(A[:sample], q):
            lcp.solve(LCP(matrix, constant))
        print(f"{line}; `solve` {1e6 * (time.process_time() - began) / sample:.0f} us", flush=True)


def agreement(number: int) -> None:
    """Outcomes of six kinds of problems, n = 1 to 8 and 16, beside those of `solve`."""
    for make in KINDS:
        differ, singly, said = 0, 0, dict.fromkeys(Outcome, 0)
        k = max(number // 1000, 1)
        for n in (*range(1, 9), 16):
            if n == 16 and make not in (p_matrices, badly_scaled):
                continue
            A, q = make(k, n, np.random.default_rng([n, 1]))
            found = lcp.solve_many(A, q)
            singly += found.singly.size
            for i in range(k):
                outcome = Outcome(found.outcome[i])
                said[outcome] += 1
                one = lcp.solve(LCP(A[i], q[i]))
                if one.outcome is not outcome:
                    differ += 1
                    print(f"  {make.__name__}, n = {n}, problem {i}: {outcome.name}, `solve` {one.outcome.name}")
        counted = ", ".join(f"{count} {outcome.name}" for outcome, count in said.items() if count)
        print(f"{make.__name__}: {differ} differ; {counted}; {singly} one by one", flush=True)


TABLES = (together, agreement)


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tables", nargs="*", default=[], choices=[*(table.__name__ for table in TABLES), []])
    parser.add_argument("--number", type=int, default=100_000)
    arguments = parser.parse_args()
    for table in TABLES:
        if not arguments.tables or table.__name__ in arguments.tables:
            print(f"-- {table.__name__}: {table.__doc__}")
            table(arguments.number)


if __name__ == "__main__":
    main()
