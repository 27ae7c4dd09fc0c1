"""The homotopies of this package as affine parts and one product: what a proof of their paths needs."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.lcp.proof.certificate import certify, certify_exactly
from problems.lcp.quadratic.form import Affine, Quadratic

END_DISTANCE = 1e-6
"""How far the exact solution may be from the end of the path, in sizes of x, to be that end."""

NO_SOLUTION = 1e-2
"""A relative residual above this is not that of a point so near to a solution: rational arithmetic need not say so."""


def exact_end(problem: MixedLCP, x: Array) -> str:
    """What is proved of the end x of a path, in rational arithmetic; empty where nothing is."""
    # What is zero at the end may be all that there is in a row.
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


def kkt_form(homotopy: Any) -> Quadratic:
    """``x - x0 + (lam - 1) (x - x0 - F)``, ``z1 x - lam c1``, ``z2 (A x + q + lam rho) - lam c2``, F the stationarity.

    With bounds x stands for the distances from them, and ``(width - z2) t - lam c3`` is added for boxes; the row of an
    index without bounds is ``A x + q + lam (rho - give z0) + (lam) (give z2)``.
    """
    problem, rows, n, N = homotopy.problem, homotopy.rows, homotopy.n, homotopy.rows.size
    A, q, sides = _dense(problem.A), problem.q, rows.sides
    # Each unknown as a row of coefficients of (y, lam), and lam itself.
    whole = np.eye(N + 1)
    x, z1, z2, t = (whole[place] for place in homotopy.places)
    lam, pull = whole[-1:], sides.sign[:, None] * np.eye(n)[sides.index]
    end = np.broadcast_to(rows.end, n)
    F = A @ x + A.T @ (x - z2) - pull.T @ z1
    # Of what is a sum of two entries of A; single entries are exact.
    sizes = (np.abs(A) + np.abs(A.T)) @ x
    constant = q - A.T @ end
    # The sum of A'end has n terms, the error that goes with `sizes` is that of eight.
    terms = np.abs(q) + (np.abs(A.T) @ np.abs(end)) * (1.0 + n / 4.0)
    raised = A @ x + homotopy.rho[:, None] * lam
    raised[rows.boxed] += t
    free, width = rows.free[:, None], rows.width
    row = np.where(free, raised - (homotopy.give * homotopy.origin.z2)[:, None] * lam, -homotopy.c2[:, None] * lam)
    none = np.zeros(sides.index.size)
    bounds = none if problem.standard else np.concatenate([-problem.lower[sides.low], problem.upper[sides.high]])
    x0, c1, c3 = homotopy.origin.x0, homotopy.c1[:, None] * lam, homotopy.c3[:, None] * lam
    return Quadratic(
        plain=Affine(
            np.concatenate([-x0, none, np.where(rows.free, q, 0.0), 0.0 * width]),
            np.vstack([x, -c1, row, -c3]),
            np.vstack([0.0 * x, 0.0 * c1, np.where(free, np.abs(row), 0.0), 0.0 * c3]),
        ),
        first=Affine(
            np.concatenate([np.full(n, -1.0), none, np.zeros(n), width]),
            np.vstack([np.repeat(lam, n, axis=0), z1, np.where(free, lam, z2), -z2[rows.boxed]]),
        ),
        second=Affine(
            np.concatenate([-x0 - constant, bounds, np.where(rows.free, 0.0, q), 0.0 * width]),
            np.vstack([x - F, pull @ x, np.where(free, homotopy.give * z2, raised), t]),
            np.vstack([x + sizes, 0.0 * (pull @ x), 0.0 * raised, 0.0 * t]),
            np.concatenate([np.abs(x0) + terms, np.abs(bounds), np.where(rows.free, 0.0, np.abs(q)), 0.0 * width]),
        ),
    )


def pairs_form(homotopy: Any) -> Quadratic:
    """``sign (goal + lam (origin - goal))`` and ``gap y - lam c``, for the homotopies in (x, y)."""
    problem, blend, sides, n = homotopy.problem, homotopy.blend, homotopy.sides, homotopy.n
    A, count = _dense(problem.A), sides.index.size
    pull = sides.sign[:, None] * np.eye(n)[sides.index]
    on_x = np.broadcast_to(np.asarray(blend.x, dtype=float), n)
    x0, forces = homotopy.x0, sides.force(homotopy.y0)
    goal = np.hstack([A, -pull.T, np.zeros((n, 1))])
    origin = np.hstack([np.diag(on_x) + blend.A * A, -blend.y * pull.T, np.zeros((n, 1))])
    sizes = np.hstack([(1.0 + abs(blend.A)) * np.abs(A), (1.0 + abs(blend.y)) * np.abs(pull.T), np.zeros((n, 1))])
    sizes[:, :n] += np.diag(np.abs(on_x))
    constant = -on_x * x0 + blend.y * forces - blend.A * (A @ x0) - problem.q
    # The sums of A x0 have n terms, the error that goes with `sizes` is that of eight.
    terms = np.abs(on_x * x0) + abs(blend.y) * np.abs(pull.T) @ np.abs(homotopy.y0) + np.abs(A) @ np.abs(x0)
    terms = (terms + np.abs(problem.q)) * (1.0 + (n + count) / 4.0)
    lam, last = np.zeros((1, n + count + 1)), np.zeros((count, n + count + 1))
    lam[0, -1] = 1.0
    last[:, -1] = -homotopy.c
    # The distances from the bounds, and the forces, as matrices of (x, y, lam).
    gap, force = np.zeros((2, count, n + count + 1))
    gap[:, :n], force[:, n:-1] = pull, np.eye(count)
    none = np.zeros(count)
    bounds = none if problem.standard else np.concatenate([-problem.lower[sides.low], problem.upper[sides.high]])
    sign = float(blend.sign)
    return Quadratic(
        plain=Affine(np.concatenate([sign * problem.q, none]), np.vstack([sign * goal, last])),
        first=Affine(np.concatenate([np.zeros(n), bounds]), np.vstack([np.repeat(lam, n, axis=0), gap])),
        second=Affine(
            np.concatenate([sign * constant, none]),
            np.vstack([sign * (origin - goal), force]),
            np.vstack([sizes, 0.0 * force]),
            np.concatenate([terms, none]),
        ),
    )


def _dense(matrix: Any) -> Array:
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float)
