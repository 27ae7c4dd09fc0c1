"""A penalised regression: all its solutions, from nothing to least squares."""

from __future__ import annotations

from math import inf, nan
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import NOT_NEGATIVE, integer
from continuation.arrays import Array
from continuation.path import Path
from problems.lcp.data.problem import MixedLCP
from problems.lcp.parametric.along import along
from problems.scenes.scene import Quantities, Rival, Units, Unknown


def penalised(G: Array, c: Array) -> Path:
    """The path of min b'Gb/2 - c'b + t |b|_1, from the least t with b = 0 on, to 0.

    References
    ----------
    Osborne, Presnell and Turlach, IMA J. Numer. Anal. 20 (2000); Efron, Hastie, Johnstone and Tibshirani, Ann. Statist.
    32 (2004).
    """
    return along(MixedLCP(G, -c), np.zeros(c.size), (inf, 0.0), level=1.0)


@frozen
class Lasso:
    """Which of many features explain an observation, as the penalty on their coefficients falls?

    min |X b - y|^2 / 2 + t |b|_1 for all t at once: a path with a kink wherever a feature enters or leaves. The data
    are drawn at random, with a few features that matter.

    Parameters
    ----------
    samples, features : int
    relevant : int
        Features whose coefficient is not zero.
    noise : float
        Standard deviation.
    penalty : float
        At which the answer gives the coefficients.
    seed : int

    References
    ----------
    Tibshirani, J. R. Statist. Soc. B 58 (1996).
    """

    samples: int = field(default=60, validator=integer(1))
    features: int = field(default=12, validator=integer(1))
    relevant: int = field(default=4, validator=integer(0))
    noise: float = field(default=0.5, validator=NOT_NEGATIVE)
    penalty: float = field(default=5.0, validator=NOT_NEGATIVE)
    seed: int = field(default=0, validator=integer(0))
    units: ClassVar[Units] = {"coefficients": "", "first enters at": "", "kinks": ""}

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """Coefficients without a sign: parts of both signs would be twice as many, of a singular problem."""
        return (Unknown("coefficients", self.features, "which features matter, and how much"),)

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """Scikit-learn's path and its coordinate descent."""
        return (Rival("lars_path (sklearn)", "sklearn", _lars), Rival("Lasso (sklearn)", "sklearn", _descent))

    def data(self) -> tuple[Array, Array]:
        """X and y."""
        random = np.random.default_rng(self.seed)
        X = random.normal(size=(self.samples, self.features))
        b = np.zeros(self.features)
        few = min(self.relevant, self.features)
        b[:few] = np.linspace(3.0, 1.0, few) * (-1.0) ** np.arange(few)
        return X, X @ b + self.noise * random.normal(size=self.samples)

    def problem(self) -> MixedLCP:
        """Of least squares; the penalty is a level of the path."""
        X, y = self.data()
        return MixedLCP(X.T @ X, -X.T @ y)

    def solve(self) -> Path:
        """The whole path."""
        X, y = self.data()
        return penalised(X.T @ X, X.T @ y)

    def answer(self, solution: Any) -> Quantities:
        """Coefficients at the penalty, the penalty at which the first one enters, and the number of kinks."""
        enters = solution.lam[0] if not solution.kinks else solution.kinks[0].lam
        b = solution(t=self.penalty)[:-1] if self.penalty < enters else np.zeros(self.features)
        return {"coefficients": b, "first enters at": enters, "kinks": float(len(solution.kinks))}

    def exact(self) -> Quantities:
        """The first enters at the largest correlation; without penalty b is that of least squares."""
        X, y = self.data()
        known = {"first enters at": float(np.abs(X.T @ y).max())}
        least = self.samples > self.features and not self.penalty
        return {**known, "coefficients": np.linalg.lstsq(X, y)[0]} if least else known

    def draw(self, solution: Any, axes: Any) -> None:
        """Coefficients against the penalty."""
        axes.plot(solution.lam, solution.y, linewidth=1.0)
        for kink in solution.kinks:
            axes.plot(np.full(len(kink.switches), kink.lam), kink.y[list(kink.switches)], "k.", markersize=5)
        axes.axvline(self.penalty, color="0.6", linewidth=0.8, zorder=0, label=f"penalty {self.penalty:g}")
        axes.set(xlabel="penalty", ylabel="coefficients", xlim=(1.02 * solution.kinks[0].lam, 0.0))
        axes.legend(frameon=False)


def _lars(scene: Lasso) -> Quantities:
    from sklearn.linear_model import lars_path

    X, y = scene.data()
    t, _, b = lars_path(X, y, method="lasso", max_iter=50 * scene.features)
    t = t * len(y)
    at = [np.interp(-scene.penalty, -t, row) for row in b]
    return {"coefficients": np.array(at), "first enters at": float(t[0])}


def _descent(scene: Lasso) -> Quantities:
    from sklearn.linear_model import Lasso as Regression

    X, y = scene.data()
    if not scene.penalty:
        return {"first enters at": nan}
    model = Regression(alpha=scene.penalty / len(y), fit_intercept=False, tol=1e-12, max_iter=100_000)
    return {"coefficients": model.fit(X, y).coef_}
