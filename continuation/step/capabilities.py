"""Checked calls of a homotopy's `max_step`, `observe` and `finish`."""

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


def max_step_of(homotopy: Any) -> MaxStep | None:
    """The homotopy's `max_step`, or None.

    TypeError or ValueError unless it gives numbers: NaN would shorten steps forever.
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
            # An overflowing prediction is nowhere inside.
            return 0.0
        return h

    return room


def observe_of(homotopy: Any) -> Callable[[Array, float], Mapping[str, float]] | None:
    """The homotopy's `observe`, or None.

    TypeError unless it maps names to numbers; ValueError if the names change: they are archive columns.
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
    """The given finish, else the homotopy's, or None; ValueError unless it gives None or N finite numbers."""
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
"""Largest residual at a `finish`'s end, relative to the equation's terms; false ends have about 1."""


def checked_end(evaluator: Evaluator, here: Array, y: Array, target: float | None) -> Array:
    """Return the end (y, lam) found by a `finish`; ValueError unless H vanishes there.

    Each equation must be small relative to its terms, or no larger than at the last point with the end's parameter:
    terms such as x_i w_i may vanish.
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
