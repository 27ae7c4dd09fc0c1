"""Few large problems: obstacles, torsion and a put in two assets beside cvxopt, with each way to factor that is there.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/size/large.py [--size 316] [--against CHECKOUT]

Each solve has a process of its own, and they take turns; the least processor time counts. Memory is the most that a
process held, with Python, numpy and the problem itself.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path as File
from typing import Any

import numpy as np
import scipy.sparse as sp

sys.path.insert(0, str(File(__file__).parents[1] / "lcp"))
from generators import obstacle_2d

from problems import lcp
from problems.lcp import LCP, MixedLCP

HERE = str(File(__file__).resolve().parents[3])


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


def by_cvxopt(problem: MixedLCP) -> np.ndarray:
    """Its interior-point method for quadratic programs, which factors by CHOLMOD."""
    from cvxopt import matrix, solvers, spmatrix

    entries = sp.coo_array(problem.A)
    P = spmatrix(entries.data, entries.row.astype(int), entries.col.astype(int), entries.shape)
    n, above = problem.n, np.isfinite(problem.lower).all()
    G = spmatrix(-1.0 if above else 1.0, range(n), range(n))
    h = matrix(-problem.lower if above else problem.upper)
    solvers.options.update(show_progress=False, abstol=1e-10, reltol=1e-10, feastol=1e-10)
    x = np.array(solvers.qp(P, matrix(problem.q), G, h)["x"]).ravel()
    return problem.clipped(x)


def measured(row: str, m: int, way: str) -> dict[str, Any]:
    """One solve in numbers."""
    problem = ROWS[row](m)
    if way == "cvxopt":
        import cvxopt.solvers  # noqa: F401
    elif way == "amg":
        import pyamg  # noqa: F401
    began = time.process_time()
    if way == "cvxopt":
        x, said = by_cvxopt(problem), ""
        seconds, number = time.process_time() - began, 0
    else:
        found = lcp.solve(problem, **({} if way == "given" else {"sparse": way}))
        seconds = time.process_time() - began
        assert found.solved, found.message
        x, number = found.x, found.counts.factorizations
        said = found.message.partition("Sparse factorisations: ")[2].partition(". In")[0]
    end = lcp.certify(problem, x)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    answer = {"n": problem.n, "seconds": seconds, "residual": end.relative_residual, "natural": end.residual}
    return answer | {"memory": memory, "factorisations": number, "said": said}


def asked(checkout: str, *arguments: str) -> dict[str, Any]:
    """The same in a process of its own."""
    environment = os.environ | {"PYTHONPATH": checkout, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, __file__, "--measure", *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def main() -> None:
    """Print a line for each row and way."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rows", nargs="*", default=list(ROWS))
    parser.add_argument("--size", type=int, default=316)
    parser.add_argument("--against", help="another checkout")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--ways", nargs="*", help="superlu, cholmod, amg, pardiso, auto, cvxopt")
    parser.add_argument("--measure", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure:
        row, m, way = arguments.measure
        print(json.dumps(measured(row, int(m), way)))
        return
    there = {"cholmod": "cvxopt", "amg": "pyamg", "cvxopt": "cvxopt"}
    ways = arguments.ways or ["superlu", *(way for way, name in there.items() if find_spec(name)), "auto"]
    runs = [(HERE, way) for way in ways] + ([(arguments.against, "given")] if arguments.against else [])
    for row in arguments.rows:
        best: dict[tuple[str, str], dict[str, Any]] = {}
        for _ in range(arguments.rounds):
            for run in runs:
                new = asked(run[0], row, str(arguments.size), run[1])
                best[run] = min(best.get(run, new), new, key=lambda one: one["seconds"])
        rival = best.get((HERE, "cvxopt"))
        print(f"-- {row}, n = {next(iter(best.values()))['n']}")
        for (_, way), one in best.items():
            ratio = f", {one['seconds'] / rival['seconds']:.2f} of cvxopt" if rival is not None else ""
            name = "the other checkout" if way == "given" else way
            print(
                f"{name}: {one['seconds']:.2f} s{ratio}, relative residual {one['residual']:.0e}, "
                f"natural {one['natural']:.0e}, {one['memory']:.0f} MiB; {one['factorisations']} factorisations: "
                f"{one['said']}",
                flush=True,
            )


if __name__ == "__main__":
    main()
