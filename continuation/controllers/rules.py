"""The step controllers."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from attrs import field, frozen

from continuation.arguments.checks import FACTOR, FRACTION, POSITIVE
from continuation.citation.bibliography import ALLGOWER_GEORG
from continuation.controllers.base import Bounds, Decision, State, StepMeasures, checked_bounds

LEAST_SHRINK = 1.2
"""Least shrink factor of a rejected step: with `deceleration` FAST takes 12 % more residuals on Freudenstein and Roth's
path."""


def _of_fixed(bounds: Any) -> Bounds:
    return checked_bounds(bounds).beginning_with(0.1)


def _of_series(bounds: Any) -> Bounds:
    return checked_bounds(bounds).beginning_with(math.inf)


@frozen
class Fixed:
    """A constant step, `bounds.initial` (0.1); each failure multiplies only the current step by `ratio`.

    With ``max_angle=inf`` it is the backtracking of Dutta, Das and Jana (Steps 2 and 3), which may jump between paths.
    """

    bounds: Bounds = field(factory=Bounds, converter=_of_fixed)
    max_angle: float = field(default=0.8, validator=POSITIVE)
    ratio: float = field(default=0.5, validator=FRACTION)

    def init(self) -> State:
        """No state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Accept if converged within the angle."""
        if attempt.converged and attempt.angle <= self.max_angle:
            return Decision(True, self.bounds.longest, state)
        return Decision(False, attempt.h * self.ratio, state)


@frozen
class AllgowerGeorg:
    """Asymptotic expansions of contraction, distance and angle in h (Allgower and Georg, Algorithm 6.1.10).

    Contraction and distance are like h^(p + 1), the angle like h; the worst of them scales the step.

    Parameters
    ----------
    contraction, distance, angle : float
        Goals; distance relative to the step, angle in radians.
    deceleration, acceleration : float
        Accepted excess over a goal; largest growth.
    bounds : Bounds
    """

    references: ClassVar[tuple[str, ...]] = (ALLGOWER_GEORG,)
    contraction: float = field(default=0.3, validator=POSITIVE)
    distance: float = field(default=0.1, validator=POSITIVE)
    angle: float = field(default=0.3, validator=POSITIVE)
    deceleration: float = field(default=1.5, validator=FACTOR)
    acceleration: float = field(default=2.0, validator=FACTOR)
    bounds: Bounds = field(factory=Bounds, converter=checked_bounds)

    def init(self) -> State:
        """No state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Divide the step by the worst factor."""
        if not attempt.converged:
            return Decision(False, attempt.h / 2.0, state)
        root = 1.0 / (attempt.order + 1)
        contraction = attempt.contraction / self.contraction
        distance = attempt.distance / (self.distance * attempt.h)
        angle = attempt.angle / self.angle
        factor = max(contraction**root, distance**root, angle)
        # Roots would accept corrections of half a step at high order: paths jump.
        if max(contraction, distance, angle) > self.deceleration:
            return Decision(False, attempt.h / min(max(factor, LEAST_SHRINK), 2.0 * self.deceleration), state)
        limited = max(factor, 1.0 / self.acceleration)
        # The cause of a rejection is near.
        grown = attempt.h / (max(limited, 1.0) if attempt.rejections else limited)
        return Decision(True, self.bounds.cap(grown), state)


@frozen
class SeriesRange:
    """A step as long as the series' error bound allows; a failure halves it for that step alone."""

    distance: float = field(default=1e-3, validator=POSITIVE)
    max_angle: float = field(default=1.4, validator=POSITIVE)
    bounds: Bounds = field(factory=Bounds, converter=_of_series)

    def init(self) -> State:
        """No state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Accept small corrections; ask for the whole range."""
        near = attempt.distance <= self.distance * attempt.h and attempt.angle <= self.max_angle
        if attempt.converged and near:
            return Decision(True, self.bounds.cap(math.inf), state)
        return Decision(False, attempt.h / 2.0, state)
