"""The homotopy's `max_step` and `finish` as the engine calls them: what they return is checked, and named if wrong."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from continuation.arrays import Array, finite
from continuation.checks import complain, real_vector
from continuation.homotopy import SupportsFinish, SupportsMaxStep
from continuation.point.projection import MaxStep
from continuation.predictors import Predictor
from continuation.step.stepper import LOW_ORDER_FRACTION


def max_step_of(homotopy: Any) -> MaxStep | None:
    """The homotopy's `max_step`; None where its path has no boundary.

    The function returned raises TypeError or ValueError if the homotopy's gives anything but a number for a finite
    direction: with NaN every comparison fails, and a step is shortened for ever.
    """
    if not isinstance(homotopy, SupportsMaxStep):
        return None
    max_step = homotopy.max_step

    def room(u: Array, v: Array) -> float:
        found: Any = max_step(u, v)
        try:
            h = float(found)
        except (TypeError, ValueError):
            raise complain(TypeError, "max_step", "a number, at least 0, or inf", found) from None
        if math.isnan(h):
            if finite(v):
                raise complain(ValueError, "max_step", "a number, at least 0, or inf", found)
            # A prediction that overflows is no fault of the homotopy's; no part of it is inside.
            return 0.0
        return h

    return room


def finish_of(
    homotopy: Any, given: Callable[[Array, float], Array | None] | None
) -> Callable[[Array, float], Array | None] | None:
    """The finish that was given, else the homotopy's own; None where there is neither.

    The function returned raises ValueError if that one gives neither None nor as many finite numbers as there
    are unknowns. That H is small there is not asked for: an end is certified by the problem, whose certificate may be
    about some of the unknowns alone, as the x of a complementarity problem; the path's message says what H is.
    """
    own = homotopy.finish if isinstance(homotopy, SupportsFinish) else None
    finish = own if given is None else given
    if finish is None:
        return None

    def end(y: Array, lam: float) -> Array | None:
        found: Any = finish(y, lam)
        if found is None:
            return None
        vector = real_vector("finish", found)
        if vector.shape != y.shape or not np.isfinite(vector).all():
            raise complain(ValueError, "finish", f"None or {y.size} finite numbers", found)
        return vector

    return end


def interior_fraction(predictor: Predictor) -> float:
    """How much of the way to the boundary of its domain a prediction may go: what the predictor says, else 0.9."""
    fraction = getattr(predictor, "interior_fraction", LOW_ORDER_FRACTION)
    return float(fraction)
