"""A journal bearing."""

from __future__ import annotations

from math import acos, degrees, pi
from typing import Annotated, Any

import numpy as np
import scipy.sparse as sp
from scipy.integrate import quad
from scipy.optimize import brentq

from continuation.arguments.checks import FRACTION, integer
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import LEMKE, QUADRATIC
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Bearing(
    eccentricity: Annotated[float, FRACTION] = 0.8, radius: Positive = 0.05, clearance: Positive = 5e-5,
    viscosity: Positive = 0.02, speed: Positive = 100.0, n: Annotated[int, integer(4)] = 199,
) -> Scene:  # fmt: skip
    """Where does the oil film of a long journal bearing break, and which load does it bear?

    Reynolds' equation with p >= 0 (Swift and Stieber) is solved by finite volumes.

    Parameters
    ----------
    eccentricity : float
        Between 0 and 1.
    radius, clearance : float
        m.
    viscosity, speed : float
        Pa s; rad/s.
    n : int
        Points around the shaft.

    References
    ----------
    Cryer, Math. Comp. 25 (1971).
    """
    h, unit = 2.0 * pi / (n + 1), 6.0 * viscosity * speed * (radius / clearance) ** 2

    def gap(angle: Any) -> Any:
        """Gap over clearance, widest at 0."""
        return 1.0 + eccentricity * np.cos(angle)

    def problem() -> LCP:
        edges = gap(h * (np.arange(n + 1) + 0.5))
        k = edges**3 / h
        A = sp.diags_array([-k[1:-1], k[:-1] + k[1:], -k[1:-1]], offsets=[-1, 0, 1], format="csr")
        return LCP(A, np.diff(edges))

    def answer(solution: Any) -> Quantities:
        """The flow equals the gap at the break, to second order."""
        p, first = solution.x, float(gap(0.5 * h))
        breaks = 2.0 * pi - acos(min(max((first - first**3 * p[0] / h - 1.0) / eccentricity, -1.0), 1.0))
        angle = h * np.arange(1, n + 1)
        return {
            "film breaks at": degrees(breaks), "largest pressure": unit * _peak(p),
            "load": unit * radius * h * float(np.hypot(p @ np.cos(angle), p @ np.sin(angle))),
        }  # fmt: skip

    def exact() -> Quantities:
        """Quadrature of p' = (gap - gap at the break) / gap^3."""

        def integral(end: float, breaks: float, weight: Any = np.ones_like) -> float:
            return float(quad(lambda a: (gap(a) - gap(breaks)) / gap(a) ** 3 * weight(a), 0.0, end,
                              epsabs=1e-12, epsrel=1e-11)[0])  # fmt: skip

        breaks = float(brentq(lambda b: integral(b, b), pi + 1e-6, 2.0 * pi - 1e-6, xtol=1e-14))
        across, up = (integral(breaks, breaks, f) for f in (np.sin, np.cos))
        return {
            "film breaks at": degrees(breaks), "largest pressure": unit * integral(2.0 * pi - breaks, breaks),
            "load": unit * radius * float(np.hypot(across, up)),
        }  # fmt: skip

    def drawn(solution: Any) -> Picture:
        breaks = answer(solution)["film breaks at"]
        return picture(
            mark("plot", np.linspace(0.0, 360.0, n + 2), 1e-6 * unit * np.pad(solution.x, 1), color="#0072B2",
                 label="pressure"),
            mark("axvline", breaks, color="0.5", linestyle=":", label=f"film breaks at {breaks:.2f} degrees"),
            xlabel="degrees from the widest gap", ylabel="pressure (MPa)", xticks=range(0, 361, 60),
        )  # fmt: skip

    return Scene(
        units={"film breaks at": "degrees", "largest pressure": "Pa", "load": "N/m"},
        unknowns=(Unknown("pressures", n, "where the film is, and what it bears"),),
        problem=problem, answer=answer, exact=exact, picture=drawn, rivals=(LEMKE, *QUADRATIC),
    )  # fmt: skip


def _peak(p: Array) -> float:
    k = min(max(int(np.argmax(p)), 1), p.size - 2)
    a, b, c = p[k - 1 : k + 2]
    bend = a - 2.0 * b + c
    return float(b - (c - a) ** 2 / (8.0 * bend)) if bend < 0.0 else float(b)
