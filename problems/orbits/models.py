"""Vector fields with known periodic orbits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array


def normal_form(z: Any, p: Any, second: Any = 1.0) -> Array:
    """R' = r (p + second r^2 - r^4), theta' = 1; a fold of cycles at p = -second^2 / 4."""
    x, y = z
    r = x * x + y * y
    a = p + second * r - r * r
    return np.stack([a * x - y, a * y + x])


def van_der_pol(z: Any, mu: Any) -> Array:
    """Relaxation oscillations for large mu."""
    x, y = z
    return np.stack([y, mu * (1.0 - x * x) * y - x])


def brusselator(z: Any, b: Any) -> Array:
    """Equilibrium (1, b), Hopf point at b = 2."""
    x, y = z
    return np.stack([1.0 - (b + 1.0) * x + x * x * y, b * x - x * x * y])


def roessler(z: Any, c: Any, a: Any = 0.2) -> Array:
    """Period doublings."""
    x, y, w = z
    return np.stack([-y - w, x + a * y, 0.2 + w * (x - c)])


def lorenz(z: Any, r: Any) -> Array:
    """Hopf point at r = 470 / 19; orbits end on a homoclinic one at r = 13.9266."""
    x, y, w = z
    return np.stack([10.0 * (y - x), r * x - y - x * w, x * y - 8.0 / 3.0 * w])


@frozen
class Model:
    """A vector field that archives name."""

    name: str

    def __call__(self, z: Any, p: Any, *second: Any) -> Array:
        """The value."""
        field: Array = FIELDS[self.name](z, p, *second)
        return field


FIELDS: dict[str, Callable[..., Any]] = {
    "normal-form": normal_form, "brusselator": brusselator, "lorenz": lorenz, "van-der-pol": van_der_pol,
    "roessler": roessler,
}  # fmt: skip
