"""Degenerate branch points: branches touch, more than two cross, or H' loses several ranks.

The eigenvalue z of M_a^-1 M behaves like (1 - t / s)^m with m > 1, or several vanish together. The secant method finds
s and m: z / z' has a simple zero at s with slope 1 / m. The path goes straight on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, partial

import numpy as np
from attrs import frozen

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, largest
from continuation.contraction import MONOTONE
from continuation.evaluation.noise import allowed_along
from continuation.events.eigenvalues import EIGENVALUE_ACCURACY
from continuation.events.singularity import SimpleBranchPoint
from continuation.metric import norm
from continuation.point.arc import Arc
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction

BESIDE, FIRST_ORDER, SIMPLE_ORDER = 0.05, 1.8, 1.5
"""Relative difference step for z'; first order (2 would hit a double zero); largest order of a simple zero."""

Z_ROUND_OFF = SIX_DIGITS * SIX_DIGITS
"""Round-off of z, by products."""

FARTHEST = 3.0
"""Branch points farther ahead, in arc lengths, are left to the next arc."""


@frozen(eq=False)
class BranchPointOnArc:
    """A branch point on or ahead of an arc.

    `simple`: None if degenerate. `order`: of the zero of z. `lost`: ranks that H' loses.
    """

    u: Array
    simple: SimpleBranchPoint | None = None
    order: float = 1.0
    lost: int = 1

    @property
    def odd(self) -> bool:
        """Whether the determinant changes sign."""
        return bool(round(self.order) * self.lost % 2)

    def expected(self, t: float, s: float) -> float:
        """1 - z at t, if z vanishes at s."""
        left = 1.0 - t / s
        return 1.0 - math.copysign(abs(left) ** self.order, left if round(self.order) % 2 else 1.0)


def degenerate_point(
    solver: PathSolver, arc: Arc, prediction: Prediction, t: float, z_at: Callable[[float, Array], float], lost: int
) -> tuple[Array, float] | None:
    """Return the degenerate branch point indicated at t and its order, or None.

    `z_at`: maps parameter and point to z or NaN. `lost`: number of eigenvalues like z.
    """

    def beside(place: float) -> float:
        return z_at(place, prediction(place * arc.length))

    @cache
    def on_path(place: float) -> Array:
        u = prediction(place * arc.length)
        if not touching:
            # Symmetry keeps the prediction from errors that vanishing eigenvalues would magnify.
            settled = solver.settled(arc.a, u, arc.a.border)
            return u if settled is None else settled
        return solver.project(arc.a, u, arc.a.border)[0]

    def at(place: float, u: Array) -> float:
        # Corrections end on either of two branches that touch.
        z = z_at(place, u)
        return abs(z) if touching else z

    order, touching = FIRST_ORDER, False
    try:
        z, left = _left(beside, t, FIRST_ORDER)
        ahead = t - FIRST_ORDER * left
        if ahead <= 0.0 > z:
            # Far behind the point: extrapolate linearly from z = 1.
            ahead = 0.5 * (t + t / (1.0 - z))
        if not 0.0 < ahead < FARTHEST:
            return None
        _, beyond = _left(beside, ahead, FIRST_ORDER)
        order = max((ahead - t) / (beyond - left), 1.0)
        touching = order > SIMPLE_ORDER and lost == 1
        t, last = ahead - order * beyond, np.inf
        place = t
        while 0.0 < t < FARTHEST:
            z, left = _left(lambda s: at(s, on_path(s)), t, order)
            u = on_path(t)
            if abs(z) <= max(Z_ROUND_OFF, _blur(solver, u, z, partial(at, t), arc.a.approximate, arc.a.weights)):
                return u, order
            if not abs(left) < MONOTONE * abs(last):
                # M_a is nearly singular: z is round-off.
                if abs(left) <= ROOT_OF_ROUND_OFF * t and abs(z) <= EIGENVALUE_ACCURACY:
                    return u, order
                break
            place, last, t = t, left, t - order * left
        if touching:
            # The branches are closer than u is accurate; at a double root z has half of its digits.
            u, solve = _at_double_root(solver, on_path(place), arc.a.border)
            z = at(place, u)
            if abs(z) <= max(ROOT_OF_ROUND_OFF, _blur(solver, u, z, partial(at, place), solve, arc.a.weights)):
                return u, order
    except ArithmeticError:
        # z is NaN, or secant points coincide.
        pass
    return None


def _at_double_root(solver: PathSolver, u: Array, border: Array) -> tuple[Array, Callable[[Array], Array]]:
    """The point after twice Newton's increment if H is smaller there, as at a double root; and a solver at u.

    H hardly changes along the kernel, so only a matrix from there shows how far round-off reaches.
    """
    evaluator = solver.evaluator
    r = evaluator.residual(u)
    solve = partial(evaluator.factor(u, border).approximate, rho=0.0)
    further = u - 2.0 * solve(r)
    return further if largest(evaluator.residual(further)) < largest(r) else u, solve


def _left(look: Callable[[float], float], t: float, order: float) -> tuple[float, float]:
    """The pair (z, z / z') at t; 0 without slope."""
    z = look(t)
    step = -BESIDE * t * abs(z) ** (1.0 / order)
    change = look(t + step) - z
    return z, z * step / change if change else 0.0


def _blur(
    solver: PathSolver,
    u: Array,
    z: float,
    look: Callable[[Array], float],
    solve: Callable[[Array], Array],
    weights: Array,
) -> float:
    """Effect of H's round-off on z; 0 if too large."""
    residual = solver.evaluator.residual
    r = residual(u)
    allowed = np.abs(r) + solver.evaluator.round_off(u, r)
    way = solve(allowed)
    size = norm(weights, way)
    if not size > 0.0:
        return 0.0
    blur = abs(look(u + allowed_along(residual, u, way / size, 2.0 * allowed, size) * way / size) - z)
    return blur if blur <= EIGENVALUE_ACCURACY else 0.0
