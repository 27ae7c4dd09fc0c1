"""Looks at H' along a predicted arc, and behind its end: how near to singular it is, and where it seems to be so."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.contraction import RELIABLE
from continuation.evaluation.errors import EvaluationError
from continuation.events.crossing import EIGENVALUE_ACCURACY, SAME, peak_between, singular_places
from continuation.point.arc import Arc
from continuation.point.projection import PathSolver
from continuation.predictors import Prediction
from continuation.step.state import State
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

GROWN = 4.0
"""So many looks back of the beginning places are asked for: where H' is farther from singular by a quarter of what it
was, the look may have gone over a pair of crossings."""

DOUBTFUL = 0.1
"""Where the corrector contracts less well than this, and H' changes much, the arc's end must be what was expected."""

BEYOND = 1.15
"""So far the places are believed, in arcs."""

END_MARGIN = 1e-3
"""Extrapolated, a crossing that is nearer to the arc's end than this is in it."""

NEAR_CROSSING = 0.1
"""From so near to a crossing, in steps, the next one begins badly: past it the factorisation at hand has a part of the
wrong sign, and ten times too small."""

NEXT = 2.0
"""A look that was added is believed so many times as far as it is, where another one was."""

BETTER_PLACES, CLOSE = 4, 0.03
"""At most so many better places of one crossing are sought, until they change by less than the other."""

ONWARD = 0.1
"""So far behind the arc's end, in arcs, H' is compared with that there, to look back."""

END_ROUNDING = 1e-3
"""Of what lies ahead of the arc's end nothing is asked."""


@frozen(eq=False)
class Looks:
    """With the parts they need."""

    solver: PathSolver

    def along(self, arc: Arc, attempt: Arrival, prediction: Prediction, state: State) -> dict[float, list[float]]:
        """The places that each look along the prediction shows, in arcs; the first look alone where it shows none.

        Parameters
        ----------
        arc, attempt, prediction
        state : State
            At the beginning. Where something was seen near the arc before there are more looks, though the first shows
            none, and nearer to the beginning as long as H' is farther from singular there: twice as far as a pair of
            crossings it is as it was, and four times as far nine times as much.
        """
        closely = state.near
        contracts, size = attempt.correction.contraction <= RELIABLE, attempt.correction.contraction
        least, found = CHANGED if contracts else 0.5 * CHANGED, {}
        series = hasattr(prediction, "segment")
        planned = EIGHTHS if series else LOOKS
        looks = list(planned)
        for k, at in enumerate(looks):
            if (apply := self.derivative(prediction(at * attempt.h))) is None:
                break
            first = k < len(planned)
            ahead = max(BEYOND / at, 1.0 / least) if first else NEXT
            halved = closely and at <= (1.0 if series else 2.0) * min(looks) and math.frexp(at)[0] == LOOKS[0]
            behind, accuracy = GROWN if halved else np.inf, EIGENVALUE_ACCURACY if first else SAME
            there = singular_places(arc.a, apply, arc.a.border, ahead, behind, accuracy, state.index + k)
            places = [at * t for t in there]
            found[at] = [t for t in places if t > 0.0]
            if not (found[LOOKS[0]] or series or closely) and size <= DOUBTFUL:
                break
            if halved and len(found[at]) < len(places) and 0.25 * at not in looks and len(looks) < MOST_LOOKS:
                looks.append(0.25 * at)
            if series and len(planned) <= len(found) == len(looks) < MOST_LOOKS:
                peak = peak_between(found, END_MARGIN)
                looks += [] if peak is None else [peak]
        return found

    def derivative(self, u: Array) -> Callable[[Array], Array] | None:
        """The map v -> H' v at a point; None where there is none."""
        try:
            return self.solver.evaluator.differential(u)
        except EvaluationError:
            return None

    def continues(self, arc: Arc, looked: dict[float, list[float]]) -> bool:
        """Whether the matrix at the arc's end is what the looks along the prediction lead to expect, no crossing near.

        On the other branch it is about as far from singular, on the other side.
        """
        if len(looked) < len(LOOKS) or (apply := self.derivative(arc.b.u)) is None:
            return False
        first = {at: at / places[0] if places else 0.0 for at, places in looked.items()}
        # The cubic through these and 0 at the beginning.
        expected = 4.0 * first[0.75] - 6.0 * first[0.5] + 4.0 * first[0.25]
        there = singular_places(arc.a, apply, arc.b.border, 1.0 / CHANGED)
        found = 1.0 / there[0] if there else 0.0
        return abs(found - expected) <= 0.5 * abs(1.0 - found) and abs(1.0 - found) > NEAR_CROSSING

    def behind(self, arc: Arc) -> float | None:
        """Where on the arc the bordered matrix seems to have been singular, seen from its end and a little farther on.

        Where two branches are as near to each other as the prediction is to either, looks along the prediction tell
        little. The end is on one of them: if that comes from a crossing on the arc, the matrix there gets more regular.
        """
        b = arc.b
        if (apply := self.derivative(arc.segment.at(1.0 + ONWARD))) is None:
            return None
        places = [1.0 + ONWARD * t for t in singular_places(b, apply, b.border, END_ROUNDING, 1.0 / ONWARD)]
        return max((t for t in places if t < 1.0), default=None)

    def refined(self, arc: Arc, attempt: Arrival, prediction: Prediction, t: float) -> float:
        """A place nearer to the crossing: looked at from the beginning again, where it seems to be."""
        for _ in range(BETTER_PLACES):
            apply = self.derivative(prediction(t * attempt.h))
            if apply is None or not (places := singular_places(arc.a, apply, arc.a.border, 2.0)):
                break
            nearest = min(places, key=lambda place: abs(place - 1.0))
            t = min(t * nearest, BEYOND)
            if abs(nearest - 1.0) < CLOSE:
                break
        return t
