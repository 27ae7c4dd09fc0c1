"""Few large problems: an obstacle, torsion and a put in two assets, with one of the ways to factor.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/large.py obstacle|torsion|put [--size 316] [--way cholmod]

Memory is the most that the process held, with Python, numpy and the problem itself.
"""

import resource
import sys

import numpy as np
import scipy.sparse as sp
from campaign import WRONG, Campaign, Verdict, asked, timed

from problems import lcp
from problems.bifurcation.bratu_2d import five_point
from problems.lcp import LCP, MixedLCP
from problems.scenes.torsion import Torsion


def obstacle_2d(m: int) -> LCP:
    """A membrane over a bump, five-point differences on m x m points."""
    A = five_point(m) * -((m + 1.0) ** 2)
    t = np.arange(1, m + 1) / (m + 1)
    obstacle = 0.3 - 3.0 * np.add.outer((t - 0.5) ** 2, (t - 0.5) ** 2).ravel()
    return LCP(A, A @ obstacle + 5.0)


def put(m: int) -> LCP:
    """An American put on the mean of two assets, one implicit step of a tenth of a year, in log-prices, m x m points.

    Rows are weighted by exp(2 x'C^-1 b), b the drift and C the covariance, which makes the matrix symmetric.
    """
    rate, sigma, correlation, step, reach = 0.05, np.array([0.2, 0.3]), 0.3, 0.1, 1.5
    C = np.outer(sigma, sigma) * np.array([[1.0, correlation], [correlation, 1.0]])
    tilt = 2.0 * np.linalg.solve(C, rate - 0.5 * sigma**2)
    t, h = np.linspace(-reach, reach, m + 2, retstep=True)
    X, Y = np.meshgrid(t, t, indexing="ij")
    number, weight = np.arange(X.size).reshape(X.shape), np.exp(tilt[0] * X + tilt[1] * Y)
    A = sp.csr_array((X.size, X.size))
    cross = C[0, 1]
    for (i, j), size in zip(((1, 0), (0, 1), (1, 1)), (C[0, 0] - cross, C[1, 1] - cross, cross)):
        a, b = (slice(0, m + 2 - i), slice(0, m + 2 - j)), (slice(i, None), slice(j, None))
        between = 0.5 * size / h**2 * np.sqrt(weight[a] * weight[b]).ravel()
        one, other = number[a].ravel(), number[b].ravel()
        edges = sp.coo_array((between, (one, other)), shape=A.shape)
        sums = np.bincount(one, between, A.shape[0]) + np.bincount(other, between, A.shape[0])
        A = A + sp.diags_array(sums) - edges - edges.T
    held = sp.diags_array((weight * (rate + 1.0 / step)).ravel())
    payoff = np.maximum(1.0 - 0.5 * (np.exp(X) + np.exp(Y)), 0.0).ravel()
    inner = number[1:-1, 1:-1].ravel()
    A = sp.csr_array(A + held)
    return LCP(A[inner][:, inner], (A @ payoff - weight.ravel() / step * payoff)[inner])


ROWS = {
    "obstacle": obstacle_2d,
    # A bar that yields, an eighth of its section, of about m x m unknowns: with upper bounds.
    "torsion": lambda m: Torsion(n=int(np.sqrt(2.0) * m)).problem(),
    "put": put,
}


def judge(problem: MixedLCP, way: str) -> Verdict:
    """One solve in numbers, and its seconds."""
    found, seconds = timed(lambda: lcp.solve(problem, sparse=way))
    end, counts = lcp.certify(problem, found.x), found.counts.factorizations
    said = found.message.partition("Sparse factorisations: ")[2].partition(". In")[0]
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    fault = "" if found.solved else f"{WRONG}: {found.outcome.name}, "
    return f"{fault}n {problem.n}, residual {end.relative_residual:.0e}, natural {end.residual:.0e}, {counts} " \
           f"factorisations: {said}; {memory:.0f} MiB", seconds  # fmt: skip


if __name__ == "__main__":
    rows, _, options = asked(size=316, way="auto")
    families = {name: lambda number, seed, make=make: [make(options.size)] for name, make in ROWS.items()}
    sys.exit(Campaign(families, judge, {options.way: options.way}, "seconds").run(1, 0, rows))
