"""The homotopies of this package as affine parts and one product: what a proof of their paths needs."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.certificate.quadratic import Affine, Quadratic
from problems.lcp.data.problem import MixedLCP
from problems.lcp.proof.certificate import certify_exactly

AWAY = 1e-6
"""How far the exact solution may be from the end of the path, in sizes of x, to be that end."""


def exact_end(problem: MixedLCP, x: Array) -> str:
    """What is proved of the end x of a path, in rational arithmetic; empty where nothing is.

    Parameters
    ----------
    problem : MixedLCP
    x : ndarray, shape (n,)
    """
    found = certify_exactly(problem, x)
    if not found.solves:
        return ""
    away = float(np.abs(found.x_rounded - x).max()) / (float(np.abs(x).max()) or 1.0)
    if not away <= AWAY:
        return ""
    return (
        f"The end is a solution by rational arithmetic, {away:.0e} from the stored one; no curve is proved to reach it."
    )


def kkt_form(homotopy: Any) -> Quadratic:
    """``F + lam (x - x0 - F)``, ``z1 x - lam c1``, ``z2 (A x + q + lam rho) - lam c2``, F the stationarity.

    Parameters
    ----------
    homotopy : KKTHomotopy
    """
    n, q = homotopy.n, homotopy.problem.q
    A = _dense(homotopy.problem.A)
    eye, none = np.eye(n), np.zeros((n, n))
    one = np.ones((n, 1))

    def rows(x: Array, z1: Array, z2: Array, lam: Array) -> Array:
        return np.hstack([x, z1, z2, lam])

    def stacked(*blocks: Array) -> Array:
        return np.vstack(blocks)

    nothing = 0.0 * one
    only_x, only_z1 = rows(eye, none, none, nothing), rows(none, eye, none, nothing)
    only_z2 = rows(none, none, eye, nothing)
    c1, c2 = (rows(none, none, none, -c[:, None]) for c in (homotopy.c1, homotopy.c2))
    F = rows(A + A.T, -eye, -A.T, nothing)
    sizes = rows(np.abs(A) + np.abs(A.T), eye, np.abs(A.T), nothing)
    w = rows(A, none, none, homotopy.rho[:, None])
    zeros, x0 = np.zeros(n), homotopy.origin.x0
    return Quadratic(
        plain=Affine(np.concatenate([q, zeros, zeros]), stacked(F, c1, c2), stacked(sizes, np.abs(c1), np.abs(c2))),
        first=Affine(np.zeros(3 * n), stacked(rows(none, none, none, one), only_z1, only_z2)),
        second=Affine(
            np.concatenate([-x0 - q, zeros, q]),
            stacked(only_x - F, only_x, w),
            stacked(only_x + sizes, only_x, np.abs(w)),
            np.concatenate([np.abs(x0) + np.abs(q), zeros, np.abs(q)]),
        ),
    )


def pairs_form(homotopy: Any) -> Quadratic:
    """``sign (goal + lam (origin - goal))`` and ``gap y - lam c``, for the homotopies in (x, y).

    Parameters
    ----------
    homotopy : TwoVectorHomotopy
    """
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
    gap, force = (np.hstack([*parts, np.zeros((count, 1))]) for parts in _pairs(pull, count, n))
    none = np.zeros(count)
    bounds = (
        np.zeros(count) if problem.standard else np.concatenate([-problem.lower[sides.low], problem.upper[sides.high]])
    )
    sign = float(blend.sign)
    return Quadratic(
        plain=Affine(np.concatenate([sign * problem.q, none]), np.vstack([sign * goal, last])),
        first=Affine(np.concatenate([np.zeros(n), bounds]), np.vstack([np.repeat(lam, n, axis=0), gap])),
        second=Affine(
            np.concatenate([sign * constant, none]),
            np.vstack([sign * (origin - goal), force]),
            np.vstack([sizes, np.abs(force)]),
            np.concatenate([terms, none]),
        ),
    )


def _pairs(pull: Array, count: int, n: int) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """The distances from the bounds, and the forces, as matrices of (x, y)."""
    return (pull, np.zeros((count, count))), (np.zeros((count, n)), np.eye(count))


def _dense(matrix: Any) -> Array:
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float)
