"""The step controllers."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from attrs import field, frozen

from continuation.arguments.checks import FACTOR, FRACTION, POSITIVE, integer
from continuation.citation.bibliography import ALLGOWER_GEORG, DEN_HEIJER_RHEINBOLDT
from continuation.controllers.base import Bounds, Decision, State, StepMeasures, checked_bounds

LEAST_SHRINK = 1.2
"""Least shrink factor of a rejected step, where asymptotics do not hold yet."""

STRAIGHT, LEAST_CURVATURE, LEAST_CONTRACTION = 0.01, 1e-3, 1e-3
"""Lower bounds in PITCON's formula against division by zero: turn in radians, relative curvature, contraction."""


def _of_fixed(bounds: Any) -> Bounds:
    return checked_bounds(bounds).beginning_with(0.1)


def _of_geometric(bounds: Any) -> Bounds:
    return checked_bounds(bounds).beginning_with(1.0)


def _of_series(bounds: Any) -> Bounds:
    return checked_bounds(bounds).beginning_with(math.inf)


@frozen
class Fixed:
    """A constant step, `bounds.initial` (0.1); failures halve it once."""

    bounds: Bounds = field(factory=Bounds, converter=_of_fixed)
    max_angle: float = field(default=0.8, validator=POSITIVE)

    def init(self) -> State:
        """Return no state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Accept if converged within the angle."""
        if attempt.converged and attempt.angle <= self.max_angle:
            return Decision(True, self.bounds.longest, state)
        return Decision(False, attempt.h / 2.0, state)


@frozen
class Geometric:
    """Backtracking of Dutta, Das and Jana (Steps 2 and 3): the step is ratio^l, with l = 0 first at every point.

    `bounds.initial` is the longest step (1). It accepts any angle and may jump between paths: for comparison only.
    """

    ratio: float = field(default=0.5, validator=FRACTION)
    bounds: Bounds = field(factory=lambda: Bounds(minimum=1e-6), converter=_of_geometric)

    def init(self) -> State:
        """Return no state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Longest step after success, else times the ratio."""
        if attempt.converged:
            return Decision(True, self.bounds.longest, state)
        return Decision(False, attempt.h * self.ratio, state)


@frozen
class IterationCount:
    """Grows the step if the corrector needs fewer than `target` increments, else shrinks it."""

    target: int = field(default=3, validator=integer(1))
    grow: float = field(default=2.0, validator=FACTOR)
    shrink: float = field(default=0.5, validator=FRACTION)
    max_angle: float = field(default=0.4, validator=POSITIVE)
    bounds: Bounds = field(factory=Bounds, converter=checked_bounds)

    def init(self) -> State:
        """Return no state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Accept if converged within the angle; scale by grow^((target - iterations) / target)."""
        if not attempt.converged or attempt.angle > self.max_angle:
            return Decision(False, attempt.h * self.shrink, state)
        factor = self.grow ** ((self.target - attempt.iterations) / self.target)
        return Decision(True, self.bounds.cap(attempt.h * max(factor, self.shrink)), state)


@frozen
class AllgowerGeorg:
    """Asymptotic expansions of contraction, distance and angle in h (Allgower and Georg, Algorithm 6.1.10).

    Contraction and distance behave like h^(p + 1) for predictor order p, the angle like h; the worst measure over its
    goal scales the step.

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
        """Return no state."""
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
        # Measures, not roots: at high order a root accepts corrections of half a step, and paths jump.
        if max(contraction, distance, angle) > self.deceleration:
            return Decision(False, attempt.h / min(max(factor, LEAST_SHRINK), 2.0 * self.deceleration), state)
        limited = max(factor, 1.0 / self.acceleration)
        # The cause of a rejection is near.
        grown = attempt.h / (max(limited, 1.0) if attempt.rejections else limited)
        return Decision(True, self.bounds.cap(grown), state)


@frozen
class Curvature:
    """Steps from predicted curvature, as in PITCON (den Heijer and Rheinboldt 1981).

    The curvature |2 sin(angle / 2)| / h is extrapolated; h = sqrt(2 distance / curvature) gives Euler's error the ideal
    distance, which the contraction adapts. State: last curvature, last length, ideal distance.
    """

    references: ClassVar[tuple[str, ...]] = (DEN_HEIJER_RHEINBOLDT,)
    contraction: float = field(default=0.1, validator=FRACTION)
    initial_distance: float = field(default=1e-2, validator=POSITIVE)
    max_angle: float = field(default=0.4, validator=POSITIVE)
    growth: float = field(default=3.0, validator=FACTOR)
    bounds: Bounds = field(factory=Bounds, converter=checked_bounds)

    def _step(self, liked: float, curvature: float) -> float:
        # PITCON's limit on the turn.
        return min(math.sqrt(2.0 * liked / curvature), self.max_angle / curvature)

    def init(self) -> State:
        """Return a state without curvature."""
        return (-1.0, 0.0, self.initial_distance)

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Judge by angle; choose by curvature."""
        before, length, liked = state
        if not attempt.converged or attempt.angle > self.max_angle:
            return Decision(False, attempt.h / 2.0, state)
        curvature = 2.0 * math.sin(attempt.angle / 2.0) / attempt.h
        ahead = curvature
        if before >= 0.0:
            ahead = curvature + attempt.h / (attempt.h + length) * (curvature - before)
        ahead = max(ahead, STRAIGHT / attempt.h, LEAST_CURVATURE * curvature)
        quality = math.sqrt(self.contraction / max(attempt.contraction, LEAST_CONTRACTION))
        liked = liked * min(max(quality, 0.5), 2.0)
        wanted = min(self._step(liked, ahead), self.growth * attempt.h)
        wanted = max(wanted, attempt.h / self.growth)
        if attempt.rejections:
            wanted = min(wanted, attempt.h)
        return Decision(True, self.bounds.cap(wanted), (curvature, attempt.h, liked))


@frozen
class SeriesRange:
    """The whole range of a series predictor; a failure halves it once.

    The range has its own error bound, so only long corrections are refused.
    """

    distance: float = field(default=1e-3, validator=POSITIVE)
    max_angle: float = field(default=1.4, validator=POSITIVE)
    bounds: Bounds = field(factory=Bounds, converter=_of_series)

    def init(self) -> State:
        """Return no state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Accept small corrections; ask for the whole range."""
        near = attempt.distance <= self.distance * attempt.h and attempt.angle <= self.max_angle
        if attempt.converged and near:
            return Decision(True, self.bounds.cap(math.inf), state)
        return Decision(False, attempt.h / 2.0, state)
