"""A flash drum: how much of a mixture boils, and when a phase appears or vanishes."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import frozen
from scipy.optimize import brentq

from continuation.arrays import Array
from continuation.tracing import solve_at
from problems.nonlinear.normal_map import NormalMap
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive

ANTOINE = ((6.90565, 1211.033, 220.790), (6.95464, 1344.800, 219.482))
"""Of benzene and toluene, for mm Hg and degrees Celsius: log10 p = A - B / (T + C) (Perry's handbook)."""

MM_HG = 101.325 / 760.0
"""kPa."""

WARMEST = 120.0
"""Degrees Celsius, where the path ends; it begins at COLDEST."""

COLDEST = 70.0


@frozen
class RachfordRice:
    """Rachford and Rice's function with its sign changed: it rises with the part of vapour."""

    feed: tuple[float, float]
    pressure: float

    def volatilities(self, temperature: Any) -> Any:
        """K_i - 1 = p_i / p - 1, by Raoult's law, in a list; jets pass through it."""
        return [10.0 ** (a - b / (temperature + c)) * (MM_HG / self.pressure) - 1.0 for a, b, c in ANTOINE]

    def __call__(self, x: Any, lam: Any) -> Any:
        """-sum z_i (K_i - 1) / (1 + x (K_i - 1)), shape (1,)."""
        k = self.volatilities(lam)
        return -sum(z * ki / (1.0 + x * ki) for z, ki in zip(self.feed, k))


@frozen
class FlashDrum:
    """Benzene and toluene in a drum: which part is vapour at each temperature?

    The part of vapour is between 0 and 1. At 0 no vapour can appear, at 1 no liquid: complementarity with two bounds,
    as a path over the temperature with a kink at the bubble point and one at the dew point.

    Parameters
    ----------
    benzene : float
        Its part of the feed, in moles; the rest is toluene.
    pressure : float
        kPa.
    temperature : float
        Degrees Celsius, where the answer gives the phases; between 70 and 120.

    References
    ----------
    Rachford and Rice, J. Petroleum Technology 4 (1952); Perry's Chemical Engineers' Handbook.
    """

    benzene: float = positive(0.5)
    pressure: float = positive(101.325)
    temperature: float = positive(95.0)
    units: ClassVar[Units] = {
        "bubble point": "degrees C", "dew point": "degrees C", "vapour": "", "benzene in vapour": "",
        "benzene in liquid": "",
    }  # fmt: skip

    def __attrs_post_init__(self) -> None:
        if self.benzene >= 1.0:
            raise ValueError(f"benzene: expected a number between 0 and 1, found {self.benzene}")
        if not COLDEST <= self.temperature <= WARMEST:
            raise ValueError(f"temperature: expected {COLDEST:g} to {WARMEST:g}, found {self.temperature}")
        low, high = self._curve(COLDEST)[0] < 0.0, self._curve(WARMEST)[1] > 0.0
        if not (low and high):
            raise ValueError(f"pressure: expected one at which the mixture boils from {COLDEST:g} to {WARMEST:g} "
                             f"degrees, found {self.pressure}")  # fmt: skip

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The part of vapour; compositions follow from it, and no phase needs a switch of its own."""
        return (Unknown("part of vapour", 1, "which phases there are"),)

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """Brent's method at each of the three temperatures, with phases tested one by one."""
        return (Rival("Brent, phase by phase (scipy)", "", lambda scene: scene.exact()),)

    @property
    def _function(self) -> RachfordRice:
        return RachfordRice((self.benzene, 1.0 - self.benzene), self.pressure)

    def _curve(self, temperature: float) -> tuple[float, float]:
        """Rachford and Rice's function, with its sign, without vapour and with nothing else."""
        f = self._function
        return -float(f(0.0, temperature)), -float(f(1.0, temperature))

    def problem(self) -> NormalMap:
        """The path of the part of vapour, from cold to warm."""
        return NormalMap(self._function, x0=np.zeros(1), lam0=COLDEST, lower=0.0, upper=1.0, target=WARMEST)

    def answer(self, solution: Any) -> Quantities:
        """Temperatures at which a phase appears or vanishes, and the phases at one temperature."""
        bubble, dew = (kink.lam for kink in solution.kinks)
        z = solve_at(self.problem(), self.temperature, solution(t=self.temperature)[:-1])
        part = float(np.clip(z[0], 0.0, 1.0))
        return {"bubble point": bubble, "dew point": dew, **self._phases(part)}

    def _phases(self, part: float) -> Quantities:
        k = self._function.volatilities(self.temperature)
        liquid: Array = np.array([z / (1.0 + part * ki) for z, ki in zip((self.benzene, 1.0 - self.benzene), k)])
        vapour = liquid * (1.0 + np.array(k))
        # A phase that is not there has the composition in which it would appear.
        return {
            "vapour": part, "benzene in vapour": float(vapour[0] / vapour.sum()),
            "benzene in liquid": float(liquid[0] / liquid.sum()),
        }  # fmt: skip

    def exact(self) -> Quantities:
        """By Brent's method, phase by phase."""
        bubble, dew = (float(brentq(lambda T, k=k: self._curve(T)[k], COLDEST, WARMEST, xtol=1e-13)) for k in (0, 1))
        f, T = self._function, self.temperature
        inside = bubble < T < dew
        part = float(brentq(lambda x: float(f(x, T)), 0.0, 1.0, xtol=1e-15)) if inside else float(dew <= T)
        return {"bubble point": bubble, "dew point": dew, **self._phases(part)}

    def draw(self, solution: Any, axes: Any) -> None:
        """The part of vapour against the temperature."""
        u = solution(np.linspace(0.0, solution.arclength[-1], 400))
        axes.plot(u[:, -1], np.clip(u[:, 0], 0.0, 1.0), color="#0072B2")
        for kink, name in zip(solution.kinks, ("bubble point", "dew point")):
            axes.plot(kink.lam, np.clip(kink.y[0], 0.0, 1.0), "kD", markersize=5)
            axes.annotate(f"{name} {kink.lam:.2f}", (kink.lam, np.clip(kink.y[0], 0.0, 1.0)), (0, 8), ha="right",
                          textcoords="offset points")  # fmt: skip
        axes.set(xlabel="temperature (degrees Celsius)", ylabel="part of vapour", ylim=(-0.05, 1.15))
