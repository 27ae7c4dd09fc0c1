"""What crosses an accepted arc: the branch points on it, each polished, or why the arc does not count.

A step past a crossing may arrive on either branch, whichever Newton's method found. On its own branch the determinant's
sign has changed, on the other it has not; so what lies on the arc decides, and not where it ends.
"""

from __future__ import annotations

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array, largest
from continuation.correctors.base import far_from_round_off
from continuation.evaluation.evaluator import EvaluationError
from continuation.events.crossing import singular_places
from continuation.events.singularity import SimpleBranchPoint, branch_point_near, row_sizes
from continuation.metric import inner, norm
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection
from continuation.step.stepper import Arrival

LOOKS = 0.5, 0.25
"""Where on the predicted arc H' is compared with that at its beginning: half way the prediction is sixteen times nearer
to the path than at its end, where it may lie on the other branch. From there the places are extrapolated."""

CHANGED = 0.25
"""Where H' has changed by more than this part half way, it is looked at a quarter of the way too, since two crossings
may lie between: on 3,200 steps of acceptance problems that is one in forty."""

REFINEMENTS, CLOSE = 4, 0.03
"""At most so many better places of one crossing are sought, until they change by less than the other."""

BEYOND = 1.1
"""So far the places are believed, in arcs."""

NEAR_ARC = 2e-2
"""How far from the arc a branch point on it may lie, in its lengths: five times what an arc may be off the path."""

ON_PATH = 1e-13
"""Of the path's extent: a branch point this near to a zero of H is one, whatever its equations are made of there."""

APART = 1e-3
"""Crossings nearer to each other, or to the arc's end, than this part of the arc are not stepped between."""

AWAY = 0.7
"""The factor of a step that arrived so near to a crossing that nothing can be said there."""

OVER, SHORT = 0.4, 0.5
"""A crossing in the first part of an arc that came out on the other branch is stepped over by as much again: there the
branches are as far apart as they were. One farther on is first approached, to half the way."""


@frozen(eq=False)
class Crossings:
    """Looks for them, with the parts it needs."""

    solver: PathSolver

    def on_arc(self, arc: Arc, attempt: Arrival, prediction: Prediction, flipped: bool) -> list[Linearization] | Rejected:
        """The branch points on an arc, at most one; or why the arc does not count, and which step to try.

        Parameters
        ----------
        arc : Arc
        attempt : Arrival
            Where the arc ends.
        prediction : Prediction
            Of the arc.
        flipped : bool
            Whether the determinant's sign changes from its beginning to its end.
        """
        places = self._places(arc, attempt, prediction, flipped)
        if not places and not flipped:
            return []
        if any(abs(t - 1.0) < APART for t in places):
            return _rejected(attempt, Rejection.AT_CROSSING, AWAY)
        inside = [t for t in places if t < 1.0]
        if len(inside) > 1:
            first, second = inside[:2]
            return _rejected(attempt, Rejection.CROSSINGS, 0.5 * (first + second))
        t = self._refined(arc, attempt, prediction, (inside or places or [LOOKS[0]])[0])
        found = self._found(arc, prediction(t * attempt.h))
        if found is None:
            return _rejected(attempt, Rejection.ORIENTATION, 0.5) if flipped or inside else []
        at = position(arc, found.u) / position(arc, arc.b.u)
        if abs(at - 1.0) < APART:
            return _rejected(attempt, Rejection.AT_CROSSING, AWAY)
        if at > 1.0:
            return _rejected(attempt, Rejection.ORIENTATION, 0.5) if flipped else []
        if not flipped:
            return _rejected(attempt, Rejection.OTHER_BRANCH, 2.0 * at if at < OVER else SHORT * at)
        return [self._point(arc, found, at)]

    def _places(self, arc: Arc, attempt: Arrival, prediction: Prediction, flipped: bool) -> list[float]:
        """Where on the arc the bordered matrix seems to be singular, up to BEYOND."""
        if arc.b.anchor is arc.a.anchor:
            # One factorisation served both, in general position: nothing lies between (`relinearize`).
            return []
        found: list[float] = []
        for at in LOOKS:
            try:
                apply = self.solver.evaluator.differential(prediction(at * attempt.h))
            except EvaluationError:
                return found
            if apply is None:
                return []
            places = [at * t for t in singular_places(arc.a, apply, arc.a.border, max(BEYOND / at, 1.0 / CHANGED))]
            near = [t for t in places if t < BEYOND]
            found = near if len(near) >= len(found) else found
            if not places:
                break
        if flipped and not found and (apply := self.solver.evaluator.differential(arc.b.u)) is not None:
            found = singular_places(arc.a, apply, arc.b.border, 1.0)
        return found

    def _refined(self, arc: Arc, attempt: Arrival, prediction: Prediction, t: float) -> float:
        """A place nearer to the crossing: looked at from the beginning again, where it seems to be."""
        for _ in range(REFINEMENTS):
            apply = self.solver.evaluator.differential(prediction(t * attempt.h))
            if apply is None or not (places := singular_places(arc.a, apply, arc.a.border, 2.0)):
                break
            nearest = min(places, key=lambda place: abs(place - 1.0))
            t = min(t * nearest, BEYOND)
            if abs(nearest - 1.0) < CLOSE:
                break
        return t

    def _found(self, arc: Arc, guess: Array) -> SimpleBranchPoint | None:
        """The simple branch point on or just behind the arc that Newton's method finds from a guess."""
        a, evaluator = arc.a, self.solver.evaluator
        try:
            rows = row_sizes(evaluator, 1.0 / np.sqrt(a.weights), (a.u, arc.b.u))
            found = branch_point_near(evaluator, guess, a.weights, rows)
            if found is None or (
                largest(evaluator.residual(found.u) / rows) > ON_PATH and far_from_round_off(evaluator, found.u)
            ):
                return None
        except EvaluationError:
            return None
        length = norm(a.weights, arc.b.u - a.u)
        at = position(arc, found.u) / position(arc, arc.b.u)
        if not 0.0 < at < BEYOND or norm(a.weights, found.u - arc.segment.at(at)) > NEAR_ARC * length:
            return None
        return found

    def _point(self, arc: Arc, found: SimpleBranchPoint, at: float) -> Linearization:
        """The branch point as a point of the path, its tangent that of the branch which goes on."""
        weights, heading = arc.a.weights, arc.segment.derivative(at)
        along = [inner(weights, heading, d) for d in found.directions]
        k = int(np.argmax(np.abs(along)))
        tangent: Array = found.directions[k] * np.sign(along[k])
        return evolve(arc.a, u=found.u, tangent=tangent)


def _rejected(attempt: Arrival, reason: Rejection, factor: float) -> Rejected:
    return Rejected(attempt.h, reason, contraction=attempt.correction.contraction, factor=factor)
