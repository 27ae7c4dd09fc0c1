"""A string hanging over a floor."""

from __future__ import annotations

from math import sqrt
from typing import Annotated, Any

import numpy as np
import scipy.sparse as sp

from continuation.arguments.checks import integer
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import BFGS, LEMKE, PIQP
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def String(
    height: Positive = 0.05, load: Positive = 1.0, tension: Positive = 1.0, length: Positive = 1.0,
    n: Annotated[int, integer(2)] = 50,
) -> Scene:  # fmt: skip
    """Where does a heavy string between two supports touch the floor?

    T u'' = load on one half, by second-order differences.

    Parameters
    ----------
    height, length : float
        m: supports above the floor; distance between supports.
    load, tension : float
        N/m; N.
    n : int
        Points from a support (excluded) to the middle.
    """
    h = 0.5 * length / n

    def problem() -> LCP:
        k, half = tension / h, np.append(np.ones(n - 1), 0.5)
        A = sp.diags_array([np.full(n - 1, -k), 2.0 * k * half, np.full(n - 1, -k)], offsets=[-1, 0, 1], format="csr")
        return LCP(A, load * h * half - k * height * (np.arange(n) == 0))

    def named(support: float) -> Quantities:
        """The support's force gives the contact to second order."""
        return {"contact from": support / load, "support force": support, "floor force": load * length - 2.0 * support}

    def answer(solution: Any) -> Quantities:
        return named(tension * (height - float(solution.x[0])) / h + 0.5 * load * h)

    def exact() -> Quantities:
        """A parabola, tangent to the floor at sqrt(2 T height / load) or above it."""
        a = min(sqrt(2.0 * tension * height / load), 0.5 * length)
        return {**named(load * a), "contact from": a}

    def drawn(solution: Any) -> Picture:
        half, a = np.append(height, solution.x), answer(solution)["contact from"]
        return picture(
            mark("plot", np.linspace(0.0, length, 2 * n + 1), np.append(half, half[-2::-1]), color="#0072B2"),
            mark("plot", [a, length - a], [0.0, 0.0], "kD", markersize=4, label=f"contact from {a:.4f} m"),
            mark("axhline", 0.0, color="0.4", linewidth=0.8, zorder=0),
            xlabel="m from the left support", ylabel="height (m)",
        )  # fmt: skip

    return Scene(
        units={"contact from": "m", "support force": "N", "floor force": "N"},
        unknowns=(Unknown("heights above the floor", n, "where the string hangs and where it lies"),),
        problem=problem, answer=answer, exact=exact, picture=drawn,
        rivals=(LEMKE, PIQP, BFGS),
    )  # fmt: skip
