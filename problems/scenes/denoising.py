"""Total-variation denoising."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import scipy.sparse as sp

from continuation.arguments.checks import integer
from problems.lcp.data.problem import MixedLCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import QUADRATIC
from problems.scenes.scene import NotNegative, Positive, Quantities, Scene, Seed, Unknown, with_parameters


@with_parameters
def Denoising(
    samples: Annotated[int, integer(4)] = 200, weight: Positive = 2.0, noise: NotNegative = 0.3, seed: Seed = 0
) -> Scene:
    """Where does a signal of flat pieces jump?

    Minimise |x - y|^2 / 2 + weight * (sum of absolute jumps).

    Parameters
    ----------
    samples, seed : int
        A multiple of 4 samples.
    weight, noise : float
        The noise is a standard deviation.

    References
    ----------
    Rudin, Osher and Fatemi, Physica D 60 (1992); Chambolle, J. Math. Imaging Vision 20 (2004), for the dual.
    """
    n, levels = samples - 1, np.array([0.0, 2.0, 1.0, 3.0])
    true = levels[np.arange(samples) * 4 // samples]
    data = true + noise * np.random.default_rng(seed).normal(size=samples)

    def problem() -> MixedLCP:
        """D D' z - D y, |z| <= weight, D differences."""
        A = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n), format="csr")
        return MixedLCP(A, -np.diff(data), np.full(n, -weight), np.full(n, weight))

    def answer(solution: Any) -> Quantities:
        """The signal y - D'z jumps where |z| = weight."""
        z = np.asarray(solution.x)
        jumps = float((np.abs(z) >= weight * (1.0 - 1e-9)).sum())
        return {"signal": data + np.diff(np.pad(z, 1)), "jumps": jumps}

    def exact() -> Quantities:
        """Without noise each jump moves its two levels together by weight / length."""
        whole, rest = divmod(samples, 4)
        by = weight / whole
        moved = levels + by * np.array([1.0, -2.0, 2.0, -1.0])
        return {} if noise or rest or by > 0.2 else {"signal": np.repeat(moved, whole), "jumps": 3.0}

    def drawn(solution: Any) -> Picture:
        found = answer(solution)["signal"]
        return picture(
            mark("plot", data, ".", color="0.65", markersize=3, label="measured"),
            mark("step", range(samples), found, where="mid", color="#D55E00", label="found"),
            xlabel="sample", ylabel="signal",
        )  # fmt: skip

    return Scene(
        units={"signal": "", "jumps": ""},
        unknowns=(Unknown("forces between neighbours", n, "where the signal jumps"),),
        problem=problem, answer=answer, exact=exact, picture=drawn, rivals=QUADRATIC,
    )  # fmt: skip
