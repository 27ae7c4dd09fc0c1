"""A membrane over a ball."""

from __future__ import annotations

from math import log, pi, sqrt
from typing import Annotated, Any

import numpy as np
import scipy.sparse as sp
from scipy.optimize import brentq

from continuation.arguments.checks import integer, number
from problems.lcp.data.problem import MixedLCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import BFGS, PIQP
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Membrane(
    radius: Annotated[float, number("a number above 1", lambda R: 1.0 < R < 1e6)] = 2.0,
    tension: Positive = 1.0, n: Annotated[int, integer(4)] = 100,
) -> Scene:  # fmt: skip
    """How much of a ball touches a membrane that is held at the rim of a disc?

    Parameters
    ----------
    radius : float
        The rim's radius in ball radii (above 1).
    tension : float
        N/m.
    n : int
        Points from the middle to the rim (excluded).
    """
    h = radius / n

    def problem() -> MixedLCP:
        """Finite volumes of -(r u')' = 0 above the ball."""
        r = h * np.arange(n)
        outer = (r + 0.5 * h) / h
        inner = np.append(0.0, outer[:-1])
        A = sp.diags_array([-outer[:-1], inner + outer, -outer[:-1]], offsets=[-1, 0, 1], format="csr")
        return MixedLCP(A, np.zeros(n), np.where(r < 1.0, np.sqrt(np.maximum(1.0 - r**2, 0.0)), -np.inf))

    def answer(solution: Any) -> Quantities:
        """The rim's force gives the contact to second order."""
        flux = (radius - 0.5 * h) * solution.x[-1] / h
        a = sqrt(0.5 * flux * (sqrt(flux * flux + 4.0) - flux))
        return {"contact radius": a, "force": 2.0 * pi * tension * flux}

    def exact() -> Quantities:
        """The free membrane is a logarithm tangent to the ball: a^2 (1 - log(a / R)) = 1."""
        a = float(brentq(lambda a: a * a * (1.0 - log(a / radius)) - 1.0, 1e-6, 1.0, xtol=1e-15))
        return {"contact radius": a, "force": 2.0 * pi * tension * a * a / sqrt(1.0 - a * a)}

    def drawn(solution: Any) -> Picture:
        r, u = np.linspace(0.0, radius, n + 1), np.append(solution.x, 0.0)
        ball, a = np.linspace(0.0, 2.0 * pi, 200), answer(solution)["contact radius"]
        return picture(
            mark("fill", np.cos(ball), np.sin(ball), color="0.88"),
            mark("plot", np.concatenate([-r[::-1], r]), np.concatenate([u[::-1], u]), color="#0072B2"),
            mark("plot", [-a, a], [sqrt(1.0 - a * a)] * 2, "kD", markersize=4, label=f"contact to {a:.5f}"),
            aspect="equal", ylim=(-0.4, 1.35), xlabel="radius / that of the ball", legend={"loc": "lower center"},
        )  # fmt: skip

    return Scene(
        units={"contact radius": "", "force": "N"},
        unknowns=(Unknown("heights", n, "where the membrane hangs between ball and rim"),),
        problem=problem, answer=answer, exact=exact, picture=drawn, rivals=(PIQP, BFGS),
    )  # fmt: skip
