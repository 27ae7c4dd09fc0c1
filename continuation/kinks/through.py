"""Continues a path through a kink."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import SIX_DIGITS, Array
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.pieces import Pieces, Signs
from continuation.kinks.rays import Corner, Ray, UnresolvedError, rays_at
from continuation.metric import inner, norm, share
from continuation.point.linearization import Linearization, linearize
from continuation.point.projection import PathSolver

STILL = SIX_DIGITS * SIX_DIGITS
"""Parameter's share of a tangent that is round-off."""


@frozen(eq=False)
class Crossing:
    """A kink, resolved as far as possible.

    `at`: with the incoming tangent. `switches`: those that vanish. `rays`, (k, N + 1): back, onward, others. `onward`:
    on the next piece, with its `signs`, or None. `reason`: why rays may be missing.
    """

    at: Linearization
    switches: tuple[int, ...]
    rays: Array
    onward: Linearization | None = None
    signs: Signs = ()
    reason: str = ""

    @property
    def name(self) -> str:
        """The kink's kind."""
        if self.onward is None:
            return "unresolved kink" if self.reason else "dead end"
        if len(self.rays) > 2:
            return "branching kink"
        if min(share(p.weights, p.tangent) for p in (self.at, self.onward)) <= STILL:
            return "kink"
        turns = self.onward.tangent[-1] * self.at.tangent[-1] < 0.0
        return "turning kink" if turns else "kink"


def cross(
    solver: PathSolver, pieces: Pieces, signs: Signs, point: Linearization, orientation: int, beta: tuple[int, ...]
) -> Crossing:
    """Resolve a kink.

    The path continues on the straightest branch with its determinant's sign, as if the map were perturbed (Allgower and
    Georg, Section 2.1). `solver`, `signs`: of the incoming piece. `beta`: vanishing switches.
    """
    back = -point.tangent[None]
    try:
        here = linearize(solver.evaluator, point.u, point.weights, point.border)
        corner = Corner(pieces, solver.evaluator, here, signs, beta)
        back = -here.tangent[None]
        found = [ray for ray in rays_at(corner, come=True) if norm(here.weights, ray.v - back[0]) > SIX_DIGITS]
        leaving = [_linearized(corner, ray) for ray in found]
    except UnresolvedError as error:
        return Crossing(point, beta, back, reason=str(error))
    except EvaluationError as error:
        return Crossing(point, beta, back, reason=f"A derivative there cannot be used: {error}.")
    rays = np.vstack([back, *(p.tangent for p in leaving)])
    if not leaving:
        return Crossing(point, beta, rays)
    wanted = [k for k, p in enumerate(leaving) if orientation == 0 or p.orientation in (0, orientation)]
    if not wanted:
        reason = "The determinant has another sign on every branch that leaves: one of them is not found."
        return Crossing(point, beta, rays, reason=reason)
    first = max(wanted, key=lambda k: inner(here.weights, here.tangent, leaving[k].tangent))
    order = [0, first + 1, *(k + 1 for k in range(len(leaving)) if k != first)]
    return Crossing(point, beta, rays[order], leaving[first], found[first].signs)


def _linearized(corner: Corner, ray: Ray) -> Linearization:
    point, evaluator = corner.point, corner.on(ray.signs)
    there = linearize(evaluator, point.u, point.weights, point.weights * ray.v)
    off = norm(point.weights, there.solve(-evaluator.residual(point.u)))
    if off > SIX_DIGITS:
        raise UnresolvedError(f"The pieces do not agree there: the next one is off by {off:.1g}.")
    if norm(point.weights, there.tangent - ray.v) > np.sqrt(SIX_DIGITS):
        raise UnresolvedError("A ray of the pieces' low-rank changes is not one of the piece itself.")
    return there
