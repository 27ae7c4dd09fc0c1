"""Painleve's rod."""

from __future__ import annotations

from math import cos, inf, pi, sin, sqrt
from typing import Annotated, Any

import numpy as np

from continuation.arguments.checks import number
from continuation.path import Path
from problems.lcp.data.problem import LCP
from problems.lcp.parametric.along import along
from problems.scenes.pictures import Picture, mark, picture
from problems.scenes.scene import Finite, NotNegative, Positive, Quantities, Scene, Unknown, with_parameters

Slope = Annotated[float, number("an angle between 0 and pi/2", lambda angle: 0.0 < angle < pi / 2)]


@with_parameters
def PainleveRod(
    mass: Positive = 1.0, half_length: Positive = 1.0, angle: Slope = pi / 3.0, friction: NotNegative = 2.0,
    spin: Finite = 4.0, gravity: Positive = 9.81,
) -> Scene:  # fmt: skip
    """Which contact forces are possible on a rod that slides with one end on a rough table?

    A force x accelerates the end upward by a x / mass + b; large friction makes a < 0. The path of x over b has a
    turning kink at b = 0.

    Parameters
    ----------
    mass, half_length : float
        kg, m.
    angle : float
        Between rod and table.
    friction : float
    spin, gravity : float
        rad/s, m/s^2.

    References
    ----------
    Painleve, C. R. Acad. Sci. Paris 121 (1895); Stewart, SIAM Review 42 (2000), section 3.
    """
    c, s = cos(angle), sin(angle)
    a, b = 1.0 + 3.0 * c * (c - friction * s), half_length * spin**2 * s - gravity

    def solved() -> Path:
        start, end = max(2.0 * abs(b), gravity), inf if a < 0.0 else -inf
        return along(LCP([[a / mass]], [0.0]), [1.0], (start, end), x=[0.0], ray=[0.0, -1.0])

    def possible(path: Path) -> Any:
        """Forces at b on the path or the ray behind its end."""
        end, v = path.endpoint.u, path.steps[-1].tangent
        beyond = (b - end[1]) / v[1] if v[1] else -1.0
        return np.unique(np.append(path.crossings(b)[:, 0], [end[0] + beyond * v[0]] * bool(beyond > 0.0)))

    def answer(solution: Any) -> Quantities:
        critical = sqrt(gravity / (half_length * s))
        return {"a": a, "acceleration without force": b, "critical spin": critical, "forces": possible(solution)}

    def exact() -> Quantities:
        """The rod lifts off if b >= 0; a positive force a x = -mass b presses it down."""
        pressed = -mass * b / a
        return {"forces": np.array([0.0] * (b >= 0.0) + [pressed] * (pressed > 0.0))}

    def drawn(solution: Any) -> Picture:
        end, v = solution.endpoint.u, solution.steps[-1].tangent
        x, t = np.vstack([solution.u, end + (solution.lam[0] / abs(v[1]) if v[1] else 0.0) * v]).T
        forces, kinks = np.atleast_1d(possible(solution)), np.reshape([kink.u for kink in solution.kinks], (-1, 2))
        return picture(
            mark("plot", t, x, color="#0072B2"),
            mark("plot", kinks[:, 1], kinks[:, 0], "kD", label="kink"),
            mark("plot", np.full(forces.size, b), forces, "o", color="#D55E00", label=f"at {spin:g} rad/s"),
            mark("axvline", b, color="0.8", linewidth=0.8, zorder=0),
            xlabel="upward acceleration of the end without a force (m/s$^2$)", ylabel="contact force (N)",
        )  # fmt: skip

    return Scene(
        units={"a": "", "acceleration without force": "m/s^2", "critical spin": "rad/s", "forces": "N"},
        unknowns=(Unknown("contact force", 1, "whether the rod lifts off or is pressed down"),),
        problem=lambda: LCP([[a / mass]], [b]),
        solve=solved, answer=answer, exact=exact, picture=drawn,
    )  # fmt: skip
