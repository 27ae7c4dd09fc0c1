"""The LCP benchmark: `lcp.solve` beside other solvers, one BLAS thread, every answer certified by the same judge.

    python examples/benchmarks/lcp/run.py [SECTION ...] [--seeds K] [--markdown FILE]

Without sections all are run (an hour). Rivals need `pip install quantecon piqp` and are left out where missing.
"""

from __future__ import annotations

import argparse
import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from pathlib import Path
from statistics import median

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import generators
import rivals

import continuation
from continuation.predictors import Taylor
from problems import lcp
from problems.paper import EXAMPLES

JUDGE = 1e-8
"""Relative residual to which an answer of any solver counts as one; each row shows the residual reached."""

Solver = Callable[[lcp.LCP, float], "np.ndarray | None"]


class Row:
    """One solver on one family: how many were solved, times, worst residual."""

    def __init__(self, family: str, solver: str) -> None:
        self.family, self.solver = family, solver
        self.seconds: list[float] = []
        self.solved: list[bool] = []
        self.residuals: list[float] = []
        self.notes = ""

    def add(self, problem: lcp.LCP, x: np.ndarray | None, seconds: float, limit: float) -> None:
        """One more answer, judged; one after the limit does not count."""
        certificate = None if x is None or not np.isfinite(x).all() else lcp.certify(problem, x)
        good = certificate is not None and certificate.solves(JUDGE) and seconds <= 1.1 * limit
        self.solved.append(good)
        self.seconds.append(seconds)
        if good and certificate is not None:
            self.residuals.append(certificate.relative_residual)

    @property
    def time(self) -> float:
        """The median time."""
        return median(self.seconds)

    def cells(self, first: Row) -> list[str]:
        """For the table; the ratio is against the first solver of the family."""
        ratio = f"{self.time / first.time:.2f}" if first.time > 0 else ""
        worst = f"{max(self.residuals):.0e}" if self.residuals else ""
        return [
            self.family, self.solver, f"{sum(self.solved)} of {len(self.solved)}", f"{self.time:.3g}", ratio, worst,
            self.notes,
        ]  # fmt: skip


HEAD = ["problem", "solver", "solved", "median s", "ratio", "worst residual", "remarks"]


def ours(problem: lcp.LCP, seconds: float, row: Row) -> np.ndarray | None:
    """`lcp.solve` with a time budget; the work noted."""
    solution = lcp.solve(problem, budget=continuation.Budget(steps=1e9, seconds=seconds))
    row.notes = f"{solution.counts.factorizations} factorisations, {len(solution.paths)} paths in the last"
    return solution.x if solution.solved else None


def compare(family: str, problems: Iterable[lcp.LCP], limit: float, solvers: dict[str, Solver]) -> list[Row]:
    """All solvers on all problems of a family, ours first."""
    rows = [Row(family, name) for name in ("continuation", *solvers)]
    for problem in problems:
        for row in rows:
            began = time.perf_counter()
            try:
                solve = solvers.get(row.solver)
                x = ours(problem, limit, row) if solve is None else solve(problem, limit)
            except Exception as error:
                x, row.notes = None, f"{type(error).__name__}: {error}"[:60]
            row.add(problem, x, time.perf_counter() - began, limit)
    for row in rows:
        print("  ".join(row.cells(rows[0])), flush=True)
    return rows


def available(*names: str) -> dict[str, Solver]:
    """Those rivals that are installed."""
    known: dict[str, tuple[str, Solver]] = {
        "min-Newton": ("numpy", rivals.min_newton),
        "Lemke": ("quantecon", rivals.lemke),
        "Lemke, random d": ("quantecon", rivals.restarted_lemke),
        "PIQP": ("piqp", rivals.piqp),
    }
    return {name: known[name][1] for name in names if find_spec(known[name][0])}


def ten(seeds: int) -> list[Row]:
    """The paper's examples from the paper's starts: with finish, pure, and the portfolio."""
    series = {"preset": continuation.SERIES, "predictor": Taylor(order=60, accuracy=1e-5, rational=True)}
    rows = []
    for title, settings in (
        ("kkt path, series of order 60, finish", {"homotopy": "kkt", **series}),
        ("the same, pure", {"homotopy": "kkt", "finish": False, **series}),
        ("kkt path, default parts, finish", {"homotopy": "kkt"}),
        ("auto", {}),
    ):
        row, work = Row("ten examples", title), []
        for example in EXAMPLES:
            began = time.perf_counter()
            solution = lcp.solve(example.problem, x0=example.x0, **settings)
            row.add(example.problem, solution.x if solution.solved else None, time.perf_counter() - began, 10.0)
            work.append(solution.counts.factorizations)
        row.notes = f"factorisations 1-9: {sum(work[:9])}, 10: {work[9]}"
        rows.append(row)
        print("  ".join(row.cells(rows[0])), flush=True)
    return rows


