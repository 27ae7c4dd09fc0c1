"""KKT points of quadratic functions that are not convex, over [0, 1]^n: integers from -50 to 50, three densities.

    python examples/benchmarks/mixed/nonconvex.py [rows]

With `rows` there are rows as well, two thirds of them with two sides, and two equations, all around a point in the box.
"""

import sys
import time

import numpy as np

from problems import lcp

NUMBER = 20


def problem(rng, n, rows, density):
    P = np.triu(rng.integers(-50, 51, (n, n)) * (rng.random((n, n)) < density)).astype(float)
    P, c = P + np.triu(P, 1).T, rng.integers(-50, 51, n).astype(float)
    if not rows:
        return lcp.from_qp(P, c, lower=0, upper=1)
    G, B, x = rng.integers(-5, 6, (rows, n)).astype(float), rng.integers(-3, 4, (2, n)).astype(float), rng.random(n)
    low, high = G @ x - rng.integers(0, 10, rows), G @ x + rng.integers(1, 10, rows)
    high[::3] = np.inf
    return lcp.from_qp(P, c, G, high, B, B @ x, 0, 1, rows_lower=low)


def main(kind="box"):
    rng = np.random.default_rng(0)
    print("n, rows, density: solved, seconds at most, mean, factorisations at most, paths, largest natural residual")
    for n in (20, 50, 100):
        for rows in (0,) if kind == "box" else (5, n // 2):
            for density in (1.0, 0.5, 0.2):
                seconds, solved, work, paths, residuals = [], 0, 0, 0, []
                for _ in range(NUMBER):
                    program = problem(rng, n, rows, density)
                    began = time.process_time()
                    solution = lcp.solve(program)
                    seconds.append(time.process_time() - began)
                    solved += solution.success
                    paths += len(solution.paths)
                    work = max(work, solution.counts.factorizations)
                    residuals.append(solution.residual)
                took = f"{max(seconds):.2f}, {np.mean(seconds):.3f}"
                print(f"{n}, {rows}, {density}: {solved} of {NUMBER}, {took}, {work}, {paths}, {max(residuals):.1e}",
                      flush=True)  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
