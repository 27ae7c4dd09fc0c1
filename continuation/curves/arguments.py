"""What a curve is asked for: an event, and a point where it begins."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arguments.checks import complain, real_vector
from continuation.arrays import Array
from continuation.evaluation.products import sizes
from continuation.path.steps import LocatedEvent
from continuation.status import Kind

BY_KIND = (Kind.TURNING_POINT, Kind.BRANCH_POINT, Kind.KINK, Kind.HOPF)
"""What an event can be by its kind alone; of others the function is needed."""


def as_event(value: Any) -> Any:
    """The kind of an event where that says what holds, else the event itself."""
    kind = getattr(value, "kind", value)
    if isinstance(value, LocatedEvent):
        if kind == Kind.TURNING_POINT and value.name != "turning point":
            raise ValueError(f"event: a {value.name} is no fold; give TurningPoint(component), and the point as `at`")
    elif hasattr(value, "monitor") and (kind not in BY_KIND or getattr(value, "component", -1) != -1):
        return value
    if kind not in BY_KIND:
        expected = "a turning point, branch point, Hopf point or kink, located or as a Kind, or an event with a monitor"
        raise complain(TypeError, "event", expected, value)
    return Kind(kind)


def as_point(at: Any, name: str = "at") -> tuple[Array, float]:
    """The pair (y, lam), of numbers; `name` is that of the argument."""
    if hasattr(at, "u"):
        at = (at.u[:-1], float(at.u[-1]))
    if not isinstance(at, tuple | list) or len(at) != 2 or np.ndim(at[1]):
        raise complain(TypeError, name, "a located event, a step, or a pair (y, lam)", at)
    y, lam = np.atleast_1d(real_vector(name, at[0])), float(real_vector(name, at[1]))
    if y.ndim != 1 or not (np.isfinite(y).all() and np.isfinite(lam)):
        raise complain(ValueError, name, "finite numbers", at)
    return y, lam


def as_size(size: Any, at: Any, u: Array) -> Array:
    """How far each component goes: what was given, else the metric of the located event, else the point's size."""
    if size is None:
        weights = getattr(at, "weights", None)
        return sizes(u) if weights is None else np.asarray(1.0 / np.sqrt(weights))
    found = real_vector("size", size)
    if found.shape != u.shape or not (found > 0.0).all():
        raise complain(ValueError, "size", f"{u.size} positive numbers", size)
    return found
