"""Lasso path."""

from __future__ import annotations

from importlib import import_module
from math import inf
from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import integer
from continuation.arrays import Array
from continuation.path import Path
from problems.lcp.data.problem import MixedLCP
from problems.lcp.parametric.along import along
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import NotNegative, Quantities, Rival, Scene, Seed, Unknown, with_parameters


def penalised(G: Array, c: Array) -> Path:
    """Path of min b'Gb/2 - c'b + t |b|_1 from b = 0 to t = 0.

    References
    ----------
    Osborne, Presnell and Turlach, IMA J. Numer. Anal. 20 (2000); Efron, Hastie, Johnstone and Tibshirani, Ann. Statist.
    32 (2004).
    """
    return along(MixedLCP(G, -c), np.zeros(c.size), (inf, 0.0), level=1.0)


@with_parameters
def Lasso(
    samples: Annotated[int, integer(1)] = 60, features: Annotated[int, integer(1)] = 12,
    relevant: Annotated[int, integer(0)] = 4, noise: NotNegative = 0.5, penalty: NotNegative = 5.0, seed: Seed = 0,
) -> Scene:  # fmt: skip
    """Which features explain an observation, as the penalty on their coefficients falls?

    The path of min |X b - y|^2 / 2 + t |b|_1 has kinks where features enter or leave.

    Parameters
    ----------
    samples, features, seed : int
    relevant : int
        Nonzero true coefficients.
    noise : float
        Standard deviation.
    penalty : float
        The penalty at which coefficients are reported.

    References
    ----------
    Tibshirani, J. R. Statist. Soc. B 58 (1996).
    """
    random = np.random.default_rng(seed)
    X, b = random.normal(size=(samples, features)), np.zeros(features)
    few = min(relevant, features)
    b[:few] = np.linspace(3.0, 1.0, few) * (-1.0) ** np.arange(few)
    y = X @ b + noise * random.normal(size=samples)

    def answer(solution: Any) -> Quantities:
        enters = solution.lam[0] if not solution.kinks else solution.kinks[0].lam
        b = solution(t=penalty)[:-1] if penalty < enters else np.zeros(features)
        return {"coefficients": b, "first enters at": enters, "kinks": float(len(solution.kinks))}

    def exact() -> Quantities:
        least = {} if penalty or samples <= features else {"coefficients": np.linalg.lstsq(X, y)[0]}
        return {"first enters at": float(np.abs(X.T @ y).max()), **least}

    def drawn(solution: Any) -> Picture:
        kinks = ((np.full(len(kink.switches), kink.lam), kink.y[list(kink.switches)]) for kink in solution.kinks)
        return picture(
            mark("plot", solution.lam, solution.y, linewidth=1.0),
            *(mark("plot", *kink, "k.", markersize=5) for kink in kinks),
            mark("axvline", penalty, color="0.6", linewidth=0.8, zorder=0, label=f"penalty {penalty:g}"),
            xlabel="penalty", ylabel="coefficients", xlim=(1.02 * solution.kinks[0].lam, 0.0),
        )  # fmt: skip

    def lars(scene: Any) -> Quantities:
        t, _, b = import_module("sklearn.linear_model").lars_path(X, y, method="lasso", max_iter=50 * features)
        t = t * samples
        return {"coefficients": np.array([np.interp(-penalty, -t, row) for row in b]), "first enters at": float(t[0])}

    return Scene(
        units={"coefficients": "", "first enters at": "", "kinks": ""},
        # Splitting signs would make the problem singular.
        unknowns=(Unknown("coefficients", features, "which features matter, and how much"),),
        problem=lambda: MixedLCP(X.T @ X, -X.T @ y),
        solve=lambda: penalised(X.T @ X, X.T @ y),
        answer=answer, exact=exact, picture=drawn,
        rivals=(Rival("lars_path (sklearn)", "sklearn", lars),),
    )  # fmt: skip
