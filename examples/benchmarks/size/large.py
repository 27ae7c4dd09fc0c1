"""Few large problems: an obstacle, torsion and a put in two assets, with one of the ways to factor.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/size/large.py obstacle [--size 316] [--way cholmod]

Memory is the most that the process held, with Python, numpy and the problem itself.
"""

import argparse
import resource
import sys
import time
from pathlib import Path as File
from typing import Any

import numpy as np
import scipy.sparse as sp

sys.path.insert(0, str(File(__file__).parents[1] / "lcp"))
from generators import obstacle_2d

from problems import lcp
from problems.lcp import LCP, MixedLCP


def torsion(m: int) -> MixedLCP:
    """A bar that yields, an eighth of its section, of about m x m unknowns: with upper bounds."""
    from problems.scenes.torsion import Torsion

    return Torsion(n=int(np.sqrt(2.0) * m)).problem()


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


ROWS = {"obstacle": obstacle_2d, "torsion": torsion, "put": put}


def measured(row: str, m: int, way: str) -> dict[str, Any]:
    """One solve in numbers."""
    problem = ROWS[row](m)
    began = time.process_time()
    found = lcp.solve(problem, sparse=way)
    seconds = time.process_time() - began
    assert found.solved, found.message
    end = lcp.certify(problem, found.x)
    said = found.message.partition("Sparse factorisations: ")[2].partition(". In")[0]
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    answer = {"n": problem.n, "seconds": seconds, "residual": end.relative_residual, "natural": end.residual}
    return answer | {"memory": memory, "factorisations": found.counts.factorizations, "said": said}


def main() -> None:
    """Print a line for a row and a way."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("row", choices=[*ROWS])
    parser.add_argument("--size", type=int, default=316)
    parser.add_argument("--way", default="auto", help="superlu, cholmod, auto")
    arguments = parser.parse_args()
    for name, value in measured(arguments.row, arguments.size, arguments.way).items():
        print(f"{name}: {value}")


if __name__ == "__main__":
    main()
