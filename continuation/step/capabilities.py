"""The homotopy's `max_step` and `finish` as the engine calls them: what they return is checked, and named if wrong."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from continuation.arguments.checks import complain, real_vector
from continuation.arrays import Array, finite
from continuation.evaluation.errors import EvaluationError
from continuation.evaluation.evaluator import POINT_ULPS, Evaluator
from continuation.homotopy import SupportsFinish, SupportsMaxStep, SupportsObserve, offers
from continuation.point.projection import MaxStep
from continuation.predictors import Predictor
from continuation.step.stepper import LOW_ORDER_FRACTION


def max_step_of(homotopy: Any) -> MaxStep | None:
    """The homotopy's `max_step`; None where its path has no boundary.

    The function returned raises TypeError or ValueError if the homotopy's gives anything but a number for a finite
    direction: with NaN every comparison fails, and a step is shortened for ever.
    """
    if not offers(homotopy, SupportsMaxStep):
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


def observe_of(homotopy: Any) -> Callable[[Array, float], Mapping[str, float]] | None:
    """The homotopy's `observe`, whose answers are checked; None where it has none.

    The function returned raises TypeError unless that one gives a mapping of names to real numbers, and ValueError if
    the names are not those of its first answer: they are columns of an archive.
    """
    if not offers(homotopy, SupportsObserve):
        return None
    observe = homotopy.observe
    names: set[str] = set()

    def seen(y: Array, lam: float) -> Mapping[str, float]:
        found: Any = observe(y, lam)
        if not isinstance(found, Mapping) or not all(isinstance(name, str) for name in found):
            raise complain(TypeError, "observe", "a mapping of names to numbers", found)
        for name, value in found.items():
            if np.ndim(value) or np.asarray(value).dtype.kind not in "fiub":
                raise complain(TypeError, "observe", f"a real number for {name!r}", value)
        names.update(found if not names else ())
        if found.keys() != names:
            raise complain(ValueError, "observe", f"the names of the first point, {sorted(names)}", sorted(found))
        return found

    return seen


def finish_of(
    homotopy: Any, given: Callable[[Array, float], Array | None] | None
) -> Callable[[Array, float], Array | None] | None:
    """The finish that was given, else the homotopy's own; None where there is neither.

    The function returned raises ValueError if that one gives neither None nor as many finite numbers as there
    are unknowns. Whether H vanishes there is `checked_end`'s to say.
    """
    own = homotopy.finish if offers(homotopy, SupportsFinish) else None
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


FALSE_END = 1e-3
"""Of the terms of an equation: what H may be at an end that a `finish` found. A certificate of the problem may allow
for much, and an end that is none misses by about all that its terms are."""


def checked_end(evaluator: Evaluator, here: Array, y: Array, target: float | None) -> Array:
    """The end that a `finish` found, (y, lam) at the target or where the path is, if H vanishes there.

    An equation is taken to hold where it is small among its own terms, or no worse than at the last point of the path,
    put at the end's parameter: terms that vanish themselves, as products x_i w_i do, tell nothing.

    Parameters
    ----------
    evaluator : Evaluator
    here : ndarray, shape (N + 1,)
    y : ndarray, shape (N,)
    target : float or None

    Raises
    ------
    ValueError
        If an equation does not hold.
    """
    end = np.append(y, here[-1] if target is None else target)
    try:
        residual = evaluator.residual(end)
        worse = np.abs(residual) > np.abs(evaluator.residual(np.append(here[:-1], end[-1])))
        if worse.any():
            terms = evaluator.round_off(end, residual) / (POINT_ULPS * np.finfo(float).eps)
            worse &= np.abs(residual) > FALSE_END * terms
    except EvaluationError as error:
        raise ValueError(f"finish: expected None or an end of the path, found a point where {error}") from error
    if worse.any():
        size = f"{np.abs(residual[worse]).max():.1e} in equation {int(np.argmax(np.abs(residual) * worse))}"
        raise ValueError(f"finish: expected None or an end of the path, found a point where H is {size}")
    return end


def interior_fraction(predictor: Predictor) -> float:
    """How much of the way to the boundary of its domain a prediction may go: what the predictor says, else 0.9."""
    fraction = getattr(predictor, "interior_fraction", LOW_ORDER_FRACTION)
    return float(fraction)