def definite(seeds: int) -> list[Row]:
    """Positive definite, not symmetric."""
    problems = [generators.positive_definite(1000, seed) for seed in range(min(seeds, 5))]
    return compare("positive definite, n = 1000", problems, 60.0, available("min-Newton", "Lemke"))


def semidefinite(seeds: int) -> list[Row]:
    """Rank-deficient."""
    rows = []
    for n in (1000, 2000):
        problems = [generators.semidefinite(n, seed) for seed in range(min(seeds, 3))]
        rows += compare(f"semidefinite of rank n/2, n = {n}", problems, 120.0, available("PIQP", "min-Newton"))
    return rows


def exponential(seeds: int) -> list[Row]:
    """Murty and Fathi."""
    rows = []
    for name, make in (("Murty", generators.murty), ("Fathi", generators.fathi)):
        for n in (10, 20, 50, 100, 200):
            solvers = available("min-Newton", "Lemke") if n <= 20 else available("min-Newton")
            rows += compare(f"{name}, n = {n}", [make(n)], 20.0, solvers)
    return rows


def planted100(seeds: int) -> list[Row]:
    """Random nonmonotone, n = 100, 5 s each."""
    problems = [generators.random_planted(100, seed) for seed in range(5 * seeds)]
    return compare("random nonmonotone, n = 100", problems, 5.0, available("Lemke, random d", "min-Newton"))


def planted300(seeds: int) -> list[Row]:
    """Random nonmonotone, n = 300, 60 s each."""
    problems = [generators.random_planted(300, seed) for seed in range(seeds)]
    return compare("random nonmonotone, n = 300", problems, 60.0, available("Lemke, random d"))


def contact(seeds: int) -> list[Row]:
    """Frictional contact."""
    rows = []
    for n in (20, 48, 100):
        problems = [generators.frictional_contact(n, seed) for seed in range(2 * seeds)]
        rows += compare(f"frictional contact, n = {n}", problems, 10.0, available("Lemke", "min-Newton"))
    return rows


def games(seeds: int) -> list[Row]:
    """Bimatrix games."""
    rows = []
    for n in (100, 300):
        problems = [generators.bimatrix(n, seed) for seed in range(seeds)]
        rows += compare(f"bimatrix, n = {n}", problems, 60.0, available("Lemke", "min-Newton"))
    return rows


def peak(call: str) -> float:
    """The peak memory, MiB, of a process that makes one problem, solves it, and does nothing else."""
    program = (
        "import resource, generators; from problems import lcp; "
        f"lcp.solve(generators.{call}); print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)"
    )
    ran = subprocess.run([sys.executable, "-c", program], cwd=Path(__file__).parent, capture_output=True, check=True)
    return float(ran.stdout)


def sparse(seeds: int) -> list[Row]:
    """Free boundaries, n = 1e5."""
    rows = []
    for name, call in (
        ("American option, n = 1e5", "american_option(100_000)"),
        ("1D obstacle, n = 1e5", "obstacle_1d(100_000)"),
        ("2D obstacle, n = 316 x 316", "obstacle_2d(316)"),
    ):
        problem = eval(call, vars(generators))
        symmetric = {} if "option" in name else available("PIQP")
        found = compare(name, [problem], 30.0, {**symmetric, **available("min-Newton")})
        found[0].notes += f", peak memory {peak(call):.0f} MiB"
        rows += found
    return rows


SECTIONS = {
    "ten": ten, "definite": definite, "semidefinite": semidefinite, "exponential": exponential, "contact": contact,
    "sparse": sparse, "planted100": planted100, "planted300": planted300, "games": games,
}  # fmt: skip


def main() -> None:
    """Parse, run, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sections", nargs="*", choices=[[], *SECTIONS], metavar="SECTION")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--markdown", type=Path)
    arguments = parser.parse_args()
    if find_spec("quantecon"):
        rivals.warm_up()
    tables = []
    for name in arguments.sections or list(SECTIONS):
        rows = SECTIONS[name](arguments.seeds)
        lines = [HEAD, ["---"] * len(HEAD)]
        firsts: dict[str, Row] = {}
        lines += [row.cells(firsts.setdefault(row.family, row)) for row in rows]
        tables.append("\n".join("| " + " | ".join(cells) + " |" for cells in lines))
    if arguments.markdown:
        arguments.markdown.write_text("\n\n".join(tables) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
