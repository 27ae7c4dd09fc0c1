"""The start of a curve."""

from __future__ import annotations

from typing import Any

import numpy as np

from continuation.arguments.checks import complain, real_vector
from continuation.arrays import Array, Matrix
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.evaluation.products import sizes
from continuation.linear.spectrum import nearest_zero
from continuation.path.steps import LocatedEvent
from continuation.point.projection import PathSolver
from continuation.status import Kind
from continuation.step.start import at_parameter
from continuation.tolerance import Tolerance

BY_KIND = (Kind.TURNING_POINT, Kind.BRANCH_POINT, Kind.KINK, Kind.HOPF)
NEAREST = 40
"""Eigenvalues nearest to zero among which a Hopf pair is searched: the others are far on the stable side."""

NEAR_AXIS = 0.1
"""Largest real part of a pair, relative to its modulus, for Newton's method."""


def as_event(value: Any) -> Any:
    """The kind of an event that defines the condition, else the event."""
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
    """The pair (y, lam) as numbers."""
    if hasattr(at, "u"):
        at = (at.u[:-1], float(at.u[-1]))
    if not isinstance(at, tuple | list) or len(at) != 2 or np.ndim(at[1]):
        raise complain(TypeError, name, "a located event, a step, or a pair (y, lam)", at)
    y, lam = np.atleast_1d(real_vector(name, at[0])), float(real_vector(name, at[1]))
    if y.ndim != 1 or not (np.isfinite(y).all() and np.isfinite(lam)):
        raise complain(ValueError, name, "finite numbers", at)
    return y, lam


def as_size(size: Any, at: Any, u: Array) -> Array:
    """Scales of the components of `u`: given, else from the metric of the event `at`, else their sizes."""
    if size is None:
        weights = getattr(at, "weights", None)
        return sizes(u) if weights is None else np.asarray(1.0 / np.sqrt(weights))
    found = real_vector("size", size)
    if found.shape != u.shape or not (found > 0.0).all():
        raise complain(ValueError, "size", f"{u.size} positive numbers", size)
    return found


def corrected(homotopy: Any, u: Array) -> Array:
    """Unknowns after Newton's method at fixed parameter; the guess if it fails."""
    try:
        with np.errstate(all="ignore"):
            return at_parameter(PathSolver(Evaluator(homotopy, Counts()), Tolerance()), u)[:-1]
    except ArithmeticError:
        return u[:-1]


def frequency_at(H_y: Matrix) -> float:
    """Imaginary part of the pair nearest to the axis; ValueError without one."""
    values = nearest_zero(H_y, NEAREST)
    pairs = values[values.imag > 0.0]
    off = np.abs(pairs.real) / np.abs(pairs)
    if not pairs.size or off.min() > NEAR_AXIS:
        found = f"{pairs[int(np.argmin(off))]:.3g}" if pairs.size else "none that is not real"
        raise ValueError(f"at: expected a pair of eigenvalues of H_y near the imaginary axis, found {found}")
    return float(pairs[int(np.argmin(off))].imag)
