"""What crosses an accepted arc: the branch points on it, each polished, or why the arc does not count.

A step past a crossing may arrive on either branch, whichever Newton's method found. On its own branch the determinant's
sign has changed, on the other it has not; so what lies on the arc decides, and not where it ends.
"""

from __future__ import annotations

import numpy as np
from attrs import evolve, field, frozen

from continuation.arrays import Array, largest
from continuation.correctors.base import far_from_round_off
from continuation.evaluation.errors import EvaluationError
from continuation.events.crossing import eigenvalues_along, multiplicity, singular_places
from continuation.events.singularity import SimpleBranchPoint, branch_point_near, row_sizes
from continuation.metric import norm
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection
from continuation.step.looks import BEYOND, CHANGED, DOUBTFUL, END_MARGIN, LOOKS, NEAR_CROSSING, STRIDE, Looks
from continuation.step.state import State
from continuation.step.stepper import Arrival

NEAR_ARC = 2e-2
"""How far from the arc a branch point on it may lie, in its lengths: five times what an arc may be off the path."""

ON_PATH = 8 * float(np.finfo(float).eps)
"""Of the rows of H' over the arc: so little of H is round-off, also where all that H is made of vanishes at the point.
At true crossings at most 3e-16 was seen; with 1e-13 curves 2e-6 apart were said to cross."""

EXTRAPOLATED_PAIR = 1.5
"""A pair of crossings near the beginning of the next arc, where half way nothing is seen of it (in .27 of that arc at
most), is extrapolated to less than this from half way along the arc before, if the next is not six times as long."""

TOUCHES = 0.75
"""From there on a largest eigenvalue along a series may have passed one and come back between two looks an eighth of
the arc apart, where the branches cross twice: a branch point is sought there."""

PASSES, PLACE_ON_ARC = 60, 1e-12
"""A point where H' loses several ranks is no regular zero of a system of ours: its place on the arc is iterated, to the
second of an arc, each time by a part of what was off."""

AT_END = 1e-6
"""Of an arc: so near to its end a crossing is at the end, which is known there to half of the digits only."""

STEP_BACK = 0.7
"""The factor of a step that arrived so near to a crossing that nothing can be said there."""

OVER, SHORT = 0.4, 0.5
"""A crossing in the first part of an arc that came out on the other branch is stepped over by as much again: there the
branches are as far apart as they were. One farther on is first approached, to half the way."""

SHORTEST = 0.1
"""The least factor of a step: a place next to the arc's beginning may be round-off, and would end the path at once."""


@frozen(eq=False)
class Crossed:
    """A branch point on an arc.

    Attributes
    ----------
    point : Linearization
        Of the path; the factorisation is that of the arc's beginning.
    rays : ndarray, shape (4, N + 1), or None
        The directions of the branches that meet there, of unit length in the metric, each pointing away from it: back,
        onward, and both of the other branch. None where H' loses several ranks at once: they are not known then.
    """

    point: Linearization
    rays: Array | None


@frozen
class Passed:
    """An arc on which, or ahead of which, something that crosses was seen; the branch point if one is on it."""

    branch: Crossed | None


