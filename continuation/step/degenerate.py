"""Degenerate branch points: branches touch, more than two branches cross, or H' loses several ranks.

There z, the real eigenvalue of M_a^-1 M along an arc, behaves like (1 - t / s)^m with m > 1, or several eigenvalues
vanish together and a Krylov space shows one of them. z / z' has a simple zero at s with slope 1 / m for every m; the
secant method finds both. The path goes straight on, like a branch that symmetry keeps.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from continuation.arrays import Array
from continuation.contraction import MONOTONE
from continuation.correctors.base import ROOT_OF_ROUND_OFF
from continuation.evaluation.noise import allowed_along
from continuation.metric import norm
from continuation.point.arc import Arc
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction

SECANTS_OF_Z = 20
"""Limit of secant steps; four or five are usual."""

BESIDE, FIRST_ORDER, SIMPLE_ORDER = 0.05, 1.8, 1.5
"""Difference step for the slope of z, relative to the remaining distance; the order assumed first, so that the
iteration does not hit a double zero at once; and the largest order of a simple zero.
"""

BLURRED, Z_ROUND_OFF = 0.05, 1e-12
"""Largest effect of round-off in H on a vanishing z, beyond which z is useless; and the effect of round-off in the
matrix products.
"""

FARTHEST = 3.0
"""Search limit ahead, in arc lengths."""


def degenerate_point(
    solver: PathSolver, arc: Arc, prediction: Prediction, t: float, z_at: Callable[[float, Array], float], lost: int
) -> tuple[Array, float] | None:
    """Return the degenerate branch point indicated by a sample at t; None without one, as at a simple branch point.

    Parameters
    ----------
    solver : PathSolver
    arc : Arc
    prediction : Prediction
        Prediction of the arc.
    t : float
        Parameter on the arc where z has fallen.
    z_at : callable
        Maps a parameter and a point there to z; NaN where z is unknown.
    lost : int
        Number of eigenvalues close to z at t.

    Returns
    -------
    u : ndarray, shape (N + 1,)
        The point, to round-off in H.
    order : float
        Approximate order of the zero of z.
    """

    def beside(place: float) -> float:
        return z_at(place, prediction(place * arc.length))

    def on_path(place: float) -> Array:
        u = prediction(place * arc.length)
        if lost > 1:
            # The symmetry that makes the eigenvalues vanish together keeps the prediction out of their eigenvectors.
            settled = solver.settled(arc.a, u, arc.a.border)
            return u if settled is None else settled
        return solver.project(arc.a, u, arc.a.border)[0]

    try:
        z, left = _left(beside, t, FIRST_ORDER)
        ahead = t - FIRST_ORDER * left
        if ahead <= 0.0 > z:
            # Far behind the point: guess the zero of the line through z = 1 at the arc's beginning.
            ahead = 0.5 * (t + t / (1.0 - z))
        if not 0.0 < ahead < FARTHEST:
            return None
        _, beyond = _left(beside, ahead, FIRST_ORDER)
        # A smooth z has a zero of order one or more.
        order = max((ahead - t) / (beyond - left), 1.0)
        if not (order > SIMPLE_ORDER or lost > 1):
            return None
        # Projections begin here: near a degenerate point each may cost factorisations.
        t, before, last = ahead - order * beyond, 0.0, np.inf
        for _ in range(SECANTS_OF_Z):
            z, left = _left(lambda place: z_at(place, on_path(place)), t, order)
            u = on_path(t)
            if abs(z) <= max(Z_ROUND_OFF, _blur(solver, arc, u, z, partial(z_at, t))):
                return u, order
            if not abs(left) < MONOTONE * abs(last):
                # If M_a is itself nearly singular, the remaining z is round-off.
                return (u, order) if abs(left) <= ROOT_OF_ROUND_OFF * t else None
            if before:
                order = max((t - before) / (left - last), 1.0)
            if before and not (order > SIMPLE_ORDER or lost > 1):
                return None
            before, last, t = t, left, t - order * left
            if not 0.0 < t < FARTHEST:
                return None
    except ArithmeticError:
        # z is NaN, or two secant points coincide.
        pass
    return None


def _left(look: Callable[[float], float], t: float, order: float) -> tuple[float, float]:
    """Return z and z / z' at t, by a difference towards the beginning; 0 without a slope."""
    z = look(t)
    step = -BESIDE * t * abs(z) ** (1.0 / order)
    change = look(t + step) - z
    return z, z * step / change if change else 0.0


def _blur(solver: PathSolver, arc: Arc, u: Array, z: float, look: Callable[[Array], float]) -> float:
    """The effect of round-off in H on z: the change of z as far across the path as H stays round-off; 0 if that is too
    large.

    That distance is long near a degenerate point, where H' is nearly singular.
    """
    residual = solver.evaluator.residual
    r = residual(u)
    allowed = np.abs(r) + solver.evaluator.round_off(u, r)
    way = arc.a.approximate(allowed)
    size = norm(arc.a.weights, way)
    if not size > 0.0:
        return 0.0
    blur = abs(look(u + allowed_along(residual, u, way / size, 2.0 * allowed, size) * way / size) - z)
    return blur if blur <= BLURRED else 0.0
