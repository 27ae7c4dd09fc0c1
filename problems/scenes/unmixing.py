"""A spectrum as a sum of known ones: how much of each substance is there?"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen
from scipy.optimize import nnls

from continuation.arguments.checks import NOT_NEGATIVE, integer
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.rivals import GAUSS_SEIDEL, LEMKE, QUADRATIC
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Unmixing:
    """A spectrum of several substances whose own spectra overlap: how much of each is there?

    Nonnegative least squares. Each spectrum is one peak; every third substance is not there at all.

    Parameters
    ----------
    substances : int
    channels : int
        Of the spectrometer.
    width : float
        Of a peak, in distances of peaks.
    noise : float
        Standard deviation.
    seed : int

    References
    ----------
    Lawson and Hanson, Solving Least Squares Problems, 1974.
    """

    substances: int = field(default=12, validator=integer(1))
    channels: int = field(default=200, validator=integer(2))
    width: float = positive(0.8)
    noise: float = field(default=0.0, validator=NOT_NEGATIVE)
    seed: int = field(default=0, validator=integer(0))
    units: ClassVar[Units] = {"amounts": "", "misfit": ""}

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Amounts; the misfit of the channels follows."""
        return (Unknown("amounts", self.substances, "how much of each substance"),)

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """Lawson and Hanson's method, of scipy, and methods for the quadratic program."""
        return (Rival("nnls (scipy)", "", _lawson_hanson), GAUSS_SEIDEL, LEMKE, *QUADRATIC)

    def data(self) -> tuple[Array, Array]:
        """The known spectra, one a column, and the one that is measured."""
        place = np.linspace(-1.0, self.substances, self.channels)
        spectra = np.exp(-0.5 * ((place[:, None] - np.arange(self.substances)) / self.width) ** 2)
        random = np.random.default_rng(self.seed)
        return spectra, spectra @ self._amounts + self.noise * random.normal(size=self.channels)

    @property
    def _amounts(self) -> Array:
        k = np.arange(self.substances)
        return np.where(k % 3 == 2, 0.0, 1.0 + 0.5 * np.sin(2.0 * k))

    def problem(self) -> LCP:
        """The normal equations as inequalities."""
        spectra, measured = self.data()
        return LCP(spectra.T @ spectra, -spectra.T @ measured)

    def answer(self, solution: Any) -> Quantities:
        """Amounts, and what they leave unexplained."""
        spectra, measured = self.data()
        x = np.asarray(solution.x)
        return {"amounts": x, "misfit": float(np.linalg.norm(spectra @ x - measured))}

    def exact(self) -> Quantities:
        """What the spectrum was made of, where there is no noise."""
        return {} if self.noise else {"amounts": self._amounts, "misfit": 0.0}

    def draw(self, solution: Any, axes: Any) -> None:
        """The measured spectrum, and its parts."""
        spectra, measured = self.data()
        x = np.asarray(solution.x)
        place = np.linspace(-1.0, self.substances, self.channels)
        axes.plot(place, measured, "k.", markersize=2, label="measured")
        axes.plot(place, spectra @ x, color="#D55E00", linewidth=1.0, label="sum of the parts (blue)")
        axes.plot(place, spectra * x, color="#0072B2", linewidth=0.7)
        axes.set(xlabel="channel", ylabel="intensity")
        axes.legend(frameon=False)


def _lawson_hanson(scene: Unmixing) -> Quantities:
    spectra, measured = scene.data()
    x, misfit = nnls(spectra, measured)
    return {"amounts": x, "misfit": misfit}
