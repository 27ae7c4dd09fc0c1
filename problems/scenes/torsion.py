"""A square bar that is twisted until it yields."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen
from numpy.typing import NDArray

from continuation.arguments.checks import integer
from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.scenes.rivals import GAUSS_SEIDEL, QUADRATIC
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive

Indices = NDArray[np.int_]


@frozen
class Torsion:
    """A square bar of an elastic, perfectly plastic material under a twist: which torque does it bear?

    Prandtl's stress function u: -lap u = 2 G twist where it is elastic, and u is at most the yield stress times the
    distance from the surface (Ting; Brezis and Sibony). By second-order differences on an eighth of the section.

    Parameters
    ----------
    side : float
        m.
    modulus : float
        Of shear, Pa.
    yield_stress : float
        Pa, in shear.
    twist : float
        rad/m.
    n : int
        Points from the surface, which is none of them, to the middle.

    References
    ----------
    Ting, "Elastic-plastic torsion of a square bar", Trans. AMS 123 (1966); Timoshenko and Goodier, Theory of
    Elasticity, for .1406.
    """

    side: float = positive(1.0)
    modulus: float = positive(1.0)
    yield_stress: float = positive(1.0)
    twist: float = positive(2.5)
    n: int = field(default=24, validator=integer(2))
    units: ClassVar[Units] = {"torque": "N m", "plastic part": ""}
    rivals: ClassVar[tuple[Rival, ...]] = (GAUSS_SEIDEL, *QUADRATIC)

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The square's eight symmetries leave a triangle."""
        return (
            Unknown("stress function", self.n * (self.n + 1) // 2, "stresses are its slopes, the torque its volume"),
        )

    def _triangle(self) -> tuple[Indices, Indices, Array]:
        """Column and row of each point, 1 <= j <= i <= n, and how many points of the square it stands for."""
        i, j = np.tril_indices(self.n)
        on_middle = (i == self.n - 1).astype(int) + (j == self.n - 1)
        return i + 1, j + 1, 8.0 / (2.0 ** (i == j) * 2.0**on_middle)

    def problem(self) -> MixedLCP:
        """Five-point differences over h^2 in the weights of the points, which keeps them symmetric."""
        i, j, weight = self._triangle()
        n, size = self.n, i.size
        rows, columns = [], []
        for di, dj in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            a, b = (np.where(k > n, 2 * n - k, k) for k in (i + di, j + dj))
            a, b = np.maximum(a, b), np.minimum(a, b)
            inside = b > 0
            rows.append(np.flatnonzero(inside))
            columns.append((a * (a - 1) // 2 + b - 1)[inside])
        row, column = np.concatenate(rows), np.concatenate(columns)
        beside = sp.coo_array((-weight[row], (row, column)), shape=(size, size))
        h = 0.5 * self.side / n
        limit = np.asarray(self.yield_stress * h * j, dtype=float)
        load = 2.0 * self.modulus * self.twist * h * h
        return MixedLCP((beside + sp.diags_array(4.0 * weight)).tocsr(), -load * weight, np.full(size, -np.inf), limit)

    def answer(self, solution: Any) -> Quantities:
        """The torque, and the part of the section in which it yields."""
        _, j, weight = self._triangle()
        h = 0.5 * self.side / self.n
        yields = solution.x >= self.yield_stress * h * j * (1.0 - 1e-9)
        whole = (2 * self.n) ** 2
        return {
            "torque": 2.0 * h * h * float(weight @ solution.x), "plastic part": float(weight @ yields) / whole,
        }  # fmt: skip

    def exact(self) -> Quantities:
        """As long as nothing yields (Saint-Venant); the rest has no closed form."""
        if 0.6753 * self.modulus * self.twist * self.side > self.yield_stress:
            return {}
        return {"torque": 0.14057701495515551 * self.modulus * self.twist * self.side**4, "plastic part": 0.0}

    def draw(self, solution: Any, axes: Any) -> None:
        """The stress function on the whole section, and where it yields."""
        i, j, _ = self._triangle()
        quarter, yields = np.zeros((self.n + 1, self.n + 1)), np.zeros((self.n + 1, self.n + 1))
        on = solution.x >= self.yield_stress * 0.5 * self.side / self.n * j * (1.0 - 1e-9)
        for a, b in ((i, j), (j, i)):
            quarter[a, b], yields[a, b] = solution.x, on
        # On the surface the stress is that of the points beside it.
        yields[0], yields[:, 0] = yields[1], yields[:, 1]
        whole, plastic = (np.block([[k, k[:, -2::-1]], [k[-2::-1], k[-2::-1, -2::-1]]]) for k in (quarter, yields))
        place = np.linspace(0.0, self.side, 2 * self.n + 1)
        axes.contourf(place, place, plastic, levels=[0.5, 1.5], colors=["#E69F00"], alpha=0.5)
        axes.contour(
            place, place, whole, levels=np.linspace(0.0, whole.max(), 13)[1:], colors="#0072B2", linewidths=0.8
        )
        axes.set(aspect="equal", xlabel="m", ylabel="m")
        axes.set_title(
            f"yields in {100.0 * self.answer(solution)['plastic part']:.0f} % of the section", fontsize="medium"
        )
