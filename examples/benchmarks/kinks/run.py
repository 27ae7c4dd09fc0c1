"""Piecewise linear paths: counts that are known, all pieces by brute force, and times beside rivals, in one process.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/kinks/run.py [TABLE ...] [--seeds K]

Rivals (scikit-learn, cvxcla, quantecon) are compared with where they are installed. Times are processor seconds.
"""

import argparse
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "lcp"))
sys.path.insert(0, str(Path(__file__).parent))
import applied
import gauss_seidel
from all_pieces import compared
from known_paths import frontier, integer_design, integer_problem, lasso, mairal_yu, murty

from continuation.arrays import Array
from problems import lcp
from problems.lcp import LCP, along
from problems.lcp.pivoting import almost
from problems.scenes.game import bimatrix
from problems.scenes.lasso import penalised
from problems.scenes.planar import free_motion, impulses, time_step
from problems.scenes.portfolio import critical_line


def timed(call: Callable[..., Any], *given: Any, repeats: int = 1, **options: Any) -> tuple[Any, float]:
    """What a call returns, and the least of its times."""
    least, found = np.inf, None
    for _ in range(repeats):
        began = time.process_time()
        found = call(*given, **options)
        least = min(least, time.process_time() - began)
    return found, least


def rival(name: str) -> Any:
    """A module, or None where it is not installed."""
    try:
        return __import__(name, fromlist=["_"])
    except ImportError:
        return None


in_numpy = partial(patch.object, almost, "available", lambda: False)
"""Pivots are not compiled, though quantecon, or Gauss-Seidel, has imported numba."""


def say(*parts: Any) -> None:
    """One line of a table."""
    print(*parts, flush=True)


def counts(seeds: int) -> None:
    """Kinks of paths of which their number is known."""
    for n in range(2, 11):
        path = along(murty(n), np.ones(n), (np.inf, 0.0))
        say(f"Murty n = {n}: {len(path.kinks)} kinks of {2**n - 1}, {path.status.name}")
    linear = rival("sklearn.linear_model")
    for p in range(1, 8):
        X, y = mairal_yu(p)
        path = lasso(X, y)
        theirs = (
            "" if linear is None else f"; sklearn {len(linear.lars_path(X, y, method='lasso', max_iter=5000)[0]) - 1}"
        )
        say(f"Mairal and Yu p = {p}: {len(path.kinks)} kinks of {(3**p - 1) // 2}, {path.status.name}{theirs}")
    X = np.array([[0.0, 0.0, 0.0, -1.0, 0.0], [0.0, -1.0, 0.0, 0.0, 0.0]])
    y, t = np.array([-2.5, -2.5]), 0.002
    theirs = "" if linear is None else linear.LassoLars(alpha=t / 2, fit_intercept=False).fit(X, y).coef_[[1, 3]]
    say(f"sklearn #2746: {lasso(X, y)(t=t)[[1, 3]]} of [2.498 2.498]; sklearn {theirs}")
    data = rival("sklearn.datasets")
    if data is not None:
        X, y = data.load_diabetes(return_X_y=True)
        say(f"diabetes: {len(lasso(X, y - y.mean()).kinks)} kinks of 12")


def off_optimum(X: Array, y: Array, b: Array, t: float) -> float:
    """How far b is from satisfying the optimality conditions of the penalised regression."""
    slope = X.T @ (X @ b - y)
    return float(np.abs(np.where(b != 0.0, slope + t * np.sign(b), np.maximum(np.abs(slope) - t, 0.0))).max())


def integers(seeds: int) -> None:
    """300 integer designs with ties: whether every point of the path, and between them, is optimal."""
    linear, wrong, theirs = rival("sklearn.linear_model"), 0, 0
    for seed in range(min(300, 3 * seeds)):
        X, y = integer_design(seed)
        path = lasso(X, y)
        u = np.vstack([path.u, 0.5 * (path.u[1:] + path.u[:-1])])
        scale = 1.0 + np.abs(X.T @ y).max()
        wrong += not path.success or max(off_optimum(X, y, v[:-1], v[-1]) for v in u) > 1e-12 * scale
        if linear is not None and X.any():
            bad = 0.0
            for t in 0.5 * (path.lam[1:] + path.lam[:-1]):
                model = linear.LassoLars(alpha=t / len(y), fit_intercept=False, eps=np.finfo(float).eps)
                bad = max(bad, off_optimum(X, y, model.fit(X, y).coef_, t))
            theirs += bad > 1e-6 * scale
    say(
        f"integer designs, {min(300, 3 * seeds)}: ours wrong in {wrong}"
        + ("" if linear is None else f"; sklearn in {theirs}")
    )


