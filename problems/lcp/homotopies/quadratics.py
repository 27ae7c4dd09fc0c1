"""The homotopies as affine parts and one product."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.lcp.proof.certificate import certify, certify_exactly
from problems.lcp.quadratic.form import Affine, Quadratic

END_DISTANCE = 1e-6
"""Largest distance of a path's end from its exact solution, relative to x."""

NO_SOLUTION = 1e-2
"""Relative residual above which the rational test is skipped."""


def exact_end(problem: MixedLCP, x: Array) -> str:
    """The sentence on the exact solution near x, or ""."""
    # A row may consist of vanishing components.
    if min(certify(problem, x, zero).relative_residual for zero in (0.0, END_DISTANCE)) > NO_SOLUTION:
        return ""
    found = certify_exactly(problem, x)
    if not found.solves:
        return ""
    away = float(np.abs(found.x_rounded - x).max()) / (float(np.abs(x).max()) or 1.0)
    if not away <= END_DISTANCE:
        return ""
    return (
        f"The end is a solution by rational arithmetic, {away:.0e} from the stored one; no curve is proved to reach it."
    )


def form(homotopy: Any) -> Quadratic:
    """Affine parts and product of H."""
    c, n = homotopy.c, homotopy.n
    size = n + c.size
    parts = [homotopy.parts(unit[:-1], unit[-1], 0.0) for unit in np.eye(size + 1)]
    goal, origin, p, q = (np.column_stack([part[k] for part in parts]) for k in range(4))
    plain = np.column_stack([np.broadcast_to(part[4], c.shape) for part in parts])
    goal_0, origin_0, p_0, q_0, plain_0 = homotopy.parts(np.zeros(size), 0.0)
    exact, sums, constants = homotopy.rounded()
    lam, whole = np.eye(1, size + 1, size), np.zeros((n, size + 1))
    whole[:, :n] = sums
    end, end_0, shift = (goal, goal_0, 0.0) if exact == "goal" else (origin, origin_0, -1.0)
    return Quadratic(
        plain=Affine(np.append(end_0, np.broadcast_to(plain_0, c.shape)), np.vstack([end, plain - np.outer(c, lam)])),
        first=Affine(np.append(np.full(n, shift), p_0), np.vstack([np.repeat(lam, n, axis=0), p])),
        second=Affine(
            np.append(origin_0 - goal_0, q_0),
            np.vstack([origin - goal, q]),
            np.vstack([np.abs(origin) + np.abs(goal) + whole, 0.0 * q]),
            np.append(np.abs(origin_0) + np.abs(goal_0) + constants, np.abs(q_0)),
        ),
    )
