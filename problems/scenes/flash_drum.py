"""A flash drum."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen

from continuation.arguments.checks import expect
from continuation.tracing import solve_at
from problems.nonlinear.normal_map import NormalMap
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters

ANTOINE = ((6.90565, 1211.033, 220.790), (6.95464, 1344.800, 219.482))
"""Benzene and toluene: log10 p = A - B / (T + C), mm Hg and Celsius (Perry's handbook)."""


@frozen
class RachfordRice:
    """The negative Rachford-Rice function, increasing in the vapour fraction."""

    feed: tuple[float, float]
    pressure: float

    def volatilities(self, temperature: Any) -> Any:
        """K_i - 1 = p_i / p - 1 (Raoult), 760 mm Hg = 101.325 kPa; accepts jets."""
        return [10.0 ** (a - b / (temperature + c)) * (101.325 / 760.0 / self.pressure) - 1.0 for a, b, c in ANTOINE]

    def __call__(self, x: Any, lam: Any) -> Any:
        """The value."""
        return -sum(z * k / (1.0 + x * k) for z, k in zip(self.feed, self.volatilities(lam)))


@with_parameters
def FlashDrum(benzene: Positive = 0.5, pressure: Positive = 101.325, temperature: Positive = 95.0) -> Scene:
    """Which part of benzene and toluene in a drum is vapour at each temperature?

    The vapour fraction has kinks at the bubble point and the dew point.

    Parameters
    ----------
    benzene : float
        Mole fraction; the rest is toluene.
    pressure : float
        kPa.
    temperature : float
        Degrees Celsius, 70 to 120, where phases are reported.

    References
    ----------
    Rachford and Rice, J. Petroleum Technology 4 (1952); Perry's Chemical Engineers' Handbook.
    """
    cold, warm = 70.0, 120.0
    balance = RachfordRice((benzene, 1.0 - benzene), pressure)
    expect(benzene < 1.0, "benzene", "a number between 0 and 1", benzene)
    expect(cold <= temperature <= warm, "temperature", f"{cold:g} to {warm:g}", temperature)
    boils = balance(0.0, cold) > 0.0 > balance(1.0, warm)
    expect(boils, "pressure", f"one at which the mixture boils from {cold:g} to {warm:g} degrees", pressure)

    def problem() -> NormalMap:
        return NormalMap(balance, x0=np.zeros(1), lam0=cold, lower=0.0, upper=1.0, target=warm)

    def answer(solution: Any) -> Quantities:
        """An absent phase gets its incipient composition."""
        z = solve_at(problem(), temperature, solution(t=temperature)[:-1])
        part, k = float(np.clip(z[0], 0.0, 1.0)), np.array(balance.volatilities(temperature))
        liquid = np.array([z / (1.0 + part * ki) for z, ki in zip(balance.feed, k)])
        vapour = liquid * (1.0 + k)
        bubble, dew = (kink.lam for kink in solution.kinks)
        return {
            "bubble point": bubble, "dew point": dew, "vapour": part,
            "benzene in vapour": float(vapour[0] / vapour.sum()), "benzene in liquid": float(liquid[0] / liquid.sum()),
        }  # fmt: skip

    def drawn(solution: Any) -> Picture:
        u = solution(np.linspace(0.0, solution.arclength[-1], 400))
        kinks = [(kink.lam, np.clip(kink.y[0], 0.0, 1.0)) for kink in solution.kinks]
        return picture(
            mark("plot", u[:, -1], np.clip(u[:, 0], 0.0, 1.0), color="#0072B2"),
            *(mark("plot", *kink, "kD", markersize=5) for kink in kinks),
            *(mark("annotate", f"{name} {kink[0]:.2f}", kink, (0, 8), ha="right", textcoords="offset points")
              for kink, name in zip(kinks, ("bubble point", "dew point"))),
            xlabel="temperature (degrees Celsius)", ylabel="part of vapour", ylim=(-0.05, 1.15),
        )  # fmt: skip

    return Scene(
        units={
            "bubble point": "degrees C", "dew point": "degrees C", "vapour": "", "benzene in vapour": "",
            "benzene in liquid": "",
        },
        unknowns=(Unknown("part of vapour", 1, "which phases there are"),),
        problem=problem, answer=answer, picture=drawn,
    )  # fmt: skip
