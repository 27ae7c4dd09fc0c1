"""Bratu's problem under an obstacle: its fold becomes a corner."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arguments.checks import expect, is_number
from continuation.arrays import Array
from continuation.linear import Banded
from problems.bifurcation import Bratu1D
from problems.nonlinear.normal_map import NormalMap


@frozen
class BratuForce:
    """The force -(u'' + lam e^u) times h^2; of an `even` solution u is one half, its middle last."""

    bratu: Bratu1D
    even: bool = False

    def _whole(self, x: Any) -> Any:
        return np.concatenate((x, x[-2::-1])) if self.even else x

    def __call__(self, x: Any, lam: Any) -> Any:
        """The value."""
        return -self.bratu.residual(self._whole(x), lam)[: len(x)]

    def slope(self, x: Array, lam: float) -> tuple[Banded, Array]:
        """Tridiagonal matrix and vector."""
        H_y, H_lam = self.bratu.jacobian(self._whole(x), lam)
        bands = -H_y.ab[:, : x.size]
        if self.even:
            # Both neighbours of the middle are one unknown.
            bands[2, -2] *= 2.0
        return Banded(bands, 1, 1), -H_lam[: x.size]


def bratu_under_obstacle(n: int = 39, psi: float = 2.0, target: float | None = 0.0) -> NormalMap:
    """Bratu's u'' + lam e^u = 0 on (0, 1) with u <= psi, by second-order differences, from u = 0 at lam = 0.

    For psi > 1.1868421686, the maximum of u at the fold, the path meets the obstacle behind the fold at lam_c = 8
    exp(-psi) arccosh(exp(psi/2))^2 and turns in a corner; u then rests on it between a(lam) and 1 - a(lam), a =
    sqrt(2/lam) exp(-psi/2) arccosh(exp(psi/2)).

    Parameters
    ----------
    n : int
        Number of interior points.
    psi : float
    target : float or None

    Returns
    -------
    NormalMap
        ``x(z)`` gives u.
    """
    expect(is_number(psi) and 0.0 < psi < math.inf, "psi", "a positive number", psi)
    force = BratuForce(Bratu1D(n))
    return NormalMap(force, force.slope, x0=np.zeros(n), lam0=0.0, lower=-np.inf, upper=psi, target=target)
