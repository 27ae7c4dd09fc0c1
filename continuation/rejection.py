"""Reasons why an attempt at a step failed."""

from __future__ import annotations

import math
from enum import Enum

from attrs import frozen


class Rejection(Enum):
    """Why an attempt failed."""

    NO_VALUE = "the homotopy has no finite value at a point that was tried"
    SINGULAR = "the bordered matrix has no factorisation at a point that was tried"
    UNSOLVABLE = "a linear system could not be solved"
    OVERFLOW = "the predicted point is not finite"
    NOT_CONTRACTING = "the corrector does not contract"
    NOT_CONVERGED = "the corrector did not converge"
    BACKWARDS = "the step went backwards"
    TOO_FAR = "the corrected point is farther from the prediction than that went"
    OUTSIDE = "the corrected point lies outside the domain"
    ELSEWHERE = "the end found is not where the path was heading"
    CONTROLLER = "the controller refuses it, as it does the shortest step where the Jacobian is wrong"
    ORIENTATION = "the determinant changes its sign on the arc, and no branch point is found there"
    CROSSINGS = "several branches cross on the arc"
    OTHER_BRANCH = "the arc crosses a branch and ends on it"
    AT_CROSSING = "the arc ends in a crossing, as far as can be told"
    UNACCOUNTED = "more eigenvalues change sides on the arc than is found there"
    GUARD = "a guard refuses the arc"
    MIDPOINT = "the inside of the arc is not on the path"
    ARC = "the inside of the arc could not be evaluated"

    @property
    def leaves_domain(self) -> bool:
        """Whether the homotopy cannot be evaluated."""
        return self in (Rejection.NO_VALUE, Rejection.OVERFLOW)


@frozen
class Rejected:
    """A failed attempt.

    Attributes
    ----------
    h : float
        Step length.
    reason : Rejection
    detail : str
    contraction : float
        Largest ratio of increments, or nan.
    factor : float
        Next step, relative to h.
    """

    h: float
    reason: Rejection
    detail: str = ""
    contraction: float = math.nan
    factor: float = 0.5

    def __str__(self) -> str:
        return f"{self.reason.value}: {self.detail}" if self.detail else self.reason.value
