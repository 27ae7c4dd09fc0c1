"""Random quadratic programs in the box [-1, 1]^n: time and natural residual of `lcp.solve` and of its rivals.

    python examples/benchmarks/mixed/programs.py [SEEDS]

PIQP, Clarabel and L-BFGS-B, those that are installed, take turns with ours; the least of five processor times counts.
"""

import sys
import time

import numpy as np

from problems import lcp
from problems.charts.rivals import installed
from problems.scenes.rivals import by_bfgs, by_clarabel, by_piqp

REPEATS = 5
SIZES = (300, 1000)
KINDS = ("rank n/2", "definite", "condition 1e6")


def problem(kind, n, seed=0):
    """P, c and the two bounds."""
    rng = np.random.default_rng(seed)
    if kind == "condition 1e6":
        Q, _ = np.linalg.qr(rng.standard_normal((n, n)))
        P = (Q * np.logspace(0, -6, n)) @ Q.T
    else:
        M = rng.standard_normal((n // 2 if kind == "rank n/2" else n, n))
        P = M.T @ M / n + (0.1 * np.eye(n) if kind == "definite" else 0.0)
    return (P + P.T) / 2, rng.standard_normal(n), -np.ones(n), np.ones(n)


def main(seeds="3"):
    """A line a kind, a size and a solver."""
    solvers = {"lcp.solve": lambda program: lcp.solve(program).x}
    rivals = ("PIQP", "piqp", by_piqp), ("Clarabel", "clarabel", by_clarabel), ("L-BFGS-B", "scipy", by_bfgs)
    for name, module, solve in rivals:
        if installed(module):
            solvers[name] = lambda program, solve=solve: solve(program)[0]
    for n in SIZES:
        for kind in KINDS:
            times, worst = {name: [] for name in solvers}, dict.fromkeys(solvers, 0.0)
            for seed in range(int(seeds)):
                P, c, low, high = problem(kind, n, seed)
                program, best = lcp.from_qp(P, c, lower=low, upper=high), dict.fromkeys(solvers, np.inf)
                for _ in range(REPEATS):
                    for name, solve in solvers.items():
                        began = time.process_time()
                        x = solve(program)
                        best[name] = min(best[name], time.process_time() - began)
                        off = float(np.abs(x - np.clip(x - (P @ x + c), low, high)).max())
                        worst[name] = max(worst[name], off)
                for name, seconds in best.items():
                    times[name].append(seconds)
            for name, found in times.items():
                print(f"{kind}, n = {n}: {name:18} {1e3 * np.median(found):8.1f} ms, residual {worst[name]:.1e}")


if __name__ == "__main__":
    main(*sys.argv[1:])
