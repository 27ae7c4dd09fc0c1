"""What crosses an accepted arc: the branch points on it, each polished, or why the arc does not count.

A step past a crossing may arrive on either branch, whichever Newton's method found. On its own branch the determinant's
sign has changed, on the other it has not; so what lies on the arc decides, and not where it ends.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array, largest
from continuation.contraction import RELIABLE
from continuation.correctors.base import far_from_round_off
from continuation.evaluation.evaluator import EvaluationError
from continuation.events.crossing import eigenvalues_along, multiplicity, peak_between, singular_places
from continuation.events.singularity import SimpleBranchPoint, branch_point_near, row_sizes
from continuation.metric import norm
from continuation.point.arc import Arc, position
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction
from continuation.rejection import Rejected, Rejection
from continuation.step.stepper import Arrival

LOOKS = 0.5, 0.25, 0.75
"""Where on the predicted arc H' is compared with that at its beginning: half way the prediction is sixteen times nearer
to the path than at its end, where it may lie on the other branch. From there the places are extrapolated."""

EIGHTHS = (*LOOKS, 0.125, 0.375, 0.625, 0.875)
"""The same for a series, whose steps reach over more than a cubic's, and cost as many solves as it has terms."""

STRIDE = 0.125
"""Between these."""

MOST_LOOKS = 12
"""Between two looks may lie a pair of crossings, if the first leads to expect one there, and the second knows nothing
of it: a parabola says where to look again, so many times in all."""

CHANGED = 0.25
"""Where H' has changed by more than this part half way, it is looked at on either side too, since two crossings may lie
before and one behind: on 3,200 steps of acceptance problems that is one in forty. Half as much will do where the
corrector contracts badly, as it does between two branches."""

DOUBTFUL = 0.1
"""Where the corrector contracts less well than this, and H' changes much, the arc's end must be what was expected."""

REFINEMENTS, CLOSE = 4, 0.03
"""At most so many better places of one crossing are sought, until they change by less than the other."""

BEYOND = 1.15
"""So far the places are believed, in arcs."""

ONWARD = 0.1
"""So far behind the arc's end, in arcs, H' is compared with that there, to look back."""

TINY = 1e-3
"""Of what lies ahead of the arc's end nothing is asked."""

NEAR_ARC = 2e-2
"""How far from the arc a branch point on it may lie, in its lengths: five times what an arc may be off the path."""

ON_PATH = 1e-13
"""Of the path's extent: a branch point this near to a zero of H is one, whatever its equations are made of there."""

APART = 1e-3
"""Extrapolated, a crossing that is nearer to the arc's end than this is in it."""

BESIDE = 0.1
"""From so near to a crossing, in steps, the next one begins badly: past it the factorisation at hand has a part of the
wrong sign, and ten times too small."""

PASSES, LOCATED = 60, 1e-12
"""A point where H' loses several ranks is no regular zero of a system of ours: its place on the arc is iterated, to the
second of an arc, each time by a part of what was off."""

AT_END = 1e-6
"""Of an arc: so near to its end a crossing is at the end, which is known there to half of the digits only."""

AWAY = 0.7
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


