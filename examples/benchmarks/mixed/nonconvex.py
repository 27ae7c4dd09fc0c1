"""KKT points of quadratic functions that are not convex, over [0, 1]^n: integers from -50 to 50, three densities.

    python examples/benchmarks/mixed/nonconvex.py
"""

import time

import numpy as np

from problems import lcp

NUMBER = 20


def main():
    rng = np.random.default_rng(0)
    print("n, density: solved, seconds at most, mean, factorisations at most, largest natural residual")
    for n in (20, 50, 100):
        for density in (1.0, 0.5, 0.2):
            seconds, solved, work, residuals = [], 0, 0, []
            for _ in range(NUMBER):
                P = np.triu(rng.integers(-50, 51, (n, n)) * (rng.random((n, n)) < density)).astype(float)
                P, c = P + np.triu(P, 1).T, rng.integers(-50, 51, n).astype(float)
                began = time.perf_counter()
                solution = lcp.solve(lcp.from_qp(P, c, lower=0, upper=1))
                seconds.append(time.perf_counter() - began)
                solved += solution.success
                work = max(work, solution.counts.factorizations)
                residuals.append(solution.residual)
            print(
                f"{n}, {density}: {solved} of {NUMBER}, {max(seconds):.2f}, {np.mean(seconds):.3f}, {work}, "
                f"{max(residuals):.1e}", flush=True,
            )


if __name__ == "__main__":
    main()
