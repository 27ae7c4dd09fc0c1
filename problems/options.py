"""Checks of the options of the problems, and the rule that overflow in an evaluation raises no warning."""

from __future__ import annotations

from numbers import Integral, Real
from typing import Any

import numpy as np
from attrs import Attribute

from continuation.arrays import Array

quiet = np.errstate(over="ignore", invalid="ignore")
"""Decorates an evaluation whose overflow is to give inf or nan without a warning: the tracer handles these."""


def positive_integer(instance: Any, attribute: Attribute[Any], value: Any) -> None:
    """Raise TypeError unless `value` is an integer, ValueError unless it is at least 1."""
    if not isinstance(value, Integral) or isinstance(value, bool):
        raise TypeError(f"{attribute.name}: expected an integer, found {value!r} ({type(value).__name__})")
    if value < 1:
        raise ValueError(f"{attribute.name}: expected at least 1, found {value}")


def finite(instance: Any, attribute: Attribute[Any], value: Any) -> None:
    """Raise TypeError unless `value` is a real number, ValueError unless it is finite."""
    if not isinstance(value, Real) or isinstance(value, bool):
        raise TypeError(f"{attribute.name}: expected a real number, found {value!r} ({type(value).__name__})")
    if not np.isfinite(float(value)):
        raise ValueError(f"{attribute.name}: expected a finite number, found {value}")


def finite_or_none(instance: Any, attribute: Attribute[Any], value: Any) -> None:
    """As `finite`, with None allowed: a path without a target."""
    if value is not None:
        finite(instance, attribute, value)


def finite_vector(name: str, value: Any, size: int | None = None) -> Array:
    """A copy of `value` as a vector of finite floats, of the given size if there is one, or ValueError naming it."""
    try:
        vector = np.array(value)
    except ValueError as error:
        raise ValueError(f"{name}: expected a vector of real numbers, found {type(value).__name__} ({error})") from None
    if vector.dtype.kind not in "fiu" or vector.ndim != 1 or vector.size == 0:
        raise ValueError(f"{name}: expected a vector of real numbers, found shape {vector.shape}, dtype {vector.dtype}")
    if size is not None and vector.size != size:
        raise ValueError(f"{name}: expected {size} numbers, found {vector.size}")
    if not np.isfinite(vector).all():
        raise ValueError(f"{name}: expected finite numbers, found {vector[~np.isfinite(vector)][0]}")
    return vector.astype(float)