@frozen(eq=False)
class Crossings:
    """Looks for them, with the parts it needs."""

    solver: PathSolver

    def on_arc(
        self, arc: Arc, attempt: Arrival, prediction: Prediction, flipped: bool, ends: bool, before: bool
    ) -> Crossed | Rejected | None:
        """The branch point on an arc, if there is one; or why the arc does not count, and which step to try.

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
        """
        # An arc that was cut, as at a kink, is the beginning of what was predicted.
        if arc.b is not attempt.point:
            attempt = evolve(attempt, h=attempt.h * position(arc, arc.b.u) / position(arc, attempt.point.u))
        looked, series = self._looked(arc, attempt, prediction), hasattr(prediction, "segment")
        seen = looked
        if series:
            # So near to the path they need not be extrapolated far: a place counts where a look is behind it.
            looked = {at: [t for t in there if t < at + STRIDE] for at, there in seen.items()}
        places = max(([t for t in found if t < BEYOND] for found in looked.values()), key=len, default=[])
        if flipped and not places and (apply := self._derivative(arc.b.u)) is not None:
            places = singular_places(arc.a, apply, arc.b.border, 1.0)
        guesses, places = places, [t for t in places if not ends or t < 1.0]
        if ends and not (places or flipped):
            return None
        if not ends and any(abs(t - 1.0) < APART for t in places):
            return _rejected(attempt, Rejection.AT_CROSSING, AWAY)
        inside = [t for t in places if t < 1.0]
        apart = [t for t in inside if t - inside[0] >= APART]
        if apart:
            return _rejected(attempt, Rejection.CROSSINGS, 0.5 * (inside[0] + apart[0]))
        together = self._counted(arc, inside, flipped)
        if inside and not together:
            # Along the prediction a branch crosses, and the arc's end knows nothing of it: it is looked at from nearer.
            return _rejected(attempt, Rejection.ORIENTATION, inside[0])
        if len(together) > 1:
            return self._together(arc, attempt, prediction, together, flipped)
        changing = series or bool(looked.get(LOOKS[0]))
        doubtful = changing and len(looked) >= len(LOOKS) and attempt.correction.contraction > DOUBTFUL
        # A series is so near to the path that its looks tell all.
        passed = [there[0] for at, there in sorted(looked.items()) if there and there[0] <= at] if series else []
        if not flipped:
            whole = series and not passed and self._continues(arc, seen)
            if whole:
                return None
            if not (places or doubtful):
                # Between two crossings the branches may be nearer to each other than a prediction is to either.
                back = before and not series and (behind := self._behind(arc)) is not None and behind > 0.0
                return _rejected(attempt, Rejection.ORIENTATION, 0.5) if back else None
        found = None
        if places or flipped:
            t = self._refined(arc, attempt, prediction, (passed or inside or places or guesses or [LOOKS[0]])[0])
            found = self._found(arc, prediction(t * attempt.h))
        if found is None and not flipped and (behind := self._behind(arc)) is not None:
            found = self._found(arc, arc.segment.at(behind))
        if found is None and flipped and inside and len(lost := self._multiple(arc, inside)) > 1:
            return self._together(arc, attempt, prediction, lost, flipped)
        if found is None:
            return _rejected(attempt, Rejection.ORIENTATION, 0.5) if flipped or inside or doubtful else None
        at = position(arc, found.u) / position(arc, arc.b.u)
        if ends and 1.0 < at <= 1.0 + AT_END:
            return None
        if not ends and abs(at - 1.0) < BESIDE:
            return _rejected(attempt, Rejection.AT_CROSSING, AWAY)
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
        if (between := self._more(arc, seen, at)) is not None:
            return _rejected(attempt, Rejection.CROSSINGS, between)
        return self._point(arc, found, at)

    def _more(self, arc: Arc, seen: dict[float, list[float]], at: float) -> float | None:
        """A place on the arc between the crossing found and another one; None where it explains all that was seen.

        The largest eigenvalue passes one where branches cross: between two looks, or behind the last one.
        """
        apply = self._derivative(arc.b.u)
        there = [] if apply is None else singular_places(arc.a, apply, arc.b.border, 1.0 / CHANGED)
        times, values = eigenvalues_along({**seen, 1.0: there})
        changes = [times[k : k + 2] for k in np.flatnonzero(np.diff(values > 1.0))]
        if len(changes) > 1:
            return float(changes[0][1])
        if changes and not changes[0][0] - BESIDE < at < changes[0][1] + BESIDE:
            return 0.5 * (at + float(changes[0].mean()))
        return None

    def _counted(self, arc: Arc, places: list[float], flipped: bool) -> list[float]:
        """The same places, each as often as H' loses a rank there, if their number does not agree with the sign."""
        return places if not places or flipped == bool(len(places) % 2) else self._multiple(arc, places)

    def _multiple(self, arc: Arc, places: list[float]) -> list[float]:
        """The first of some places as often as H' loses a rank there; all of them where that cannot be told."""
        if (apply := self._derivative(arc.b.u)) is None:
            return places
        there = singular_places(arc.a, apply, arc.b.border, BEYOND)
        if not there or abs(there[0] - places[0]) > BESIDE:
            return places
        return multiplicity(arc.a, apply, arc.b.border, there[0]) * places[:1]

    def _together(
        self, arc: Arc, attempt: Arrival, prediction: Prediction, places: list[float], flipped: bool
    ) -> Crossed | Rejected:
        """Several crossings in about one place: a point where H' loses several ranks, or simple ones side by side.

        Which branch goes on is not asked there: the path passes if the determinant's sign agrees with their number, and
        the prediction was good, as it is along a branch that symmetry keeps.
        """
        t = self._refined(arc, attempt, prediction, places[0])
        if self._found(arc, prediction(t * attempt.h)) is not None:
            return _rejected(attempt, Rejection.CROSSINGS, 0.5 * (places[0] + places[1]))
        if flipped != bool(len(places) % 2) or attempt.correction.contraction > DOUBTFUL:
            return _rejected(attempt, Rejection.ORIENTATION, 0.5)
        moved = np.inf
        for _ in range(PASSES):
            u, _ = self.solver.project(arc.a, prediction(t * attempt.h), arc.a.border)
            if (apply := self._derivative(u)) is None:
                break
            found = singular_places(arc.a, apply, arc.a.border, 2.0, accuracy=LOCATED)
            if not found:
                break
            before, t = t, t * min(found, key=lambda place: abs(place - 1.0))
            last, moved = moved, abs(t - before)
            # What no longer falls is round-off, which is more than that where zero is far away.
            if moved <= LOCATED or moved >= last:
                break
        tangent = arc.segment.derivative(t)
        return Crossed(evolve(arc.a, u=u, tangent=tangent / norm(arc.a.weights, tangent)), None)

    def _looked(self, arc: Arc, attempt: Arrival, prediction: Prediction) -> dict[float, list[float]]:
        """The places that each look along the prediction shows, in arcs; the first look alone where it shows none."""
        contracts = attempt.correction.contraction <= RELIABLE
        least, found = CHANGED if contracts else 0.5 * CHANGED, {}
        series = hasattr(prediction, "segment")
        looks = list(EIGHTHS if series else LOOKS)
        for k, at in enumerate(looks):
            if (apply := self._derivative(prediction(at * attempt.h))) is None:
                break
            ahead = max(BEYOND / at, 1.0 / least)
            found[at] = [at * t for t in singular_places(arc.a, apply, arc.a.border, ahead, turned=k)]
            if not found[LOOKS[0]] and not series and attempt.correction.contraction <= DOUBTFUL:
                break
            if series and len(EIGHTHS) <= len(found) == len(looks) < MOST_LOOKS:
                peak = peak_between(found, APART)
                looks += [] if peak is None else [peak]
        return found

    def _derivative(self, u: Array) -> Callable[[Array], Array] | None:
        """The map v -> H' v at a point; None where there is none."""
        try:
            return self.solver.evaluator.differential(u)
        except EvaluationError:
            return None

    def _continues(self, arc: Arc, looked: dict[float, list[float]]) -> bool:
        """Whether the matrix at the arc's end is what the looks along the prediction lead to expect, no crossing near.

        On the other branch it is about as far from singular, on the other side.
        """
        if len(looked) < len(LOOKS) or (apply := self._derivative(arc.b.u)) is None:
            return False
        first = {at: at / places[0] if places else 0.0 for at, places in looked.items()}
        # The cubic through these and 0 at the beginning.
        expected = 4.0 * first[0.75] - 6.0 * first[0.5] + 4.0 * first[0.25]
        there = singular_places(arc.a, apply, arc.b.border, 1.0 / CHANGED)
        found = 1.0 / there[0] if there else 0.0
        return abs(found - expected) <= 0.5 * abs(1.0 - found) and abs(1.0 - found) > BESIDE

    def _behind(self, arc: Arc) -> float | None:
        """Where on the arc the bordered matrix seems to have been singular, seen from its end and a little farther on.

        Where two branches are as near to each other as the prediction is to either, looks along the prediction tell
        little. The end is on one of them: if that comes from a crossing on the arc, the matrix there gets more regular.
        """
        b = arc.b
        if (apply := self._derivative(arc.segment.at(1.0 + ONWARD))) is None:
            return None
        places = [1.0 + ONWARD * t for t in singular_places(b, apply, b.border, TINY, 1.0 / ONWARD)]
        return max((t for t in places if t < 1.0), default=None)

    def _refined(self, arc: Arc, attempt: Arrival, prediction: Prediction, t: float) -> float:
        """A place nearer to the crossing: looked at from the beginning again, where it seems to be."""
        for _ in range(REFINEMENTS):
            apply = self._derivative(prediction(t * attempt.h))
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
            found = branch_point_near(evaluator, guess, arc.b.u - a.u, a.weights, rows)
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

    def _point(self, arc: Arc, found: SimpleBranchPoint, at: float) -> Crossed:
        """The branch point as a point of the path, its tangent that of the branch which goes on."""
        rays = found.rays(arc.segment.derivative(at), arc.a.weights)
        return Crossed(evolve(arc.a, u=found.u, tangent=rays[1]), rays)


def _rejected(attempt: Arrival, reason: Rejection, factor: float) -> Rejected:
    return Rejected(attempt.h, reason, contraction=attempt.correction.contraction, factor=max(factor, SHORTEST))