def pieces(seeds: int) -> None:
    """Random LCP paths of integers (n <= 6), from ray to ray, against all pieces in rational numbers."""
    kinks = degenerate = branching = wide = wrong = 0
    off = 0.0
    for seed in range(100 * seeds):
        one = compared(*integer_problem(seed))
        kinks, degenerate, branching = kinks + one.kinks, degenerate + one.degenerate, branching + one.branching
        wide, off = wide + one.wide, max(off, one.off)
        wrong += bool(one.wrong)
        if one.wrong:
            say(f"  problem {seed}: {one.wrong}")
    say(f"{100 * seeds} paths: {kinks} kinks, {degenerate} of several switches, {branching} branching; {wrong} wrong, "
        f"kinks off by {off:.1e} at most; not compared, on pieces wider than a line: {wide}")  # fmt: skip


def gram_path(linear: Any, G: Array, c: Array, n: int) -> Any:
    """The path of scikit-learn, to its end."""
    return linear.lars_path_gram(Xy=c.copy(), Gram=G.copy(), n_samples=n, method="lasso", max_iter=5000)


def regression(seeds: int) -> None:
    """LASSO paths to the end, from the Gram matrix, beside lars_path_gram."""
    linear = rival("sklearn.linear_model")
    for n, p in ((200, 200), (500, 200), (500, 300), (1000, 300), (1000, 500)):
        r = np.random.default_rng([n, p])
        X = r.normal(size=(n, p))
        y = X[:, :10] @ r.normal(size=10) * 3.0 + r.normal(size=n)
        G, c = X.T @ X, X.T @ y
        path, ours = timed(penalised, G, c, repeats=3)
        off = max(step.residual_norm for step in path.steps) / np.abs(c).max()
        line = f"n = {n}, p = {p}: {len(path.kinks)} kinks, {1e3 * ours:.0f} ms, residual {off:.0e}"
        if linear is not None:
            found, theirs = timed(gram_path, linear, G, c, n, repeats=3)
            line += f"; sklearn {len(found[0]) - 1} kinks, {1e3 * theirs:.0f} ms, ratio {ours / theirs:.2f}"
        say(line)
    r = np.random.default_rng(4)
    U, V = np.linalg.qr(r.normal(size=(200, 100)))[0], np.linalg.qr(r.normal(size=(100, 100)))[0]
    X, y = U * np.logspace(0, -4, 100) @ V.T, r.normal(size=200)
    path = lasso(X, y)
    line = f"cond X = 1e4: {path.status.name} at t = {path.endpoint.lam:g} after {len(path.kinks)} kinks"
    if linear is not None:
        found = linear.lars_path(X, y, method="lasso", max_iter=5000)
        line += f"; sklearn stops at t = {found[0][-1] * 200:.2e} after {len(found[0]) - 1}"
    say(line)


def assets(seeds: int) -> None:
    """Markowitz' critical line beside cvxcla."""
    module = rival("cvxcla")
    for n in (50, 100, 300):
        mean, covariance = frontier(n)
        path, ours = timed(critical_line, mean, covariance, repeats=3)
        line = f"n = {n}: {len(path.kinks)} kinks, {1e3 * ours:.0f} ms"
        if module is not None:
            zero, one = np.zeros(n), np.ones(n)
            found, theirs = timed(module.CLA, mean, covariance, zero, one, one[None], np.ones(1), repeats=3)
            off = np.abs(found.turning_points[-1].weights - path.endpoint.y[:n]).max()
            line += f"; cvxcla {1e3 * theirs:.0f} ms, ratio {ours / theirs:.2f}, end weights differ by {off:.0e}"
        say(line)


