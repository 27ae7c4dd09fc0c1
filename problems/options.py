"""Checks of the options of the problems, and the rule that overflow in an evaluation raises no warning."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import Attribute

from continuation.arrays import Array
from continuation.checks import FINITE, integer

quiet = np.errstate(over="ignore", invalid="ignore")
"""Decorates an evaluation whose overflow is to give inf or nan without a warning: the tracer handles these."""


positive_integer = integer(1)
finite = FINITE


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
