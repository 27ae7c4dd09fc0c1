"""Spectral unmixing."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from scipy.optimize import nnls

from continuation.arguments.checks import integer
from problems.lcp.data.problem import LCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import LEMKE, QUADRATIC
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


@with_parameters
def Unmixing(
    substances: Annotated[int, integer(1)] = 12, channels: Annotated[int, integer(2)] = 200, width: Positive = 0.8,
    noise: NotNegative = 0.0, seed: Seed = 0,
) -> Scene:  # fmt: skip
    """How much of each substance is in a spectrum?

    Each substance has one peak.

    Parameters
    ----------
    substances, channels, seed : int
    width : float
        Width of a peak, in peak distances.
    noise : float
        Standard deviation.

    References
    ----------
    Lawson and Hanson, Solving Least Squares Problems, 1974.
    """
    place, k = np.linspace(-1.0, substances, channels), np.arange(substances)
    amounts = np.where(k % 3 == 2, 0.0, 1.0 + 0.5 * np.sin(2.0 * k))
    spectra = np.exp(-0.5 * ((place[:, None] - k) / width) ** 2)
    measured = spectra @ amounts + noise * np.random.default_rng(seed).normal(size=channels)

    def answer(solution: Any) -> Quantities:
        x = np.asarray(solution.x)
        return {"amounts": x, "misfit": float(np.linalg.norm(spectra @ x - measured))}

    def drawn(solution: Any) -> Picture:
        x = np.asarray(solution.x)
        return picture(
            mark("plot", place, measured, "k.", markersize=2, label="measured"),
            mark("plot", place, spectra @ x, color="#D55E00", linewidth=1.0, label="sum of the parts (blue)"),
            mark("plot", place, spectra * x, color="#0072B2", linewidth=0.7),
            xlabel="channel", ylabel="intensity",
        )  # fmt: skip

    def lawson_hanson(scene: Any) -> Quantities:
        return dict(zip(("amounts", "misfit"), nnls(spectra, measured)))

    return Scene(
        units={"amounts": "", "misfit": ""},
        unknowns=(Unknown("amounts", substances, "how much of each substance"),),
        problem=lambda: LCP(spectra.T @ spectra, -spectra.T @ measured),
        answer=answer, picture=drawn,
        exact=lambda: {} if noise else {"amounts": amounts, "misfit": 0.0},
        rivals=(Rival("nnls (scipy)", "", lawson_hanson), LEMKE, *QUADRATIC),
    )  # fmt: skip
