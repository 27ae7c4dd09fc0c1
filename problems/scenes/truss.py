"""Bars that yield until collapse."""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np

from continuation.arrays import Array
from problems.lcp.data.problem import LCP
from problems.lcp.parametric.along import along
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import NotNegative, Numbers, Positive, Quantities, Scene, Unknown, with_parameters


@with_parameters
def Truss(
    limits: Numbers = (0.3, 0.6, 1.2), stiffness: Positive = 1.0, hardening: NotNegative = 0.0, load: Positive = 1.9
) -> Scene:
    """How do parallel bars that hold a rigid beam yield as the load grows?

    Bars are elastic, then plastic. Without hardening the path ends in a ray at the collapse load.

    Parameters
    ----------
    limits : sequence of float
        Yield forces.
    stiffness, hardening : float
        Force per elastic and per plastic elongation; hardening 0 is perfect plasticity.
    load : float

    References
    ----------
    Maier, Meccanica 5 (1970).
    """
    n, most = len(limits), np.array(limits)
    A = (stiffness + hardening) * np.eye(n) - stiffness / n * np.ones((n, n))

    def answer(solution: Any) -> Quantities:
        end, v = solution.endpoint, solution.steps[-1].tangent
        collapse = inf if v[-1] > 1e-12 * np.abs(v).max() else end.lam
        if load > collapse:
            raise ArithmeticError(f"load: the bars bear {collapse:g} at most, found {load:g}")
        strain = solution(t=load)[:-1] if load <= end.lam else end.y + (load - end.lam) / v[-1] * v[:-1]
        return {
            "plastic elongations": strain, "forces": load / n - stiffness * (strain - strain.mean()),
            "collapse load": collapse,
            "yield loads": np.array([kink.lam for kink in solution.kinks]),
        }  # fmt: skip

    def exact() -> Quantities:
        """All bars stretch equally."""
        soft, stretches = stiffness * hardening / (stiffness + hardening), np.sort(most) / stiffness

        def forces(stretch: float) -> Array:
            whole: Array = np.minimum(stiffness * stretch, most) + soft * np.maximum(stretch - most / stiffness, 0.0)
            return whole

        yields = np.array([forces(stretch).sum() for stretch in stretches])
        beyond = max(load - yields[-1], 0.0) / (soft * n) if soft else 0.0
        stretch = beyond + float(np.interp(load, [0.0, *yields], [0.0, *stretches]))
        known = {"yield loads": yields} if hardening else {"forces": forces(stretch), "collapse load": most.sum()}
        return {"plastic elongations": stretch - forces(stretch) / stiffness, **known}

    def drawn(solution: Any) -> Picture:
        u, v = solution.u, solution.steps[-1].tangent
        u = np.vstack([u, u[-1] + v / np.abs(v).max() * 0.2 * np.abs(u).max()])
        stretch, loads = u[:, -1] / n / stiffness + u[:, :-1].mean(axis=1), [kink.lam for kink in solution.kinks]
        at = np.interp(loads, u[:, -1], stretch) if hardening else stretch[1 : len(loads) + 1]
        return picture(
            mark("plot", stretch, u[:, -1], color="#0072B2"),
            mark("plot", at, loads, "kD", markersize=5, label="a bar yields"),
            mark("axhline", load, color="0.6", linewidth=0.8, zorder=0, label="the load"),
            xlabel="stretch (length)", ylabel="load (force)",
        )  # fmt: skip

    return Scene(
        units={"plastic elongations": "length", "forces": "force", "collapse load": "force", "yield loads": "force"},
        unknowns=(Unknown("plastic elongations", n, "which bars have yielded; forces follow from them"),),
        problem=lambda: LCP(A, most - load / n),
        solve=lambda: along(LCP(A, most), np.full(n, -1.0 / n), (0.0, inf), x=np.zeros(n)),
        answer=answer, exact=exact, picture=drawn,
    )  # fmt: skip
