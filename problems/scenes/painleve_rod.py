"""Painleve's rod: a rod that slides on a rough table may have no acceleration at all, or two."""

from __future__ import annotations

from math import cos, inf, pi, sin, sqrt
from typing import Any, ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FINITE, NOT_NEGATIVE, number
from continuation.path import Path
from problems.lcp.data.problem import LCP
from problems.lcp.parametric.along import along
from problems.scenes.rivals import LEMKE, TABLES
from problems.scenes.scene import Quantities, Rival, Units, Unknown, positive


@frozen
class PainleveRod:
    """A rod that slides with one end on a rough table: which contact forces are possible?

    With a force x its end accelerates upward by a x / mass + b: a < 0 where friction is large, b > 0 where it spins
    fast. The path of x as b moves has a turning kink at b = 0.

    Parameters
    ----------
    mass : float
        kg.
    half_length : float
        m.
    angle : float
        Between rod and table.
    friction : float
    spin : float
        rad/s.
    gravity : float
        m/s^2.

    References
    ----------
    Painleve, C. R. Acad. Sci. Paris 121 (1895); Stewart, SIAM Review 42 (2000), section 3.
    """

    mass: float = positive(1.0)
    half_length: float = positive(1.0)
    angle: float = field(default=pi / 3.0, validator=number("an angle between 0 and pi/2", lambda a: 0.0 < a < pi / 2))
    friction: float = field(default=2.0, validator=NOT_NEGATIVE)
    spin: float = field(default=4.0, validator=FINITE)
    gravity: float = positive(9.81)
    units: ClassVar[Units] = {
        "a": "", "acceleration without force": "m/s^2", "critical spin": "rad/s", "forces": "N",
    }  # fmt: skip
    # At the spin of the scene they find one of two forces, or none and do not say why.
    rivals: ClassVar[tuple[Rival, ...]] = (LEMKE, TABLES)

    @property
    def a(self) -> float:
        """The upward acceleration of the end by a unit force, times the mass: -.8480762 for the defaults."""
        c, s = cos(self.angle), sin(self.angle)
        return 1.0 + 3.0 * c * (c - self.friction * s)

    @property
    def b(self) -> float:
        """The upward acceleration of the end without a force."""
        return self.half_length * self.spin**2 * sin(self.angle) - self.gravity

    @property
    def unknowns(self) -> tuple[Unknown, ...]:
        """The contact force; friction is that times the coefficient, as the rod slides."""
        return (Unknown("contact force", 1, "whether the rod lifts off or is pressed down"),)

    def problem(self) -> LCP:
        """At the spin of the scene."""
        return LCP([[self.a / self.mass]], [self.b])

    def solve(self) -> Path:
        """The path of the force as b falls from where the rod lifts off, on to whatever follows."""
        start, rod = max(2.0 * abs(self.b), self.gravity), LCP([[self.a / self.mass]], [0.0])
        end = inf if self.a < 0.0 else -inf
        return along(rod, [1.0], (start, end), x=[0.0], ray=[0.0, -1.0])

    def answer(self, solution: Any) -> Quantities:
        """The forces that are possible at the spin of the scene: none, one or two."""
        if isinstance(solution, Path):
            forces = np.unique(solution.crossings(self.b)[:, 0])
            # The last stretch, the ray beyond the last point, goes on as it began.
            end, v = solution.endpoint.u, solution.steps[-1].tangent
            beyond = (self.b - end[1]) / v[1] if v[1] else -1.0
            forces = np.unique(np.append(forces, end[0] + beyond * v[0])) if beyond > 0.0 else forces
        else:
            forces = solution.x
        critical = sqrt(self.gravity / (self.half_length * sin(self.angle)))
        return {"a": self.a, "acceleration without force": self.b, "critical spin": critical, "forces": forces}

    def exact(self) -> Quantities:
        """The rod lifts off if b >= 0; a force a x = -mass b keeps it down if it is positive."""
        pressed = -self.mass * self.b / self.a
        forces = [0.0] * (self.b >= 0.0) + [pressed] * (pressed > 0.0)
        return {"forces": np.array(forces)}

    def draw(self, solution: Any, axes: Any) -> None:
        """The force against b."""
        x, b = solution.u[:, 0], solution.u[:, 1]
        end, v = solution.endpoint.u, solution.steps[-1].tangent
        far = end + (b[0] / abs(v[1]) if v[1] else 0.0) * v
        axes.plot(np.append(b, far[1]), np.append(x, far[0]), color="#0072B2")
        axes.plot([kink.lam for kink in solution.kinks], [kink.y[0] for kink in solution.kinks], "kD", label="kink")
        forces = np.atleast_1d(self.answer(solution)["forces"])
        axes.plot(np.full(forces.size, self.b), forces, "o", color="#D55E00", label=f"at {self.spin:g} rad/s")
        axes.axvline(self.b, color="0.8", linewidth=0.8, zorder=0)
        axes.set(xlabel="upward acceleration of the end without a force (m/s$^2$)", ylabel="contact force (N)")
        axes.legend(frameon=False)
