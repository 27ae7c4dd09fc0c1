"""Outside solvers, each behind a small adapter, where they are installed."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.metadata import version
from typing import Any

import numpy as np
import scipy.linalg

from continuation.arrays import Array
from continuation.chart import Answer, Method, Problem, Rung
from continuation.counts import Counts
from problems.lcp import LCP

Solved = tuple[Array | None, Counts, str]
"""x, None where the solver itself disowns it; what it cost; how it ended."""

Solver = Callable[[LCP], Solved]
"""A solver of the LCP that traces no path."""

LOOP_STEPS = 1000
"""Steps of the plain loop."""


def scipy_loop() -> Method:
    """Keller's pseudo-arclength continuation in its simplest form, with scipy.

    For dense homotopies with a target. It detects no turning points, so that a loop that it leaves out is not noticed.
    """
    return Method("plain scipy loop", _loop)


def _loop(problem: Problem, rung: Rung) -> Answer:
    homotopy, counts = problem.subject, Counts()
    target = problem.options.get("target", getattr(homotopy, "target", 0.0))
    if target is None:
        raise ValueError("target: the plain loop needs one")

    def solve(u: Array, row: Array, r: Array, rho: float) -> Array:
        counts.factorizations += 1
        counts.solves += 1
        H_y, H_lam = homotopy.jacobian(u[:-1], float(u[-1]))
        whole = np.block([[np.asarray(H_y), H_lam[:, None]], [row[None, :]]])
        return np.asarray(scipy.linalg.solve(whole, np.append(r, rho)))

    def correct(u: Array, row: Array) -> tuple[Array | None, int]:
        for k in range(8):
            counts.residuals += 1
            step = solve(u, row, -homotopy.residual(u[:-1], float(u[-1])), 0.0)
            u = u + step
            if np.linalg.norm(step) <= rung.value * (1.0 + np.linalg.norm(u)):
                return u, k + 1
        return None, 8

    y0, lam0 = homotopy.start()
    u, unit = np.append(y0, lam0), np.zeros(len(y0) + 1)
    unit[-1] = 1.0
    v, h = math.copysign(1.0, target - lam0) * unit, 0.1
    v = solve(u, v, np.zeros(len(y0)), 1.0)
    v /= np.linalg.norm(v)
    while counts.accepted < LOOP_STEPS and h > 1e-9:
        trial = u + h * v
        if (trial[-1] - target) * (u[-1] - target) <= 0.0 and v[-1] != 0.0:
            landed = u + (target - u[-1]) / v[-1] * v
            landed[-1] = target
            end, _ = correct(landed, unit)
            if end is not None:
                counts.accepted += 1
                return Answer(counts, end=end)
        following, iterations = correct(trial, v)
        if following is None:
            h, counts.rejected = h / 2.0, counts.rejected + 1
            continue
        t = solve(following, v, np.zeros(len(y0)), 1.0)
        u, v = following, t / np.linalg.norm(t)
        counts.accepted += 1
        h *= 2.0 if iterations <= 3 else 1.0 if iterations <= 5 else 0.5
    raise ArithmeticError(f"the plain loop did not arrive in {counts.accepted} steps")


def lcp_solvers() -> dict[str, Solver]:
    """By name, those of quantecon, PIQP and Clarabel that can be imported; `lcp_notes` names the others."""
    found: dict[str, Solver] = {}
    for name, (module, solve) in _LCP.items():
        if not _installed(module):
            continue
        library = import_module(module)
        # Once beforehand, for a library that compiles itself at its first call.
        solve(library, LCP(np.eye(1), -np.ones(1)))
        found[name] = partial(solve, library)
    return found


def lcp_notes() -> list[str]:
    """Which outside solvers take part, with their versions, and which are left out."""
    modules = {module: _installed(module) for module, _ in _LCP.values()}
    there = [f"{module} {version(module)}" for module, found in modules.items() if found]
    absent = [module for module, found in modules.items() if not found]
    return [
        *([f"outside solvers: {', '.join(there)}"] if there else []),
        *([f"outside solvers left out, not installed: {', '.join(absent)}"] if absent else []),
    ]


def _installed(module: str) -> bool:
    try:
        import_module(module)
    except ImportError:
        return False
    return True


def _quantecon(library: Any, problem: LCP) -> Solved:
    """Its tableau method; a pivot counts as 6/n factorisations and a solve, like one of our own."""
    result = library.optimize.lcp_lemke(_dense(problem), problem.q)
    pivots = int(result.num_iter)
    counts = Counts(factorizations=-(-6 * pivots // problem.n), solves=pivots, accepted=pivots)
    return np.asarray(result.z) if result.success else None, counts, f"status {int(result.status)}"


def _piqp(library: Any, problem: LCP) -> Solved:
    """Min x'(A x + q), x >= 0, A x + q >= 0, a convex program where A is positive semidefinite."""
    A = _dense(problem)
    n = problem.n
    solver = library.DenseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = 1e-10
    solver.setup(A + A.T, problem.q, None, None, A, -problem.q, np.full(n, np.inf), np.zeros(n), np.full(n, np.inf))
    status = solver.solve()
    x = np.asarray(solver.result.x) if status == library.PIQP_SOLVED else None
    return x, _interior(int(solver.result.info.iter)), str(status)


def _clarabel(library: Any, problem: LCP) -> Solved:
    """The same program as a cone program."""
    import scipy.sparse as sp

    A, n = sp.csc_matrix(_dense(problem)), problem.n
    settings = library.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    rows = sp.vstack([-sp.identity(n, format="csc"), -A], format="csc")
    bound = np.concatenate([np.zeros(n), problem.q])
    upper = sp.triu(A + A.T, format="csc")
    cones = [library.NonnegativeConeT(2 * n)]
    solution = library.DefaultSolver(upper, problem.q, rows, bound, cones, settings).solve()
    x = np.asarray(solution.x) if str(solution.status) in ("Solved", "AlmostSolved") else None
    return x, _interior(int(solution.iterations)), str(solution.status)


def _interior(iterations: int) -> Counts:
    """An iteration of an interior-point method: one factorisation, a solve to predict and one to correct."""
    return Counts(factorizations=iterations, solves=2 * iterations, accepted=iterations)


def _dense(problem: LCP) -> Array:
    A: Array = problem.A.toarray() if problem.sparse else problem.A
    return A


_LCP: dict[str, tuple[str, Callable[[Any, LCP], Solved]]] = {
    "quantecon Lemke": ("quantecon", _quantecon),
    "PIQP": ("piqp", _piqp),
    "Clarabel": ("clarabel", _clarabel),
}
"""Module and adapter by name."""
