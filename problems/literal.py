"""The paper's algorithm, Steps 0-5 as printed, for comparison only.

It corrects once per step, accepts ||H|| <= 1 absolutely, and Step 4 may continue from a point that failed every test.
The text leaves a_0 and the norms open; with the choices here the ten examples take 18, 21, 15, 24, 17, 24, 18, 3289, 27
and 1955 iterations.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import FRACTION, POSITIVE_FINITE, integer
from continuation.arrays import Array
from problems.lcp import LCP
from problems.lcp.homotopies import KKTHomotopy
from problems.options import quiet

LITERAL_SOLVED_TO = 1e-3
"""Relative natural residual of a solution: 8e-5 on example 7 at the stopping rule, at least 0.1 at a false end."""


@frozen
class LiteralSettings:
    """Step 0: the algorithm's numbers.

    Steps are a = l0^l. The run stops at lambda <= eps1; Step 4 compares lambda and its change with eps2; Steps 3 and 2
    shorten a to eps3 and a0. The paper gives no a0; 1e-6 ends seven examples early, by Step 4 at a negative lambda. It
    gives no `max_iterations`; example 8 needs 3,289.
    """

    l0: float = field(default=0.5, validator=FRACTION)
    eps1: float = field(default=1e-9, validator=POSITIVE_FINITE)
    eps2: float = field(default=1e-3, validator=POSITIVE_FINITE)
    eps3: float = field(default=1e-6, validator=POSITIVE_FINITE)
    a0: float = field(default=1e-9, validator=POSITIVE_FINITE)
    max_iterations: int = field(default=10_000, validator=integer(1))


DEFAULT = LiteralSettings()


@frozen(eq=False)
class LiteralRun:
    """A run of the algorithm.

    `u`, shape (iterations + 1, 3 n + 1): accepted points (x, z1, z2, lambda). `ended_by`: last step.
    """

    u: Array
    ended_by: str
    claims_solution: bool
    problem: LCP

    @property
    def iterations(self) -> int:
        """Iterations as the paper counts."""
        return len(self.u) - 1

    @property
    def lam(self) -> Array:
        """Lambda, shape (iterations + 1,)."""
        return self.u[:, -1]

    @property
    def x(self) -> Array:
        """Final x, shape (n,)."""
        return self.u[-1, : self.problem.n]

    @property
    def residual(self) -> float:
        """Natural residual of x."""
        return self.problem.natural_residual(self.x)

    @property
    def solved(self) -> bool:
        """Whether x solves the problem to `LITERAL_SOLVED_TO`."""
        return self.residual <= LITERAL_SOLVED_TO * (1.0 + float(np.abs(self.problem.q).max()))


def run_literally(
    problem: LCP, x0: Any, z1: Any = None, z2: Any = None, settings: LiteralSettings = DEFAULT
) -> LiteralRun:
    """Run Steps 0-5 on the KKT homotopy from x0 > 0 with A x0 + q > 0.

    `problem`: small (dense solves of 3 n unknowns). `x0`, `z1`, `z2`: shape (n,), positive; z default to ones. Raises
    `ValueError` for other starts.

    References
    ----------
    Dutta, Das and Jana, "Bounded Homotopy Path Approach", section "Algorithm".
    """
    homotopy = KKTHomotopy(problem, x0, z1, z2)
    w0 = problem.w(homotopy.origin.x0)
    if (w0 <= 0.0).any():
        raise ValueError(f"x0: expected a strictly feasible point, A x0 + q > 0, found {w0.min():g} at {w0.argmin()}")
    y0, lam0 = homotopy.start()
    points = [np.append(y0, lam0)]
    ended = ""
    while not ended and len(points) <= settings.max_iterations:
        point, step = _iterate(homotopy, points[-1], settings, first=len(points) == 1)
        before = points[-1][-1]
        points.append(point)
        if step == 5 and abs(point[-1]) <= settings.eps1:
            return LiteralRun(np.array(points), "Step 5: lambda <= eps1.", True, problem)
        if step == 4 and abs(point[-1] - before) < settings.eps2:
            if abs(point[-1]) < settings.eps2:
                return LiteralRun(np.array(points), "Step 4: lambda stalls below eps2.", True, problem)
            ended = "Step 4: lambda stalls; unable to find a solution."
    ended = ended or f"No end within {settings.max_iterations} iterations."
    return LiteralRun(np.array(points), ended, False, problem)


@quiet
def _iterate(homotopy: KKTHomotopy, u: Array, settings: LiteralSettings, first: bool) -> tuple[Array, int]:
    tangent = _tangent(homotopy, u, first)
    a = 1.0
    while True:
        predicted = u + a * tangent
        point = predicted - _moore_penrose(homotopy, predicted)
        if not 0.0 < point[-1] < 1.0:
            shortest, too_short = min(a, float(np.linalg.norm(point - u))), settings.a0
        elif np.linalg.norm(homotopy.residual(point[:-1], float(point[-1]))) <= 1.0 and (point[:-1] > 0.0).all():
            return point, 5
        else:
            shortest, too_short = a, settings.eps3
        if shortest <= too_short:
            return point, 4
        a *= settings.l0


def _tangent(homotopy: KKTHomotopy, u: Array, first: bool) -> Array:
    """Step 1: (s, -1) normalised, s = H_y^{-1} H_lambda, reversed after the start if det H_y <= 0."""
    H_y, H_lam = homotopy.jacobian(u[:-1], float(u[-1]))
    xi: Array = np.append(np.linalg.solve(H_y, H_lam), -1.0)
    xi /= np.linalg.norm(xi)
    return xi if first or np.linalg.slogdet(H_y)[0] > 0.0 else -xi


def _moore_penrose(homotopy: KKTHomotopy, u: Array) -> Array:
    correction: Array = np.linalg.lstsq(
        np.column_stack(homotopy.jacobian(u[:-1], float(u[-1]))), homotopy.residual(u[:-1], float(u[-1])), rcond=None
    )[0]
    return correction
