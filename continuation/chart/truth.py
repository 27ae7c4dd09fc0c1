"""What is known of a path: in closed form, or from a trace at much higher accuracy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import POSITIVE
from continuation.arrays import Array
from continuation.path import Path
from continuation.step.presets import CONSERVATIVE
from continuation.tracing import trace

REFERENCE_TOLERANCE = 1e-11
"""The last Newton increment of a reference: the point after it is exact to round-off."""


@frozen(eq=False)
class Truth:
    """What is known of a path; None where it is not known.

    Attributes
    ----------
    end : ndarray, shape (N + 1,), or None
        The end point (y, lam).
    turning_points : ndarray, shape (k, N + 1), or None
        In the order of the path.
    arclength : float or None
        In the Euclidean metric of (y, lam).
    nearest : callable or None
        Points of shape (m, N + 1) near the curve to points of the curve beside them.
    within : float
        A path whose end is farther from `end` than this, relative to its size, has come to a wrong end.
    """

    end: Array | None = None
    turning_points: Array | None = None
    arclength: float | None = None
    nearest: Callable[[Array], Array] | None = None
    within: float = field(default=1e-2, validator=POSITIVE)


def reference(homotopy: Any, **options: Any) -> Truth:
    """The truth by a trace with short steps, Newton's own corrector and a tolerance near round-off.

    Parameters
    ----------
    homotopy : Homotopy
    **options
        As for `continuation.trace`: the target, the direction, the events that end the path.

    Raises
    ------
    ArithmeticError
        If the path does not arrive.
    """
    path: Path = trace(homotopy, **{"preset": CONSERVATIVE, "tolerance": REFERENCE_TOLERANCE, **options})
    if not path.success:
        raise ArithmeticError(f"the reference path did not arrive: {path.message}")
    turns = np.array([event.u for event in path.turning_points]).reshape(-1, path.endpoint.u.size)
    return Truth(end=path.endpoint.u, turning_points=turns)
