"""Degenerate branch points: where branches touch, more than two cross, or H' loses several ranks at once.

There z, the real eigenvalue of M_a^-1 M along an arc, goes like (1 - t / s)^m with m > 1, or several eigenvalues vanish
together, of which a Krylov space shows one. z over its slope has a simple zero at s whatever m is, and the slope 1 / m
there: the secant method finds both. The path goes straight on, as it does along a branch that symmetry keeps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.contraction import MONOTONE
from continuation.correctors.base import ROOT_OF_ROUND_OFF
from continuation.evaluation.noise import allowed_along
from continuation.events.singularity import SimpleBranchPoint
from continuation.metric import norm
from continuation.point.arc import Arc
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction

SECANTS_OF_Z = 20
"""Of the secant method; four or five are usual."""

BESIDE, FIRST_ORDER, SIMPLE_ORDER = 0.05, 1.8, 1.5
"""The step of the slope of z, of the way that is left; the order that is assumed first, so that a double zero is not
met at once; and the order of a zero beyond which it is no simple one."""

BLURRED, Z_ROUND_OFF = 0.05, 1e-12
"""What round-off in H may make of z where it is said to vanish: more, and nothing is known of it; and what round-off in
the products that tell z does."""

FARTHEST = 3.0
"""So far ahead, in arcs, it is looked for."""


@frozen(eq=False)
class BranchPointOnArc:
    """A branch point on an arc or ahead of it.

    `simple`: None for a degenerate one. `order`: Of the zero of z. `lost`: How many ranks H' loses there. `alone`:
    Whether no other branch point lies so near that its eigenvalue may be taken for one of these.
    """

    u: Array
    simple: SimpleBranchPoint | None = None
    order: float = 1.0
    lost: int = 1
    alone: bool = True

    @property
    def odd(self) -> bool:
        """Whether the determinant's sign changes there."""
        return bool(round(self.order) * self.lost % 2)

    def expected(self, t: float, s: float) -> float:
        """What is told at t of an eigenvalue that vanishes at s."""
        left = 1.0 - t / s
        return 1.0 - math.copysign(abs(left) ** self.order, left if round(self.order) % 2 else 1.0)


def degenerate_point(
    solver: PathSolver, arc: Arc, prediction: Prediction, t: float, z_at: Callable[[float, Array], float], lost: int
) -> tuple[Array, float] | None:
    """The degenerate branch point to which a look at t leads; None where there is none.

    Eigenvalues that vanish together may come to zero at different rates: that H' loses several ranks may be told at the
    point alone.

    Parameters
    ----------
    solver : PathSolver
    arc : Arc
    prediction : Prediction
        Of the arc.
    t : float
        Where on the arc z has fallen.
    z_at : callable
        From a place on the arc and a point there to z; NaN where it is not told.
    lost : int
        How many eigenvalues are like z at t.

    Returns
    -------
    u : ndarray, shape (N + 1,)
        The point, as near as round-off in H allows.
    order : float
        Of the zero of z, about.
    """

    def beside(place: float) -> float:
        return z_at(place, prediction(place * arc.length))

    def on_path(place: float) -> Array:
        u = prediction(place * arc.length)
        if lost > 1 or order <= SIMPLE_ORDER:
            # The symmetry that makes eigenvalues vanish together keeps the prediction from what they would magnify.
            settled = solver.settled(arc.a, u, arc.a.border)
            return u if settled is None else settled
        return solver.project(arc.a, u, arc.a.border)[0]

    order = FIRST_ORDER
    try:
        z, left = _left(beside, t, FIRST_ORDER)
        ahead = t - FIRST_ORDER * left
        if ahead <= 0.0 > z:
            # Far behind the point: it lies about where a straight line from 1 at the arc's beginning is zero.
            ahead = 0.5 * (t + t / (1.0 - z))
        if not 0.0 < ahead < FARTHEST:
            return None
        _, beyond = _left(beside, ahead, FIRST_ORDER)
        # A smooth z has a zero of the first order at least.
        order = max((ahead - t) / (beyond - left), 1.0)
        # From here on the path: beside a degenerate point a place on it may cost factorisations.
        t, before, last = ahead - order * beyond, 0.0, np.inf
        for _ in range(SECANTS_OF_Z):
            z, left = _left(lambda place: z_at(place, on_path(place)), t, order)
            u = on_path(t)
            if abs(z) <= max(Z_ROUND_OFF, _blur(solver, arc, u, z, partial(z_at, t))):
                return u, order
            if not abs(left) < MONOTONE * abs(last):
                # Where M_a is itself nearly singular its round-off is what is left of z.
                return (u, order) if abs(left) <= ROOT_OF_ROUND_OFF * t else None
            if before:
                order = max((t - before) / (left - last), 1.0)
            before, last, t = t, left, t - order * left
            if not 0.0 < t < FARTHEST:
                return None
    except ArithmeticError:
        # No value there, or two looks of the secant method that are one.
        pass
    return None


def _left(look: Callable[[float], float], t: float, order: float) -> tuple[float, float]:
    """The pair of z at a place and z over its slope there, by a difference towards the beginning; 0 if that is none."""
    z = look(t)
    step = -BESIDE * t * abs(z) ** (1.0 / order)
    change = look(t + step) - z
    return z, z * step / change if change else 0.0


def _blur(solver: PathSolver, arc: Arc, u: Array, z: float, look: Callable[[Array], float]) -> float:
    """What round-off in H makes of z: its change as far beside the path as H stays round-off; 0 if that is too much.

    Near a degenerate point that is far, since H' has nearly lost its rank.
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
