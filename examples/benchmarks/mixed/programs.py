"""Random quadratic programs in the box [-1, 1]^n: time and natural residual of every solver, and a chart of them.

    python examples/benchmarks/mixed/programs.py [chart.png]
    python examples/benchmarks/mixed/programs.py ratios [SEEDS [N ...]]

The rivals are piqp, clarabel, highspy and scipy (L-BFGS-B); those that are not installed are left out. Each is timed
in processor seconds (a loaded machine adds to the others) over its whole call, the least of eleven, or in 5 s. With
"ratios" it is lcp.solve beside PIQP alone, in turns, on so many seeds (20).
"""

import sys
import time

import numpy as np
import scipy.optimize
import scipy.sparse as sp

from problems import lcp

REPEATS = 11
SIZES = (300, 1000)
KINDS = ("rank n/2", "definite", "condition 1e6")
LARGEST_FOR_HIGHS = 300
"""HiGHS' active-set method takes minutes beyond."""


def problem(kind, n, seed=0):
    rng = np.random.default_rng(seed)
    if kind == "condition 1e6":
        Q, _ = np.linalg.qr(rng.standard_normal((n, n)))
        P = (Q * np.logspace(0, -6, n)) @ Q.T
    else:
        M = rng.standard_normal((n // 2 if kind == "rank n/2" else n, n))
        P = M.T @ M / n + (0.1 * np.eye(n) if kind == "definite" else 0.0)
    return (P + P.T) / 2, rng.standard_normal(n), -np.ones(n), np.ones(n)


def ours(P, c, low, high):
    return lcp.solve(lcp.from_qp(P, c, lower=low, upper=high)).x


def by_piqp(eps):
    def run(P, c, low, high):
        import piqp

        solver = piqp.DenseSolver()
        solver.settings.verbose = False
        solver.settings.eps_abs = solver.settings.eps_rel = eps
        solver.setup(P, c, None, None, None, None, None, low, high)
        solver.solve()
        return np.array(solver.result.x)

    return run


def by_clarabel(eps):
    def run(P, c, low, high):
        import clarabel

        n = c.size
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = eps
        A = sp.csc_matrix(sp.vstack([sp.eye(n), -sp.eye(n)]))
        upper = sp.csc_matrix(np.triu(P))
        cones = [clarabel.NonnegativeConeT(2 * n)]
        return np.array(clarabel.DefaultSolver(upper, c, A, np.append(high, -low), cones, settings).solve().x)

    return run


def by_highs(P, c, low, high):
    import highspy

    n = c.size
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    solver.addVars(n, low, high)
    solver.changeColsCost(n, np.arange(n, dtype=np.int32), c)
    lower = sp.csc_array(np.tril(P))
    solver.passHessian(
        n, lower.nnz, int(highspy.HessianFormat.kTriangular), lower.indptr.astype(np.int32),
        lower.indices.astype(np.int32), lower.data,
    )  # fmt: skip
    solver.run()
    return np.array(solver.getSolution().col_value)


def by_scipy(P, c, low, high):
    options = {"maxiter": 10_000, "maxfun": 100_000, "ftol": 0.0, "gtol": 1e-13, "maxcor": 30}
    bounds = np.column_stack([low, high])
    return scipy.optimize.minimize(
        lambda x: (0.5 * x @ (P @ x) + c @ x, P @ x + c), np.zeros(c.size), jac=True, bounds=bounds,
        method="L-BFGS-B", options=options,
    ).x  # fmt: skip


SOLVERS = {
    "lcp.solve": ours,
    "PIQP 1e-8": by_piqp(1e-8),
    "PIQP 1e-12": by_piqp(1e-12),
    "Clarabel 1e-8": by_clarabel(1e-8),
    "Clarabel 1e-12": by_clarabel(1e-12),
    "HiGHS": by_highs,
    "L-BFGS-B": by_scipy,
}


def measured(run, data):
    seconds, x, first = np.inf, None, time.process_time()
    P, c, low, high = data
    for _ in range(REPEATS):
        began = time.process_time()
        x = run(P, c, low, high)
        seconds = min(seconds, time.process_time() - began)
        if time.process_time() - first > 5.0:
            break
    inside = np.clip(x, low, high)
    return seconds, residual(x, *data), 0.5 * inside @ P @ inside + c @ inside


def ratios(seeds=20, *sizes):
    """Ratios of processor seconds, lcp.solve to PIQP asked for 1e-8, and the worst natural residuals of both."""
    rival = SOLVERS["PIQP 1e-8"]
    for n in [int(size) for size in sizes] or SIZES:
        for kind in KINDS:
            found = []
            for seed in range(int(seeds)):
                data, best, off = problem(kind, n, seed), [np.inf, np.inf], [0.0, 0.0]
                for _ in range(REPEATS if n <= 300 else 3):
                    for k, run in enumerate((ours, rival)):
                        began = time.process_time()
                        x = run(*data)
                        best[k], off[k] = min(best[k], time.process_time() - began), residual(x, *data)
                found.append((best[0] / best[1], *best, *off))
            ratio, here, there, mine, others = np.array(found).T
            print(
                f"{kind}, n = {n}: ratio median {np.median(ratio):.2f}, worst {ratio.max():.2f}; "
                f"{1e3 * np.median(here):.1f} and {1e3 * np.median(there):.1f} ms; "
                f"residuals up to {mine.max():.0e} and {others.max():.0e}",
                flush=True,
            )


def residual(x, P, c, low, high):
    return float(np.abs(x - np.clip(x - (P @ x + c), low, high)).max())


def main(chart=None, *rest):
    if chart == "ratios":
        ratios(*rest)
        return
    points = []
    for kind in KINDS:
        for n in SIZES:
            data = problem(kind, n)
            for name, run in SOLVERS.items():
                if name == "HiGHS" and n > LARGEST_FOR_HIGHS:
                    continue
                try:
                    seconds, residual, objective = measured(run, data)
                except ImportError:
                    continue
                print(
                    f"{kind}, n = {n}: {name:15} {1e3 * seconds:8.1f} ms, residual {residual:.1e}, {objective:.12g}",
                    flush=True,
                )
                points.append((kind, n, name, seconds, residual))
    if chart is not None:
        draw(points, chart)


def draw(points, file):
    import matplotlib.pyplot as plt
    from matplotlib.ticker import LogLocator, NullFormatter

    names = list(dict.fromkeys(name for _, _, name, _, _ in points))
    figure, axes = plt.subplots(len(SIZES), len(KINDS), figsize=(11, 6.5), sharex="row", sharey=True, squeeze=False)
    for row, n in zip(axes, SIZES):
        for ax, kind in zip(row, KINDS):
            for k, name in enumerate(names):
                at = [(s, r) for kind_, n_, name_, s, r in points if (kind_, n_, name_) == (kind, n, name)]
                if at:
                    marker, size = ("o", 8) if k else ("*", 13)
                    ax.loglog(at[0][0], max(at[0][1], 1e-17), marker, color=f"C{k}", ms=size, label=name)
            ax.set_title(f"{kind}, n = {n}")
            ax.grid(alpha=0.3)
            ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            ax.xaxis.set_major_formatter("{x:g}")
            ax.xaxis.set_minor_formatter(NullFormatter())
    for ax in axes[-1]:
        ax.set_xlabel("processor seconds")
    for ax in axes[:, 0]:
        ax.set_ylabel("natural residual")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=len(labels), fontsize=9)
    figure.tight_layout(rect=(0.0, 0.05, 1.0, 1.0))
    figure.savefig(file, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
