"""The paper's own algorithm, Steps 0-5, as printed, for comparison.

The engine does not use it: its corrector stops after one iteration, its acceptance test, ||H|| <= 1, is absolute, and
its Step 4 may go on from a point that has failed every test. On example 1 that happens once, at the third point, and
the algorithm ends at another KKT point. Where the text leaves a number open (a_0, the norms) the choice is noted; with
these choices the iteration counts on the ten examples are 18, 21, 15, 24, 17, 24, 18, 3289, 27 and 1955.
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

MAX_ITERATIONS = 10_000
"""The paper names no limit; example 8 needs 3,289 iterations."""

LITERAL_SOLVED_TO = 1e-3
"""Natural residual, relative to 1 + max |q|, at which an end counts as a solution: the stopping rule leaves 8e-5 on
example 7, and a false end is off by 0.1 or more (example 1)."""


@frozen
class LiteralSettings:
    """Step 0: the numbers of the algorithm.

    `l0`: The step is a = l0^l, with l = 0 at the start of every iteration; in (0, 1). `eps1`, `eps2`, `eps3`: Stop at
    lambda <= eps1; Step 4 compares lambda and its change with eps2; Step 3 shortens a down to eps3. `a0`: Step 2
    shortens a down to a0. The paper gives no value; at 1e-6 it ends earlier on seven of the ten examples, by Step 4 and
    at a negative lambda.
    """

    l0: float = field(default=0.5, validator=FRACTION)
    eps1: float = field(default=1e-9, validator=POSITIVE_FINITE)
    eps2: float = field(default=1e-3, validator=POSITIVE_FINITE)
    eps3: float = field(default=1e-6, validator=POSITIVE_FINITE)
    a0: float = field(default=1e-9, validator=POSITIVE_FINITE)
    max_iterations: int = field(default=MAX_ITERATIONS, validator=integer(1))


DEFAULT = LiteralSettings()


@frozen(eq=False)
class LiteralRun:
    """What the paper's algorithm did.

    `u`, of shape (iterations + 1, 3 n + 1): Every accepted point (x, z1, z2, lambda), the start first. `ended_by`: The
    step that ended it, in words. `claims_solution`: Whether that step says "stop with the solution".
    """

    u: Array
    ended_by: str
    claims_solution: bool
    problem: LCP

    @property
    def iterations(self) -> int:
        """How often i was increased, as the paper counts."""
        return len(self.u) - 1

    @property
    def lam(self) -> Array:
        """The parameter, shape (iterations + 1,)."""
        return self.u[:, -1]

    @property
    def x(self) -> Array:
        """The x it ends with, shape (n,)."""
        return self.u[-1, : self.problem.n]

    @property
    def residual(self) -> float:
        """The natural residual of x."""
        return self.problem.natural_residual(self.x)

    @property
    def solved(self) -> bool:
        """Whether x is a solution, to `LITERAL_SOLVED_TO`, with or without a claim."""
        return self.residual <= LITERAL_SOLVED_TO * (1.0 + float(np.abs(self.problem.q).max()))


def run_literally(
    problem: LCP, x0: Any, z1: Any = None, z2: Any = None, settings: LiteralSettings = DEFAULT
) -> LiteralRun:
    """Run Steps 0-5 on the KKT homotopy from a strictly feasible start.

    `problem`: Small: the full system of 3 n unknowns is solved densely. `x0`, of shape (n,): x0 > 0 with A x0 + q > 0,
    which the algorithm presupposes. `z1`, `z2`, of shape (n,): Ones by default. Raises `ValueError` if a vector is not
    positive or of the wrong length, or if x0 is not strictly feasible.

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
    """Steps 1 to 3 at one point: the next point, and the step (4 or 5) to go to with it."""
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
    """Step 1: (s, -1) normalised with s = H_y^{-1} H_lambda, reversed after the start where det H_y <= 0."""
    H_y, H_lam = homotopy.jacobian(u[:-1], float(u[-1]))
    xi: Array = np.append(np.linalg.solve(H_y, H_lam), -1.0)
    xi /= np.linalg.norm(xi)
    return xi if first or np.linalg.slogdet(H_y)[0] > 0.0 else -xi


def _moore_penrose(homotopy: KKTHomotopy, u: Array) -> Array:
    """H'(u)^+ H(u), the least-squares solution of least norm."""
    correction: Array = np.linalg.lstsq(
        np.column_stack(homotopy.jacobian(u[:-1], float(u[-1]))), homotopy.residual(u[:-1], float(u[-1])), rcond=None
    )[0]
    return correction