@frozen(eq=False)
class Crossings:
    """Looks for them, with the parts it needs."""

    solver: PathSolver
    looks: Looks = field(init=False)

    @looks.default
    def _looks(self) -> Looks:
        return Looks(self.solver)

    def on_arc(
        self, arc: Arc, attempt: Arrival, prediction: Prediction, flipped: bool, ends: bool, before: bool, state: State
    ) -> Passed | Rejected | None:
        """The branch point on an arc, if there is one; or why the arc does not count, and which step to try.

        None where nothing that crosses was seen on the arc or ahead.

        Parameters
        ----------
        arc : Arc
        attempt : Arrival
            Where the arc ends.
        prediction : Prediction
            Of the arc.
        flipped : bool
            Whether the determinant's sign changes from its beginning to its end.
        ends : bool
            Whether the path ends where the arc does: what lies beyond does not count.
        before : bool
            Whether branches have crossed on this path already.
        state : State
            At the arc's beginning.
        """
        # An arc that was cut, as at a kink, is the beginning of what was predicted.
        if arc.b is not attempt.point:
            attempt = evolve(attempt, h=attempt.h * arc.length / position(arc, attempt.point.u))
        seen = self.looks.along(arc, attempt, prediction, state)
        found = self._examined(arc, attempt, prediction, seen, flipped, ends, before)
        if isinstance(found, Rejected):
            return found
        ahead = any(t < EXTRAPOLATED_PAIR for there in seen.values() for t in there)
        return Passed(found) if found is not None or ahead else None

    def _examined(
        self,
        arc: Arc,
        attempt: Arrival,
        prediction: Prediction,
        seen: dict[float, list[float]],
        flipped: bool,
        ends: bool,
        before: bool,
    ) -> Crossed | Rejected | None:
        """As for `on_arc`, with what was seen along the prediction."""
        looked, series, whole = seen, hasattr(prediction, "segment"), False
        if series:
            # So near to the path they need not be extrapolated far: a place counts where a look is behind it.
            looked = {at: [t for t in there if t < at + STRIDE] for at, there in seen.items()}
        places = max(([t for t in found if t < BEYOND] for found in looked.values()), key=len, default=[])
        if flipped and not places and (apply := self.looks.derivative(arc.b.u)) is not None:
            places = singular_places(arc.a, apply, arc.b.border, 1.0)
        guesses, places = places, [t for t in places if not ends or t < 1.0]
        if ends and not (places or flipped):
            return None
        if not ends and any(abs(t - 1.0) < END_MARGIN for t in places):
            return _rejected(attempt, Rejection.AT_CROSSING, STEP_BACK)
        inside = [t for t in places if t < 1.0]
        apart = [t for t in inside if t - inside[0] >= END_MARGIN]
        if apart:
            return _rejected(attempt, Rejection.CROSSINGS, 0.5 * (inside[0] + apart[0]))
        together = self._counted(arc, inside, flipped)
        if inside and not together:
            # Along the prediction a branch crosses, and the arc's end knows nothing of it: it is looked at from nearer.
            return _rejected(attempt, Rejection.ORIENTATION, min(inside[0], STEP_BACK))
        if len(together) > 1:
            return self._together(arc, attempt, prediction, together, flipped)
        changing = series or bool(looked.get(LOOKS[0]))
        doubtful = changing and len(looked) >= len(LOOKS) and attempt.correction.contraction > DOUBTFUL
        # A series is so near to the path that its looks tell all.
        passed = [there[0] for at, there in sorted(looked.items()) if there and there[0] <= at] if series else []
        if not flipped:
            whole = series and not passed and self.looks.continues(arc, seen)
            if whole and eigenvalues_along(seen)[1].max() < TOUCHES:
                return None
            if not (places or doubtful):
                # Between two crossings the branches may be nearer to each other than a prediction is to either.
                left = before and not series and (back := self.looks.behind(arc)) is not None and back > 0.0
                return _rejected(attempt, Rejection.ORIENTATION, 0.5) if left else None
        found = None
        if whole:
            # Newton's method from outside of a pair: between the two its system is singular.
            times, values = eigenvalues_along(seen)
            peak = int(values.argmax())
            found = self._found(arc, prediction(times[peak - 1 : peak + 1].mean() * attempt.h))
        elif places or flipped:
            t = self.looks.refined(arc, attempt, prediction, (passed or inside or places or guesses or [LOOKS[0]])[0])
            found = self._found(arc, prediction(t * attempt.h))
        back = None if flipped or whole or found is not None else self.looks.behind(arc)
        if back is not None:
            found = self._found(arc, arc.segment.at(back))
        if found is None and flipped and inside and len(lost := self._multiple(arc, inside)) > 1:
            return self._together(arc, attempt, prediction, lost, flipped)
        if found is None:
            # Where branches are nearly parallel Newton's method finds their crossing from nearby only.
            suspect = flipped or ((inside or doubtful) and not whole) or (back is not None and back > 0.0)
            return _rejected(attempt, Rejection.ORIENTATION, 0.5) if suspect else None
        at = position(arc, found.u) / arc.length
        if ends and 1.0 < at <= 1.0 + AT_END:
            return None
        if not ends and abs(at - 1.0) < NEAR_CROSSING:
            return _rejected(attempt, Rejection.AT_CROSSING, STEP_BACK)
        if at > 1.0:
            # What lies beyond does not change the sign on the arc, which left its branch.
            return _rejected(attempt, Rejection.ORIENTATION, 0.5) if flipped or passed else None
        if not flipped or doubtful:
            # With a second crossing behind it the sign is that of the other branch: how well the corrector contracts
            # tells the two apart.
            return _rejected(attempt, Rejection.OTHER_BRANCH, 2.0 * at if at < OVER else SHORT * at)
        if not series and found.branch_of(arc.a) != found.branch_of(arc.b):
            # The arc's end is on the other branch: a second crossing, of which nothing was seen, made its sign right.
            return _rejected(attempt, Rejection.CROSSINGS, 0.5 * (at + 1.0))
        if (more := self._more(arc, attempt, seen, at, ends)) is not None:
            return more
        return self._point(arc, found, at)

    def _more(
        self, arc: Arc, attempt: Arrival, seen: dict[float, list[float]], at: float, ends: bool
    ) -> Rejected | None:
        """Why an arc with a crossing does not count: another one on it or at its end; None where there is none.

        The largest eigenvalue passes one where branches cross: between two looks, or behind the last one.
        """
        apply = self.looks.derivative(arc.b.u)
        there = [] if apply is None else singular_places(arc.a, apply, arc.b.border, 1.0 / CHANGED)
        if not ends and any(abs(1.0 - 1.0 / t) < NEAR_CROSSING for t in there):
            return _rejected(attempt, Rejection.AT_CROSSING, STEP_BACK)
        times, values = eigenvalues_along({**seen, 1.0: there})
        changes = [times[k : k + 2] for k in np.flatnonzero(np.diff(values > 1.0))]
        if len(changes) > 1:
            return _rejected(attempt, Rejection.CROSSINGS, float(changes[0][1]))
        if changes and not changes[0][0] - NEAR_CROSSING < at < changes[0][1] + NEAR_CROSSING:
            return _rejected(attempt, Rejection.CROSSINGS, 0.5 * (at + float(changes[0].mean())))
        return None

    def _counted(self, arc: Arc, places: list[float], flipped: bool) -> list[float]:
        """The same places, each as often as H' loses a rank there, if their number does not agree with the sign."""
        return places if not places or flipped == bool(len(places) % 2) else self._multiple(arc, places)

    def _multiple(self, arc: Arc, places: list[float]) -> list[float]:
        """The first of some places as often as H' loses a rank there; all of them where that cannot be told."""
        if (apply := self.looks.derivative(arc.b.u)) is None:
            return places
        there = singular_places(arc.a, apply, arc.b.border, BEYOND)
        if not there or abs(there[0] - places[0]) > NEAR_CROSSING:
            return places
        return multiplicity(arc.a, apply, arc.b.border, there[0]) * places[:1]

    def _together(
        self, arc: Arc, attempt: Arrival, prediction: Prediction, places: list[float], flipped: bool
    ) -> Crossed | Rejected:
        """Several crossings in about one place: a point where H' loses several ranks, or simple ones side by side.

        Which branch goes on is not asked there: the path passes if the determinant's sign agrees with their number, and
        the prediction was good, as it is along a branch that symmetry keeps.
        """
        t = self.looks.refined(arc, attempt, prediction, places[0])
        if self._found(arc, prediction(t * attempt.h)) is not None:
            return _rejected(attempt, Rejection.CROSSINGS, 0.5 * (places[0] + places[1]))
        if flipped != bool(len(places) % 2) or attempt.correction.contraction > DOUBTFUL:
            return _rejected(attempt, Rejection.ORIENTATION, 0.5)
        moved = np.inf
        for _ in range(PASSES):
            u, _ = self.solver.project(arc.a, prediction(t * attempt.h), arc.a.border)
            if (apply := self.looks.derivative(u)) is None:
                break
            found = singular_places(arc.a, apply, arc.a.border, 2.0, accuracy=PLACE_ON_ARC)
            if not found:
                break
            before, t = t, t * min(found, key=lambda place: abs(place - 1.0))
            last, moved = moved, abs(t - before)
            # What no longer falls is round-off, which is more than that where zero is far away.
            if moved <= PLACE_ON_ARC or moved >= last:
                break
        tangent = arc.segment.derivative(t)
        return Crossed(evolve(arc.a, u=u, tangent=tangent / norm(arc.a.weights, tangent)), None)

    def _found(self, arc: Arc, guess: Array) -> SimpleBranchPoint | None:
        """The simple branch point on or just behind the arc that Newton's method finds from a guess."""
        a, evaluator = arc.a, self.solver.evaluator
        try:
            rows = row_sizes(evaluator, 1.0 / np.sqrt(a.weights), (a.u, arc.b.u))
            found = branch_point_near(evaluator, guess, arc.b.u - a.u, a.weights, rows)
            if found is None or (
                largest(evaluator.residual(found.u) / rows) > ON_PATH and far_from_round_off(evaluator, found.u)
            ):
                return None
        except EvaluationError:
            return None
        length = norm(a.weights, arc.b.u - a.u)
        at = position(arc, found.u) / arc.length
        if not 0.0 < at < BEYOND or norm(a.weights, found.u - arc.segment.at(at)) > NEAR_ARC * length:
            return None
        return found

    def _point(self, arc: Arc, found: SimpleBranchPoint, at: float) -> Crossed:
        """The branch point as a point of the path, its tangent that of the branch which goes on."""
        rays = found.rays(arc.segment.derivative(at), arc.a.weights)
        return Crossed(evolve(arc.a, u=found.u, tangent=rays[1]), rays)


def _rejected(attempt: Arrival, reason: Rejection, factor: float) -> Rejected:
    return Rejected(attempt.h, reason, contraction=attempt.correction.contraction, factor=max(factor, SHORTEST))
