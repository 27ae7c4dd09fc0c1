"""A membrane over a ball: where it rests on it."""

from __future__ import annotations

from math import log, pi, sqrt
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from scipy.optimize import brentq

from continuation.arguments.checks import integer, number
from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.scenes.rivals import BFGS, CLARABEL, GAUSS_SEIDEL, PIQP
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


def radial(n: int, width: float) -> tuple[Array, Any]:
    """Radii 0, h, ..., (n - 1) h and -(r u')' on them, by finite volumes, for u = 0 at the width.

    The matrix is sparse and symmetric: rows are times the volumes, which are those of rings over 2 pi.
    """
    h = width / n
    r = np.asarray(h * np.arange(n), dtype=float)
    outer = (r + 0.5 * h) / h
    inner = np.append(0.0, outer[:-1])
    return r, sp.diags_array([-outer[:-1], inner + outer, -outer[:-1]], offsets=[-1, 0, 1], format="csr")


@frozen
class Membrane:
    """A membrane that is held at the rim of a disc and pushed up by a ball: how much of the ball does it touch?

    By second-order differences. Membrane, rim and ball are round, so the radius is the one coordinate.

    Parameters
    ----------
    radius : float
        Of the rim, with that of the ball for unit. More than 1.
    tension : float
        N/m.
    n : int
        Points from the middle to the rim, which is none of them.
    """

    radius: float = field(default=2.0, validator=number("a number above 1", lambda R: 1.0 < R < 1e6))
    tension: float = positive(1.0)
    n: int = field(default=100, validator=integer(4))
    units: ClassVar[Units] = {"contact radius": "", "force": "N"}
    rivals: ClassVar[tuple[Rival, ...]] = (GAUSS_SEIDEL, PIQP, CLARABEL, BFGS)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Heights on one radius, with the ball for a bound where it is."""
        return (Unknown("heights", self.n, "where the membrane hangs between ball and rim"),)

    def problem(self) -> MixedLCP:
        """-(r u')' = 0 where the membrane is free, u above the upper half of the ball."""
        r, A = radial(self.n, self.radius)
        ball = np.where(r < 1.0, np.sqrt(np.maximum(1.0 - r**2, 0.0)), -np.inf)
        return MixedLCP(A, np.zeros(self.n), ball)

    def answer(self, solution: Any) -> Quantities:
        """The force at the rim is that on the ball, and tells the contact's radius to second order."""
        x, h = solution.x, self.radius / self.n
        flux = (self.radius - 0.5 * h) * x[-1] / h
        a = sqrt(0.5 * flux * (sqrt(flux * flux + 4.0) - flux))
        return {"contact radius": a, "force": 2.0 * pi * self.tension * flux}

    def exact(self) -> Quantities:
        """A logarithm that is tangent to the ball: a^2 (1 - log(a / R)) = 1."""
        a = float(brentq(lambda a: a * a * (1.0 - log(a / self.radius)) - 1.0, 1e-6, 1.0, xtol=1e-15))
        return {"contact radius": a, "force": 2.0 * pi * self.tension * a * a / sqrt(1.0 - a * a)}

    def draw(self, solution: Any, axes: Any) -> None:
        """A section."""
        r = np.linspace(0.0, self.radius, self.n + 1)
        u = np.append(solution.x, 0.0)
        ball = np.linspace(0.0, 2.0 * pi, 200)
        axes.fill(np.cos(ball), np.sin(ball), color="0.88")
        axes.plot(np.concatenate([-r[::-1], r]), np.concatenate([u[::-1], u]), color="#0072B2")
        a = self.answer(solution)["contact radius"]
        axes.plot([-a, a], [sqrt(1.0 - a * a)] * 2, "kD", markersize=4, label=f"contact to {a:.5f}")
        axes.set(aspect="equal", ylim=(-0.4, 1.35), xlabel="radius / that of the ball")
        axes.legend(frameon=False, loc="lower center")
