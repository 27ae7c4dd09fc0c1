"""A support vector machine: which points decide where the border is?"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import NOT_NEGATIVE, integer
from continuation.arrays import Array
from problems.lcp.data.program import Program, from_qp
from problems.scenes.rivals import CLARABEL, PIQP
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class SVM:
    """Two clouds of points: which line tells them apart with the widest margin, at a price on errors?

    Parameters
    ----------
    samples : int
        An even number: half of them in each cloud.
    distance : float
        Between the middles of the clouds, in standard deviations.
    cost : float
        Of an error: the largest weight that a point may have.
    width : float
        Of a Gaussian kernel; 0 is none, and the border is a line.
    seed : int

    References
    ----------
    Cortes and Vapnik, Machine Learning 20 (1995).
    """

    samples: int = field(default=60, validator=integer(2))
    distance: float = field(default=3.0, validator=NOT_NEGATIVE)
    cost: float = positive(1.0)
    width: float = field(default=0.0, validator=NOT_NEGATIVE)
    seed: int = field(default=0, validator=integer(0))
    units: ClassVar[Units] = {"weights": "", "offset": "", "support vectors": "", "objective": ""}

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """A weight a point, between 0 and the cost, which is a bound and needs no multiplier."""
        return (Unknown("weights of points", self.samples, "which points decide"),
                Unknown("offset", 1, "where the border is: the multiplier of balance"))  # fmt: skip

    @property
    def rivals(self) -> tuple[Rival, ...]:
        """Libsvm, by way of scikit-learn, and methods for the quadratic program."""
        return (Rival("SVC (sklearn)", "sklearn", _libsvm), PIQP, CLARABEL)

    def data(self) -> tuple[Array, Array]:
        """Points, shape (n, 2), and their sides, -1 or 1."""
        random = np.random.default_rng(self.seed)
        side = np.where(np.arange(self.samples) % 2, 1.0, -1.0)
        X = random.normal(size=(self.samples, 2))
        X[:, 0] += 0.5 * self.distance * side
        return X, side

    def kernel(self, X: Array, Y: Array) -> Array:
        """Products of points, shape (len(X), len(Y)).

        Parameters
        ----------
        X, Y : ndarray, shape (k, 2)
        """
        if not self.width:
            return X @ Y.T
        square = ((X[:, None] - Y[None]) ** 2).sum(axis=2)
        return np.asarray(np.exp(-0.5 * square / self.width**2))

    def problem(self) -> Program:
        """The dual program."""
        X, side = self.data()
        P = self.kernel(X, X) * np.outer(side, side)
        n = self.samples
        return from_qp(0.5 * (P + P.T), -np.ones(n), A_eq=side[None], b_eq=[0.0], lower=0.0, upper=self.cost)

    def answer(self, solution: Any) -> Quantities:
        """Weights, the offset, how many weights are not zero, and the objective."""
        X, side = self.data()
        weights = np.asarray(solution.x)[: self.samples]
        force = self.kernel(X, X) @ (weights * side)
        inside = (weights > 1e-7 * self.cost) & (weights < (1.0 - 1e-7) * self.cost)
        # From points on the margin; without any the multiplier, which is one of several offsets, would have to do.
        offset = float(np.median((side - force)[inside])) if inside.any() else 0.0
        return {
            "weights": weights, "offset": offset, "support vectors": float((weights > 1e-7 * self.cost).sum()),
            "objective": float(0.5 * (weights * side) @ force - weights.sum()),
        }  # fmt: skip

    def exact(self) -> Quantities:
        """Of two points: 2 over the square of their distance."""
        if self.samples != 2 or self.width:
            return {}
        X, _ = self.data()
        weight = min(2.0 / float(((X[0] - X[1]) ** 2).sum()), self.cost)
        return {"weights": np.full(2, weight)}

    def draw(self, solution: Any, axes: Any) -> None:
        """Points, border and margins; support vectors have a ring."""
        X, side = self.data()
        found = self.answer(solution)
        for s, colour in ((-1.0, "#0072B2"), (1.0, "#D55E00")):
            axes.plot(*X[side == s].T, ".", color=colour)
        chosen = found["weights"] > 1e-7 * self.cost
        axes.plot(*X[chosen].T, "o", markerfacecolor="none", markeredgecolor="0.3", label="support vectors")
        low, high = X.min(axis=0) - 0.5, X.max(axis=0) + 0.5
        across, up = np.meshgrid(np.linspace(low[0], high[0], 80), np.linspace(low[1], high[1], 80))
        there = np.column_stack([across.ravel(), up.ravel()])
        value = self.kernel(there, X) @ (found["weights"] * side) + found["offset"]
        axes.contour(across, up, value.reshape(across.shape), levels=[-1.0, 0.0, 1.0], colors="0.4",
                     linestyles=[":", "-", ":"])  # fmt: skip
        axes.set(aspect="equal", xlabel="first feature", ylabel="second feature")
        axes.legend(frameon=False, fontsize="small")


def _libsvm(scene: SVM) -> Quantities:
    from sklearn.svm import SVC

    X, side = scene.data()
    model = SVC(C=scene.cost, kernel="precomputed", tol=1e-10).fit(scene.kernel(X, X), side)
    weights = np.zeros(scene.samples)
    weights[model.support_] = np.abs(model.dual_coef_[0])
    return {"weights": weights, "offset": float(model.intercept_[0]), "support vectors": float(model.support_.size)}
