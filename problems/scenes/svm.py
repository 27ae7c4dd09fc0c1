"""A support vector machine."""

from __future__ import annotations

from importlib import import_module
from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import integer
from continuation.arrays import Array
from problems.lcp.data.program import Program, from_qp
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import PIQP
from problems.scenes.scene import (
    NotNegative,
    Positive,
    Quantities,
    Rival,
    Scene,
    Seed,
    Unknown,
    with_parameters,
)


def clouds(samples: int, distance: float, seed: int) -> tuple[Array, Array]:
    """Points, shape (n, 2), and labels, -1 or 1."""
    side = np.where(np.arange(samples) % 2, 1.0, -1.0)
    X = np.random.default_rng(seed).normal(size=(samples, 2))
    X[:, 0] += 0.5 * distance * side
    return X, side


@with_parameters
def SVM(
    samples: Annotated[int, integer(2)] = 60, distance: NotNegative = 3.0, cost: Positive = 1.0,
    seed: Seed = 0,
) -> Scene:  # fmt: skip
    """Which line separates two clouds of points with the widest margin, at a price on errors?

    Parameters
    ----------
    samples, seed : int
        Half of the even number of samples are in each cloud.
    distance : float
        Between the cloud centres, in standard deviations.
    cost : float
        Price of an error: largest weight of a point.

    References
    ----------
    Cortes and Vapnik, Machine Learning 20 (1995).
    """
    X, side = clouds(samples, distance, seed)
    K = X @ X.T

    def problem() -> Program:
        P = K * np.outer(side, side)
        return from_qp(0.5 * (P + P.T), -np.ones(samples), A_eq=side[None], b_eq=[0.0], lower=0.0, upper=cost)

    def answer(solution: Any) -> Quantities:
        weights = np.asarray(solution.x)[:samples]
        force = K @ (weights * side)
        inside = (weights > 1e-7 * cost) & (weights < (1.0 - 1e-7) * cost)
        # Without points on the margin several offsets are optimal.
        offset = float(np.median((side - force)[inside])) if inside.any() else 0.0
        return {
            "weights": weights, "offset": offset, "support vectors": float((weights > 1e-7 * cost).sum()),
            "objective": float(0.5 * (weights * side) @ force - weights.sum()),
        }  # fmt: skip

    def exact() -> Quantities:
        weight = min(2.0 / float(((X[0] - X[1]) ** 2).sum()), cost)
        return {} if samples != 2 else {"weights": np.full(2, weight)}

    def drawn(solution: Any) -> Picture:
        found = answer(solution)
        chosen, (low, high) = X[found["weights"] > 1e-7 * cost], (X.min(axis=0) - 0.5, X.max(axis=0) + 0.5)
        across, up = np.meshgrid(np.linspace(low[0], high[0], 80), np.linspace(low[1], high[1], 80))
        normal = X.T @ (found["weights"] * side)
        value = normal[0] * across + normal[1] * up + found["offset"]
        return picture(
            *(mark("plot", *X[side == s].T, ".", color=colour) for s, colour in ((-1.0, "#0072B2"), (1.0, "#D55E00"))),
            mark("plot", *chosen.T, "o", markerfacecolor="none", markeredgecolor="0.3", label="support vectors"),
            mark("contour", across, up, value, levels=[-1.0, 0.0, 1.0], colors="0.4",
                 linestyles=[":", "-", ":"]),
            aspect="equal", xlabel="first feature", ylabel="second feature", legend={"fontsize": "small"},
        )  # fmt: skip

    def libsvm(scene: Any) -> Quantities:
        model = import_module("sklearn.svm").SVC(C=cost, kernel="precomputed", tol=1e-10).fit(K, side)
        weights = np.zeros(samples)
        weights[model.support_] = np.abs(model.dual_coef_[0])
        return {"weights": weights, "offset": float(model.intercept_[0]), "support vectors": float(model.support_.size)}

    return Scene(
        units={"weights": "", "offset": "", "support vectors": "", "objective": ""},
        unknowns=(Unknown("weights of points", samples, "which points decide"),
                  Unknown("offset", 1, "where the border is: the multiplier of balance")),
        problem=problem, answer=answer, exact=exact, picture=drawn,
        rivals=(Rival("SVC (sklearn)", "sklearn", libsvm), PIQP),
    )  # fmt: skip