def contact(seeds: int) -> None:
    """Applied problems: `lcp.solve`, and with pivots in numpy, beside quantecon's Lemke, solved and median ratio."""
    optimize = rival("quantecon.optimize")
    lcp.solve(LCP(np.eye(2), -np.ones(2)))
    if optimize is not None:
        optimize.lcp_lemke(np.eye(2), -np.ones(2))
    for family in applied.FAMILIES:
        solved = theirs = number = 0
        ratios, own, slower = [], [], []
        for seed in range(max(1, seeds // 10)):
            for A, q in family(seed):
                number += 1
                problem = LCP(A, q)
                found, ours = timed(lcp.solve, LCP(A, q), repeats=2)
                own.append(ours)
                solved += found.solved
                with in_numpy():
                    slower.append(timed(lcp.solve, LCP(A, q), repeats=2)[1])
                if optimize is not None:
                    other, other_time = timed(optimize.lcp_lemke, A, q, max_iter=20 * len(q), repeats=2)
                    right = other.success and problem.relative_residual(np.maximum(other.z, 0.0)) <= 1e-8
                    theirs += right
                    ratios += [ours / max(other_time, 1e-7)] if right else []
        line = f"{family.__name__}: solved {solved} of {number}, median {1e3 * np.median(own):.2f} ms"
        line += f" (in numpy {1e3 * np.median(slower):.2f})"
        if optimize is not None:
            line += f"; quantecon's Lemke {theirs}, ratio of times {np.median(ratios):.1f} (to {max(ratios):.1f})"
        say(line)


def games(seeds: int) -> None:
    """Seven kinds of games beside quantecon's Lemke-Howson."""
    from outside import KINDS
    from outside import games as kinds

    theory = rival("quantecon.game_theory")
    table: dict[tuple[str, int], list[Any]] = {}
    for k, (A, q) in enumerate(kinds(2026)):
        n, m = len(q), len(q) // 2
        if n > 10 * seeds + 40:
            continue
        found, ours = timed(lcp.solve, LCP(A, q))
        with in_numpy():
            slower = timed(lcp.solve, LCP(A, q))[1]
        row = table.setdefault((KINDS[k % 7], n), [])
        entry = [found.solved, ours, False, np.nan, slower]
        if theory is not None:
            game = theory.NormalFormGame([theory.Player(-A[:m, m:]), theory.Player(-A[m:, :m])])
            theory.lemke_howson(game, max_iter=2)
            (_, status), theirs = timed(theory.lemke_howson, game, max_iter=100_000, full_output=True)
            entry[2:4] = status.converged, theirs
        row.append(entry)
    for (name, n), row in sorted(table.items(), key=lambda item: item[0][1]):
        solved, ours, theirs, times, slower = zip(*row)
        own, alone, rivals = (f"{1e3 * np.median(one):.1f} ms" for one in (ours, slower, times))
        say(f"{name}, n = {n}: solved {sum(solved)} of {len(row)}, median {own} (in numpy {alone}); quantecon "
            f"{sum(theirs)}, {rivals}")  # fmt: skip


def several(seeds: int) -> None:
    """All equilibria of coordination games from one, and what is found of the solutions of random problems."""
    for m in range(3, 9 if seeds >= 100 else 5):
        C = 2.0 - np.eye(m) + 1e-3 * np.random.default_rng(m).random((m, m))
        problem = bimatrix(C, C.T)
        found, seconds = timed(lcp.solutions, problem, enumerate_faces=False)
        say(f"coordination m = {m}: {len(found)} of {2**m - 1} on {found.paths} paths, {seconds:.1f} s")
    for n in (8, 10):
        there = met = problems = 0
        for k in range(seeds):
            r = np.random.default_rng([n, k])
            problem = LCP(r.normal(size=(n, n)), r.normal(size=n))
            every = lcp.solve_by_enumeration(problem).solutions
            if len(every) > 1:
                problems += 1
                there += len(every)
                met += len(lcp.solutions(problem, enumerate_faces=False))
        say(f"Gaussian n = {n}: {met} of {there} solutions of {problems} problems with several")


def stepping(seeds: int) -> None:
    """A pile under gravity, and an American option: seconds a step, without and with what was found before.

    Projected Gauss-Seidel is given the impulses of the step before, and stops at the residual of `solve` or 1e-13.
    """
    from generators import american_option

    optimize, number = rival("quantecon.optimize"), 8
    bodies = [(1.0, 1.0 / 6.0, 0.0, k + 0.5) for k in range(number)]
    contacts = [(k, k - 1, side, float(k), 0.0, 1.0) for k in range(number) for side in (-0.5, 0.5)]
    A, J, inverse = time_step(bodies, contacts, 0.5)
    c, v, before, solver = len(contacts), np.zeros(inverse.size), None, lcp.Solver(A)
    W, p, sweeps = (J * inverse) @ J.T, np.zeros(2 * len(contacts)), []
    times: dict[str, list[float]] = {
        "solve": [],
        "solve with guess": [],
        "Solver": [],
        "quantecon's Lemke": [],
        "projected Gauss-Seidel": [],
    }
    gauss_seidel.impulses(W, np.zeros(p.size), p, 0.5, 1.0, 1)
    for k in range(2 * seeds):
        force = np.tile([0.2 * np.sin(k / 8.0), -9.81, 0.0], number)
        free = v + 0.01 * inverse * force
        u = J @ free
        q = free_motion(u)
        cold, seconds = timed(lcp.solve, LCP(A, q))
        times["solve"].append(seconds)
        warm, seconds = timed(lcp.solve, LCP(A, q), guess=before)
        times["solve with guess"].append(seconds)
        assert cold.solved
        assert warm.solved

        times["Solver"].append(timed(solver.solve, q)[1])
        if optimize is not None:
            times["quantecon's Lemke"].append(timed(optimize.lcp_lemke, A, q)[1])
        enough = max(warm.residual, 1e-13)
        (p, count), seconds = timed(gauss_seidel.impulses, W, u, p, 0.5, enough, 100_000)
        times["projected Gauss-Seidel"].append(seconds)
        sweeps.append(count)
        before, x = warm, warm.x
        v = free + inverse * (J.T @ impulses(x))
    for name, taken in times.items():
        if taken:
            say(f"pile, n = {4 * c}, {2 * seeds} steps, {name}: median {1e3 * np.median(taken):.2f} ms")
    say(f"pile: sweeps of Gauss-Seidel, median {np.median(sweeps):.0f}, most {max(sweeps)} of 100,000")
    option = american_option(10 * seeds)
    dense = option.A.toarray() if option.sparse else option.A
    found, taken, cold_times = None, [], []
    for k in range(seeds):
        problem = LCP(option.A, option.q * (1.0 + 0.002 * k))
        found, seconds = timed(lcp.solve, problem, guess=found)
        taken.append(seconds)
        cold_times.append(timed(lcp.solve, problem)[1])
    gauss_seidel.tridiagonal(dense, problem.q, found.x, np.inf)
    x, seconds = timed(gauss_seidel.tridiagonal, dense, problem.q, found.x * 0.998, max(found.residual, 1e-10))
    say(f"American option, n = {option.n}, {seeds} steps: cold median {1e3 * np.median(cold_times):.2f} ms, with guess "
        f"{1e3 * np.median(taken):.2f} ms; the last step by projected Gauss-Seidel {1e3 * seconds:.0f} ms, residual "
        f"{np.abs(np.minimum(x, dense @ x + problem.q)).max():.0e}")  # fmt: skip


TABLES = (counts, integers, pieces, regression, assets, contact, games, several, stepping)


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser()
    parser.add_argument("tables", nargs="*", default=[], choices=[*(table.__name__ for table in TABLES), []])
    parser.add_argument("--seeds", type=int, default=100)
    arguments = parser.parse_args()
    for table in TABLES:
        if not arguments.tables or table.__name__ in arguments.tables:
            say(f"-- {table.__name__}: {(table.__doc__ or '').splitlines()[0]}")
            table(arguments.seeds)


if __name__ == "__main__":
    main()
