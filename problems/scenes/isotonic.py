"""A curve that may only rise, fitted to noisy data."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

from continuation.arguments.checks import NOT_NEGATIVE, integer
from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.scenes.rivals import GAUSS_SEIDEL, QUADRATIC
from problems.scenes.scene import Quantities, Rival, Units, Unknown


@frozen
class Isotonic:
    """A noisy response that can only rise with the dose: which rising curve is nearest to it?

    Parameters
    ----------
    samples : int
    noise : float
        Standard deviation.
    seed : int

    References
    ----------
    Barlow, Bartholomew, Bremner and Brunk, Statistical Inference under Order Restrictions, 1972.
    """

    samples: int = field(default=100, validator=integer(2))
    noise: float = field(default=0.3, validator=NOT_NEGATIVE)
    seed: int = field(default=0, validator=integer(0))
    units: ClassVar[Units] = {"fit": "", "steps": ""}

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Forces between neighbours: the fit is the data moved by these, so no value of the curve is an unknown."""
        return (Unknown("forces between neighbours", self.samples - 1, "which samples are pooled"),)

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """Pooling of adjacent violators, of scikit-learn and in Python, and methods for the quadratic program."""
        return (Rival("IsotonicRegression (sklearn)", "sklearn", _sklearn),
                Rival("pool adjacent violators", "", _pooled), GAUSS_SEIDEL, *QUADRATIC)  # fmt: skip

    def data(self) -> Array:
        """The measurement, shape (samples,)."""
        place = np.linspace(-3.0, 3.0, self.samples)
        return 1.0 / (1.0 + np.exp(-2.0 * place)) + self.noise * np.random.default_rng(self.seed).normal(
            size=place.size
        )

    def problem(self) -> LCP:
        """D D' z + D y >= 0, D the differences of neighbours."""
        n = self.samples - 1
        one = np.ones(n - 1)
        A = sp.diags_array([-one, np.full(n, 2.0), -one], offsets=[-1, 0, 1], format="csr")
        return LCP(A, np.diff(self.data()))

    def answer(self, solution: Any) -> Quantities:
        """The fit y + D'z, and the number of its different values."""
        z = np.pad(np.asarray(solution.x), 1)
        fit = self.data() - np.diff(z)
        return {"fit": fit, "steps": 1.0 + float((np.asarray(solution.x) == 0.0).sum())}

    def exact(self) -> Quantities:
        """By pooling adjacent violators, which is exact."""
        fit = _pooled(self)["fit"]
        return {"fit": fit, "steps": 1.0 + float((np.diff(fit) > 0.0).sum())}

    def draw(self, solution: Any, axes: Any) -> None:
        """Data and fit."""
        axes.plot(self.data(), ".", color="0.6", label="measured")
        axes.step(range(self.samples), self.answer(solution)["fit"], where="mid", color="#0072B2", label="rising fit")
        axes.set(xlabel="sample", ylabel="response")
        axes.legend(frameon=False)


def _pooled(scene: Isotonic) -> Quantities:
    blocks: list[tuple[float, int]] = []
    for value in scene.data().tolist():
        total, size = value, 1
        while blocks and blocks[-1][0] * size >= total * blocks[-1][1]:
            before, many = blocks.pop()
            total, size = total + before, size + many
        blocks.append((total, size))
    return {"fit": np.repeat([total / size for total, size in blocks], [size for _, size in blocks])}


def _sklearn(scene: Isotonic) -> Quantities:
    from sklearn.isotonic import IsotonicRegression

    return {"fit": IsotonicRegression().fit_transform(np.arange(scene.samples), scene.data())}
