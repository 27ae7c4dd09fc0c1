"""The result of `solve`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.counts import Counts
from continuation.path import Path, Step
from continuation.plot.html import TABLE_ROWS, table
from continuation.status import Described, Kind, Status
from problems.lcp.data.problem import MixedLCP
from problems.lcp.data.program import Program
from problems.lcp.parametric.sensitivity import NotDifferentiableError, Sensitivity, sensitivity
from problems.lcp.proof.certificate import Certificate
from problems.lcp.proof.farkas import Farkas, FloatFarkas, infeasibility
from problems.lcp.reference.enumeration import Exhaustion


class Outcome(Described):
    """The outcome; ``str()`` gives its sentence."""

    SOLVED = (
        0,
        "Solved: x is between its bounds (x >= 0), and w has the signs that these ask for, to the tolerance, each row "
        "relative to its own terms, verified in twice the working precision.",
    )
    STATIONARY = (
        1,
        "A stationary point of min x'w over x >= 0, w >= 0 was found, and it does not solve the LCP; "
        "other solutions may exist.",
    )
    UNSOLVABLE = 2, "The problem has no solution, which is proved exactly."
    NOT_FOUND = 3, "No solution was found, and none is excluded."
    INFEASIBLE_TO_PRECISION = (
        4,
        "To working precision no x between the bounds gives w the signs that a solution has, complementary or not: a "
        "multiplier y with q'y < 0 says so but for rounding. A change of A in its last digits makes that a proof.",
    )
    SOLVED_TO_PRECISION = (
        5,
        "Solved to working precision: x solves a problem whose entries differ from these in their last digits (for a "
        "program, by the rounding of the largest of them); in exact arithmetic the face of x holds no solution, so the "
        "data as given may have none.",
    )

    def __str__(self) -> str:
        return str(self.__doc__)

    def __bool__(self) -> bool:
        return self.success

    @property
    def success(self) -> bool:
        """Whether a solution was found."""
        return self in (Outcome.SOLVED, Outcome.SOLVED_TO_PRECISION)


_PROOFS = {
    "farkas": "A Farkas vector, verified exactly, proves that no x between the bounds (x >= 0) has w with these signs.",
    "exhaustion": "None of the complementary faces holds a solution: all were tried, with error bounds or exactly.",
    "groups": "None of the complementary faces holds a solution: Farkas vectors, verified with error bounds or "
    "exactly, exclude them in groups.",
    "unrepresented": "In exact arithmetic there is one (`exhaustion.x`), which rounded to floats is none: q drowns.",
}


@frozen(eq=False, repr=False)
class Solution:
    """The answer to one LCP.

    Attributes
    ----------
    problem : MixedLCP
    outcome : Outcome
    message : str
        What was done, and what the outcome means.
    certificate : Certificate or None
        Of the point `x`.
    paths : tuple of Path
        All traced paths; of failed restarts only the ends.
    best : int
        Index of the path that led to `x`, or -1.
    counts : Counts
        For all paths and finishes.
    seconds : float
        Wall-clock time.
    farkas : Farkas or None
        Proves UNSOLVABLE if no point is feasible.
    exhaustion : Exhaustion or None
        Proves UNSOLVABLE if all faces were tried.
    float_farkas : FloatFarkas or None
        Proves INFEASIBLE_TO_PRECISION up to rounding.
    program : Program or None
        The program behind the problem.
    """

    problem: MixedLCP
    outcome: Outcome
    message: str
    certificate: Certificate | None
    paths: tuple[Path, ...]
    best: int
    counts: Counts
    seconds: float
    _farkas: Farkas | None = None
    exhaustion: Exhaustion | None = None
    float_farkas: FloatFarkas | None = None
    program: Program | None = None

    @property
    def proof(self) -> str:
        """The proof of UNSOLVABLE, or that a solution exists beyond floats; else empty."""
        if self.outcome is Outcome.NOT_FOUND and self.exhaustion is not None and self.exhaustion.solvable:
            return _PROOFS["unrepresented"]
        if self.outcome is not Outcome.UNSOLVABLE:
            return ""
        grouped = self.exhaustion is not None and self.exhaustion.groups is not None
        kind = "farkas" if self._farkas is not None else "groups" if grouped else "exhaustion"
        return _PROOFS[kind]

    @property
    def farkas(self) -> Farkas | None:
        """The proof that no point is feasible, or None."""
        at_once = self.exhaustion is not None and self.exhaustion.groups is None and self.problem.standard
        if not at_once or self._farkas is not None or self.outcome is not Outcome.UNSOLVABLE:
            return self._farkas
        with np.errstate(all="ignore"):
            proof = infeasibility(self.problem)
        return proof if isinstance(proof, Farkas) else None

    def __repr__(self) -> str:
        found = "no point" if self.certificate is None else f"residual {self.residual:.1e}"
        return f"<Solution {self.outcome.name}: n = {self.problem.n}, {found}, {len(self.paths)} paths>"

    def _repr_html_(self) -> str:
        rows = [("message", self.message), ("residual", f"{self.residual:.2e}"), ("paths", len(self.paths))]
        page = table(f"Solution: {self.outcome.name}, n = {self.problem.n}", rows)
        for name, values in self.named.items():
            shown = ", ".join(f"{value:.6g}" for value in values[:TABLE_ROWS])
            page += table("", [(name, shown + (", ..." if len(values) > TABLE_ROWS else ""))])
        return page

    def __bool__(self) -> bool:
        return self.success

    @property
    def success(self) -> bool:
        """Whether the outcome is SOLVED or SOLVED_TO_PRECISION."""
        return self.outcome.success

    @property
    def solved(self) -> bool:
        """See `success`."""
        return self.success

    @property
    def x(self) -> Array | None:
        """The solution, else the best point found, shape (n,)."""
        return None if self.certificate is None else self.certificate.x

    @property
    def w(self) -> Array | None:
        """A x + q, shape (n,)."""
        return None if self.certificate is None else self.certificate.w

    @property
    def named(self) -> Mapping[str, Array]:
        """The unknowns by name: x, `equations`, `rows`, `bounds` of a `Program`, else x, w."""
        if self.x is None or self.w is None:
            return {}
        return {"x": self.x, "w": self.w} if self.program is None else self.program.named(self.x, self.w)

    @property
    def objective(self) -> float:
        """Program objective at x, or NaN."""
        if self.program is None or self.x is None:
            return math.nan
        return self.program.objective(self.x[: self.program.n])

    @property
    def residual(self) -> float:
        """The natural residual max_i |min(x_i, w_i)|; infinite without a point."""
        return math.inf if self.certificate is None else self.certificate.residual

    @property
    def relative_residual(self) -> float:
        """See `Certificate`."""
        return math.inf if self.certificate is None else self.certificate.relative_residual

    def plot(self, axes: Any = None) -> Any:
        """Draw the message, the path to x, its face and the residual.

        Parameters
        ----------
        axes : matplotlib Axes, optional
            Draw only the face into these.

        Returns
        -------
        matplotlib Figure, or Axes
        """
        from problems.lcp.picture import draw_face, draw_solution

        return draw_solution(self) if axes is None else draw_face(self, axes)

    def sensitivity(self) -> Sensitivity:
        """The derivative of x by A and q as products; one-sided at biactive indices.

        Raises
        ------
        NotDifferentiableError
            If there is no isolated solution.
        """
        if not self.solved or self.x is None:
            raise NotDifferentiableError(f"solution: expected one, found none. {self.outcome}")
        return sensitivity(self.problem, self.x)

    @property
    def path(self) -> Path:
        """The path to x, else the last one; without paths x alone."""
        if self.paths:
            return self.paths[self.best]
        x = self.x if self.x is not None else np.zeros(self.problem.n)
        u = np.append(x, 0.0)
        status = Status.REACHED_TARGET if self.solved else Status.ABANDONED
        alone = Step(0, u, np.zeros_like(u), 0.0, kind=Kind.TARGET)
        return Path([alone], status=status, message="No path was traced.")
