"""Isotonic regression."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import scipy.sparse as sp
from scipy.optimize import isotonic_regression

from continuation.arguments.checks import integer
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import mark, picture
from problems.scenes.rivals import QUADRATIC
from problems.scenes.scene import NotNegative, Quantities, Rival, Scene, Seed, Unknown, with_parameters


@with_parameters
def Isotonic(samples: Annotated[int, integer(2)] = 100, noise: NotNegative = 0.3, seed: Seed = 0) -> Scene:
    """Which rising curve is nearest to a noisy response?

    Parameters
    ----------
    samples, seed : int
    noise : float
        Standard deviation.

    References
    ----------
    Barlow, Bartholomew, Bremner and Brunk, Statistical Inference under Order Restrictions, 1972.
    """
    n, place = samples - 1, np.linspace(-3.0, 3.0, samples)
    data = 1.0 / (1.0 + np.exp(-2.0 * place)) + noise * np.random.default_rng(seed).normal(size=samples)

    def problem() -> LCP:
        """D D' z + D y >= 0, D differences."""
        A = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n), format="csr")
        return LCP(A, np.diff(data))

    def answer(solution: Any) -> Quantities:
        z = np.asarray(solution.x)
        return {"fit": data - np.diff(np.pad(z, 1)), "steps": 1.0 + float((z == 0.0).sum())}

    def exact() -> Quantities:
        fit = isotonic_regression(data).x
        return {"fit": fit, "steps": 1.0 + float((np.diff(fit) > 0.0).sum())}

    return Scene(
        units={"fit": "", "steps": ""},
        unknowns=(Unknown("forces between neighbours", n, "which samples are pooled"),),
        problem=problem, answer=answer, exact=exact,
        picture=lambda solution: picture(
            mark("plot", data, ".", color="0.6", label="measured"),
            mark("step", range(samples), answer(solution)["fit"], where="mid", color="#0072B2", label="rising fit"),
            xlabel="sample", ylabel="response",
        ),
        rivals=(Rival("pool adjacent violators", "", lambda scene: {"fit": isotonic_regression(data).x}), *QUADRATIC),
    )  # fmt: skip
