"""Bratu's problem under a lid."""

from __future__ import annotations

from math import acosh, exp, sqrt
from typing import Annotated, Any

import numpy as np
from scipy.optimize import brentq

from continuation.arguments.checks import integer
from continuation.arrays import Array
from continuation.tracing import solve_at
from problems.bifurcation import Bratu1D
from problems.nonlinear.normal_map import NormalMap
from problems.nonlinear.obstacle import BratuForce
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def BratuLid(lid: Positive = 2.0, load: Positive = 6.0, n: Annotated[int, integer(4)] = 50) -> Scene:
    """Where does the path of u'' + load e^u = 0, with u held below a lid, turn?

    It turns at a fold, and at a kink where the middle touches the lid.

    Parameters
    ----------
    lid : float
        Above 1.1869, the largest u at the fold.
    load : float
        The load at which contact is reported.
    n : int
        Points from the surface (excluded) to the middle.

    References
    ----------
    Bratu, Bull. Soc. Math. France 42 (1914).
    """
    layer, weight = BratuForce(Bratu1D(2 * n - 1), even=True), np.append(np.ones(n - 1), 0.5)

    def problem() -> NormalMap:
        return NormalMap(layer, layer.slope, x0=np.zeros(n), lam0=0.0, lower=-np.inf, upper=lid, target=max(load, 3.6))

    def named(fold: float, kink: float, z: Array) -> Quantities:
        # The lid's force z - lid locates the edge to second order.
        force = np.maximum(z - lid, 0.0) * weight * 2.0 * n
        edge = 0.5 - float(force.sum()) / (load * exp(lid))
        return {"fold": fold, "turning kink": kink, "contact from": edge}

    def answer(solution: Any) -> Quantities:
        folds = [event.lam for event in solution.turning_points if event not in solution.kinks]
        kinks = [kink.lam for kink in solution.kinks if kink.name == "turning kink"]
        z = solve_at(problem(), load, solution.crossings(load)[-1][:-1])
        return named(folds[0] if folds else np.nan, kinks[0] if kinks else np.nan, z)

    def exact() -> Quantities:
        """Closed form: u' = 0 at the contact's edge."""
        turn = float(brentq(lambda z: z * np.tanh(z) - 1.0, 1.0, 1.5, xtol=1e-15))
        reach = acosh(exp(0.5 * lid))
        return {
            "fold": 8.0 * turn**2 / np.cosh(turn) ** 2, "turning kink": 8.0 * exp(-lid) * reach**2,
            "contact from": min(sqrt(2.0 / load) * exp(-0.5 * lid) * reach, 0.5),
        }  # fmt: skip

    def drawn(solution: Any) -> Picture:
        u = solution(np.linspace(0.0, solution.arclength[-1], 400))

        def shown(u: Array, *style: str, **options: Any) -> Any:
            return mark("plot", u[:, -1], np.minimum(u[:, :-1], lid) @ (weight / n), *style, **options)

        special = ((solution.kinks, "kD", "kinks"), (solution.turning_points, "wo", "turns"))
        return picture(
            shown(u, color="#0072B2"),
            *(shown(np.reshape([e.u for e in events], (-1, n + 1)), style, markersize=5, markeredgecolor="black",
                    label=label) for events, style, label in special),
            xlabel="load", ylabel="mean temperature",
        )  # fmt: skip

    return Scene(
        units={"fold": "", "turning kink": "", "contact from": ""},
        unknowns=(Unknown("temperatures", n, "where they reach the lid"),),
        problem=problem, answer=answer, exact=exact, picture=drawn,
    )  # fmt: skip
