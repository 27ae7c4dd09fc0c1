"""A signal with jumps, freed of noise by total variation."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

from continuation.arguments.checks import NOT_NEGATIVE, integer
from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.scenes.rivals import GAUSS_SEIDEL, QUADRATIC
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class Denoising:
    """A signal of flat pieces under noise: where does it jump?

    It is the x of least |x - y|^2 / 2 + weight * (sum of its jumps).

    Parameters
    ----------
    samples : int
        A multiple of 4: the true signal has four levels.
    weight : float
    noise : float
        Standard deviation.
    seed : int

    References
    ----------
    Rudin, Osher and Fatemi, Physica D 60 (1992); Chambolle, J. Math. Imaging Vision 20 (2004), for the dual.
    """

    samples: int = field(default=200, validator=integer(4))
    weight: float = positive(2.0)
    noise: float = field(default=0.3, validator=NOT_NEGATIVE)
    seed: int = field(default=0, validator=integer(0))
    units: ClassVar[Units] = {"signal": "", "jumps": ""}
    rivals: ClassVar[tuple[Rival, ...]] = (GAUSS_SEIDEL, *QUADRATIC)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Forces between neighbours, at most the weight; the signal is the data moved by these."""
        return (Unknown("forces between neighbours", self.samples - 1, "where the signal jumps"),)

    def data(self) -> Array:
        """The noisy signal, shape (samples,)."""
        true = self._levels[np.arange(self.samples) * 4 // self.samples]
        return np.asarray(true + self.noise * np.random.default_rng(self.seed).normal(size=self.samples))

    @property
    def _levels(self) -> Array:
        return np.array([0.0, 2.0, 1.0, 3.0])

    def problem(self) -> MixedLCP:
        """D D' z - D y in the box of the weight."""
        n = self.samples - 1
        one = np.ones(n - 1)
        A = sp.diags_array([-one, np.full(n, 2.0), -one], offsets=[-1, 0, 1], format="csr")
        return MixedLCP(A, -np.diff(self.data()), np.full(n, -self.weight), np.full(n, self.weight))

    def answer(self, solution: Any) -> Quantities:
        """The signal y - D'z, and the number of its jumps, where the force is at its limit."""
        z = np.asarray(solution.x)
        return {
            "signal": self.data() + np.diff(np.pad(z, 1)),
            "jumps": float((np.abs(z) >= self.weight * (1.0 - 1e-9)).sum()),
        }  # fmt: skip

    def exact(self) -> Quantities:
        """Without noise every level moves to its neighbours by the weight over its length, while there are jumps."""
        whole, rest = divmod(self.samples, 4)
        by = self.weight / whole
        if self.noise or rest or by > 0.2:
            return {}
        # Up, down, up: the ends are pulled by one jump, what is inside by two.
        level = self._levels + by * np.array([1.0, -2.0, 2.0, -1.0])
        return {"signal": np.repeat(level, whole), "jumps": 3.0}

    def draw(self, solution: Any, axes: Any) -> None:
        """The noisy signal and the one that is found."""
        axes.plot(self.data(), ".", color="0.65", markersize=3, label="measured")
        axes.step(range(self.samples), self.answer(solution)["signal"], where="mid", color="#D55E00", label="found")
        axes.set(xlabel="sample", ylabel="signal")
        axes.legend(frameon=False)
