"""A twisted square bar that yields."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import scipy.sparse as sp

from continuation.arguments.checks import integer
from problems.lcp.data.problem import MixedLCP
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.rivals import QUADRATIC
from problems.scenes.scene import Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Torsion(
    side: Positive = 1.0, modulus: Positive = 1.0, yield_stress: Positive = 1.0, twist: Positive = 2.5,
    n: Annotated[int, integer(2)] = 24,
) -> Scene:  # fmt: skip
    """Which torque does a twisted square bar of an elastic, perfectly plastic material bear?

    Prandtl's stress function u satisfies -lap u = 2 G twist where elastic, and u <= yield stress * distance from the
    surface. Second-order differences cover an eighth of the section.

    Parameters
    ----------
    side, twist : float
        m; rad/m.
    modulus, yield_stress : float
        In shear, Pa.
    n : int
        Points from the surface (excluded) to the middle.

    References
    ----------
    Ting, Trans. AMS 123 (1966); Timoshenko and Goodier, Theory of Elasticity, for .1406.
    """
    h = 0.5 * side / n
    # Each point's multiplicity in the square.
    i, j = (k + 1 for k in np.tril_indices(n))
    size, weight = i.size, 8.0 / (2.0 ** (i == j) * 2.0 ** ((i == n).astype(int) + (j == n)))
    limit = np.asarray(yield_stress * h * j, dtype=float)

    def problem() -> MixedLCP:
        """The multiplicity keeps symmetry."""
        # Neighbours reflect at the middle and the diagonal; u = 0 on the surface.
        a, b = (n - np.abs(n - np.add.outer(ways, k)) for ways, k in (((1, -1, 0, 0), i), ((0, 0, 1, -1), j)))
        a, b = np.maximum(a, b), np.minimum(a, b)
        row, inside = np.broadcast_to(np.arange(size), a.shape)[b > 0], b > 0
        beside = sp.coo_array((-weight[row], (row, (a * (a - 1) // 2 + b - 1)[inside])), shape=(size, size))
        load = 2.0 * modulus * twist * h * h
        return MixedLCP((beside + sp.diags_array(4.0 * weight)).tocsr(), -load * weight, np.full(size, -np.inf), limit)

    def yields(x: Any) -> Any:
        return x >= yield_stress * h * j * (1.0 - 1e-9)

    def answer(solution: Any) -> Quantities:
        x = solution.x
        return {
            "torque": 2.0 * h * h * float(weight @ x), "plastic part": float(weight @ yields(x)) / (2 * n) ** 2,
        }  # fmt: skip

    def exact() -> Quantities:
        """Saint-Venant's torque holds until the bar yields."""
        elastic = {"torque": 0.14057701495515551 * modulus * twist * side**4, "plastic part": 0.0}
        return {} if 0.6753 * modulus * twist * side > yield_stress else elastic

    def drawn(solution: Any) -> Picture:
        quarter = np.zeros((2, n + 1, n + 1))
        quarter[:, i, j] = quarter[:, j, i] = solution.x, yields(solution.x)
        quarter[1, 0], quarter[1, :, 0] = quarter[1, 1], quarter[1, :, 1]
        whole, plastic = (np.block([[k, k[:, -2::-1]], [k[-2::-1], k[-2::-1, -2::-1]]]) for k in quarter)
        place = np.linspace(0.0, side, 2 * n + 1)
        return picture(
            mark("contourf", place, place, plastic, levels=[0.5, 1.5], colors=["#E69F00"], alpha=0.5),
            mark("contour", place, place, whole, levels=np.linspace(0.0, whole.max(), 13)[1:], colors="#0072B2",
                 linewidths=0.8),
            aspect="equal", xlabel="m", ylabel="m",
            title=f"yields in {100.0 * answer(solution)['plastic part']:.0f} % of the section",
        )  # fmt: skip

    return Scene(
        units={"torque": "N m", "plastic part": ""},
        unknowns=(Unknown("stress function", size, "stresses are its slopes, the torque its volume"),),
        problem=problem, answer=answer, exact=exact, picture=drawn, rivals=QUADRATIC,
    )  # fmt: skip
