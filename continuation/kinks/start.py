"""The piece on which a path begins."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arguments.checks import complain, real_vector
from continuation.arrays import ROOT_OF_ROUND_OFF, Array
from continuation.counts import Counts
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.pieces import Pieces, Signs, SwitchError
from continuation.homotopy import SupportsPieces
from continuation.kinks.first import switch_noise
from continuation.kinks.rays import Corner, UnresolvedError, rays_at
from continuation.metric import Metric
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver
from continuation.step.start import SingularStartError, StartError, first_point, point_from_tangent
from continuation.tolerance import Tolerance

PIECES = 10
"""Limit of corrections, each of which may change the piece."""


def begin(
    solver: PathSolver,
    pieces: Pieces,
    u: Array,
    start: tuple[Array, Array] | None,
    metric: Metric,
    direction: int,
    target: float | None,
) -> tuple[Linearization, float, Signs]:
    """The first point, step length and signs; binds the evaluator.

    `u`: the start; `start`: one with direction. `StartError` if no branch has that direction.
    """
    try:
        if start is not None:
            signs = _signs_beside(pieces, *start)
            solver.evaluator.bind(pieces.piece(signs))
            return *point_from_tangent(solver, start, metric, target), signs
        signs = pieces.signs(u)
        for _ in range(PIECES):
            solver.evaluator.bind(pieces.piece(signs))
            point, h = first_point(solver, u, metric, direction, target)
            s = pieces.values(point.u)
            zero = np.abs(s) <= switch_noise(solver, pieces, point)
            if (zero | (s * signs > 0.0)).all():
                break
            signs = pieces.signs(point.u)
        else:
            raise StartError("It is on one piece before it is corrected, and on another one afterwards.")
    except SwitchError as error:
        raise StartError(f"At the start {error}.") from error
    if not zero.any():
        return point, h, signs
    wanted = direction or (1 if target is None or target >= u[-1] else -1)
    point, signs = _out_of_kink(solver, pieces, point, signs, tuple(np.flatnonzero(zero).tolist()), wanted)
    return point, h, signs


def _out_of_kink(
    solver: PathSolver, pieces: Pieces, point: Linearization, signs: Signs, beta: tuple[int, ...], wanted: int
) -> tuple[Linearization, Signs]:
    """The branch that leaves a kink in the wanted direction with the fastest parameter."""
    evaluator = solver.evaluator
    try:
        here = linearize(evaluator, point.u, point.weights, point.border)
        leaving = [ray for ray in rays_at(Corner(pieces, evaluator, here, signs, beta)) if ray.v[-1] * wanted > 0.0]
        if not leaving:
            raise SingularStartError("It is a kink, from which no branch leaves in the direction asked for.")
        ray = max(leaving, key=lambda ray: abs(float(ray.v[-1])))
        evaluator.bind(pieces.piece(ray.signs))
        return linearize(evaluator, point.u, point.weights, point.weights * ray.v), ray.signs
    except UnresolvedError as error:
        raise SingularStartError(f"It is a kink. {error}") from error
    except EvaluationError as error:
        raise SingularStartError(f"It is a kink, and {error}.") from error


def _signs_beside(pieces: Pieces, u: Array, v: Array) -> Signs:
    return pieces.signs(u + v * (ROOT_OF_ROUND_OFF * max(1.0, float(np.abs(u).max()) / float(np.abs(v).max()))))


def kink_rays(homotopy: Any, u: Array) -> Array:
    """All branches of a piecewise smooth map that leave a point of its path, as unit directions.

    Parameters
    ----------
    homotopy : SupportsPieces
    u : ndarray, shape (N + 1,)
        A point (y, lam) of the path.

    Returns
    -------
    ndarray, shape (k, N + 1)

    Raises
    ------
    ArithmeticError
        If the branches cannot be determined.
    """
    if not isinstance(homotopy, SupportsPieces) or isinstance(homotopy, type):
        raise complain(TypeError, "homotopy", "one with `switches` and `piece`", homotopy)
    pieces, counts = Pieces(homotopy), Counts()
    evaluator = Evaluator(homotopy, counts)
    u = real_vector("u", u)
    if u.shape != evaluator.start().shape or not np.isfinite(u).all():
        raise complain(ValueError, "u", f"{evaluator.start().size} finite numbers (y, lam)", u)
    signs = pieces.signs(u)
    evaluator.bind(pieces.piece(signs))
    ones = np.ones_like(u)
    border = np.random.default_rng(7).standard_normal(u.size)
    here = linearize(evaluator, u, ones, border)
    solver = PathSolver(evaluator, Tolerance())
    zero = np.flatnonzero(np.abs(pieces.values(u)) <= switch_noise(solver, pieces, here))
    if not zero.size:
        return np.array([here.tangent, -here.tangent])
    here = linearize(evaluator, u, ones, here.border)
    found = rays_at(Corner(pieces, evaluator, here, signs, tuple(zero.tolist())))
    return np.array([ray.v for ray in found]).reshape(-1, u.size)
