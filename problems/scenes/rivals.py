"""Other packages' and textbook methods, used if installed."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.optimize import minimize

from continuation.arrays import Array
from problems.lcp.data.program import Program
from problems.lcp.reference import lemke
from problems.scenes.scene import Rival, conditions

TOLERANCE = 1e-10
"""Interior-point methods reach it on well-scaled problems."""

Found = tuple[Array, int]


def of_problem(name: str, module: str, method: Callable[[Any], Found]) -> Rival:
    """A rival for ``scene.problem()``."""
    return Rival(name, module, lambda scene: scene.answer(SimpleNamespace(x=method(scene.problem())[0])))


def _arrived(x: Any, well: bool, message: object, iterations: int = 0) -> Found:
    if x is None or not well:
        raise ArithmeticError(f"no solution: {message}")
    return np.asarray(x, dtype=float), int(iterations)


def by_quantecon(problem: Any) -> Found:
    """Lemke's method (compiled tableau)."""
    found = conditions(problem)
    A = found.A.toarray() if found.sparse else found.A
    result = import_module("quantecon.optimize").lcp_lemke(A, found.q, max_iter=100 * found.n)
    return _arrived(result.z, result.success, f"status {result.status}", result.num_iter)


def by_tables(problem: Any) -> Found:
    """Lemke's method (numpy tableau)."""
    return lemke(conditions(problem))


def program_of(problem: Any) -> tuple[Any, Array, Any, Array, Any, Array, Array, Array]:
    """P, c, A_eq, b_eq, G, h (G x >= h), lower, upper of a program or bounded problem.

    A nonsymmetric problem becomes min x'(A x + q), A x + q >= 0.
    """
    found = conditions(problem)
    if not isinstance(problem, Program):
        M, none, q = sp.csr_array(found.A), sp.csr_array((0, found.n)), found.q
        if (M != M.T).nnz:
            return M + M.T, q, none, np.zeros(0), M, -q, found.lower, found.upper
        return M, q, none, np.zeros(0), none, np.zeros(0), found.lower, found.upper
    n, A = problem.n, sp.csr_array(found.A)
    R, equal = A[n:, :n], np.isneginf(found.lower[n:])
    free, signed = np.flatnonzero(equal), np.flatnonzero(~equal)
    b = -found.q[n:]
    return A[:n, :n], found.q[:n], R[free], b[free], R[signed], b[signed], found.lower[:n], found.upper[:n]


def by_piqp(problem: Any) -> Found:
    """An interior-point method."""
    P, c, B, b, G, h, lower, upper = program_of(problem)
    library = import_module("piqp")
    solver = library.SparseSolver()
    solver.settings.eps_abs = solver.settings.eps_rel = TOLERANCE
    B, G = sp.csc_matrix(B), sp.csc_matrix(G)
    solver.setup(sp.csc_matrix(P), c, B, b, G, h, np.full(h.size, np.inf), lower, upper)
    status = solver.solve()
    return _arrived(solver.result.x, status == library.PIQP_SOLVED, status, solver.result.info.iter)


def by_bfgs(problem: Any) -> Found:
    """Quasi-Newton, for bounds only."""
    P, c, _, b, _, h, lower, upper = program_of(problem)
    if b.size or h.size:
        raise ArithmeticError("L-BFGS-B takes bounds alone")

    def value(x: Array) -> tuple[float, Array]:
        slope = P @ x
        return float(0.5 * (x @ slope) + c @ x), slope + c

    start = np.clip(np.zeros(c.size), lower, upper)
    options = {"maxiter": 15_000, "maxfun": 30_000, "ftol": 1e-16, "gtol": 1e-12}
    found = minimize(value, start, jac=True, method="L-BFGS-B", bounds=np.column_stack([lower, upper]), options=options)
    return _arrived(found.x, True, found.message)


LEMKE = of_problem("Lemke (quantecon)", "quantecon", by_quantecon)
TABLES = of_problem("Lemke (tables, numpy)", "", by_tables)
PIQP = of_problem("PIQP", "piqp", by_piqp)
BFGS = of_problem("L-BFGS-B (scipy)", "", by_bfgs)

QUADRATIC = (PIQP, BFGS)
"""For symmetric problems with bounds only."""
