"""Aircraft equilibria at high angle of attack."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.evaluation.functions import from_functions
from continuation.events.box import Box
from continuation.tracing import solve_at
from problems.bibliography import MELHEM_RHEINBOLDT, RHEINBOLDT_BURKARDT
from problems.options import finite, finite_or_none, quiet

_FACTORS = np.array([[0, 1, 2, 3, 4, 1, 2, 3, 0, 0, 0, 0, 6, 5, 3], [7, 7, 7, 7, 7, 2, 3, 4, 2, 4, 1, 3, 7, 7, 5]])
"""The two factors of each monomial in (roll, pitch, yaw rate, angle of attack, sideslip, aileron, elevator, 1)."""

_COEFFICIENTS = np.array(
    [
        [-3.933, 0.107, 0.126, 0.0, -9.99, -0.727, 8.39, -684.4, 0.0, 0.0, 0.0, 0.0, 0.0, -45.83, 63.5],
        [0.0, -0.987, 0.0, -22.95, 0.0, 0.0, 0.0, 0.0, 0.949, 0.173, 0.0, 0.0, -28.37, 0.0, 0.0],
        [0.002, 0.0, -0.235, 0.0, 5.67, 0.0, 0.0, 0.0, 0.0, 0.0, -0.716, -1.578, 0.0, -0.921, 1.132],
        [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, -0.168, 0.0, 0.0],
        [0.0, 0.0, -1.0, 0.0, -0.196, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -0.0071, 0.0],
    ]
)


@frozen
class Aircraft:
    """Equilibria of an aircraft: five quadratic equations.

    y = (roll rate, pitch rate, yaw rate, angle of attack, sideslip), lam = aileron; the rudder is 0.

    Parameters
    ----------
    elevator : float
        The source takes -0.05, -0.008, 0, 0.05 and 0.1.
    target : float or None
        lam at the end.

    References
    ----------
    Melhem and Rheinboldt, Computing 29, 1982; Rheinboldt and Burkardt, ACM TOMS 9(2), 1983.
    """

    elevator: float = field(default=0.0, validator=finite)
    target: float | None = field(default=None, validator=finite_or_none)
    box: ClassVar[Box] = {"lam": (-5.0, 5.0)}
    problem_class: ClassVar[str] = "equilibria of vehicles"
    references: ClassVar[tuple[str, ...]] = (MELHEM_RHEINBOLDT, RHEINBOLDT_BURKARDT)

    def start(self) -> tuple[Array, float]:
        """Equilibrium at aileron 0, by Newton from level flight.

        Raises
        ------
        ArithmeticError
            If Newton fails.
        """
        level = from_functions(self.residual, self.jacobian, start=(np.zeros(5), 0.0))
        return solve_at(level, 0.0), 0.0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """The equations, shape (5,)."""
        first, second = self._factors(y, lam)
        equations: Array = _COEFFICIENTS @ (first * second)
        return equations

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Array, Array]:
        """(H_y, H_lam), shapes (5, 5) and (5,)."""
        (first, second), (by_first, by_second) = self._factors(y, lam), np.eye(8)[_FACTORS, :6]
        whole = _COEFFICIENTS @ (second[:, None] * by_first + first[:, None] * by_second)
        return whole[:, :5], whole[:, 5]

    def _factors(self, y: Array, lam: float) -> tuple[Array, Array]:
        u = np.concatenate((y, lam * np.ones(1), np.array([self.elevator, 1.0])))
        return u[_FACTORS[0]], u[_FACTORS[1]]
