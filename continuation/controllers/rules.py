"""The step controllers."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from attrs import field, frozen

from continuation.arguments.checks import FACTOR, FRACTION, POSITIVE, integer
from continuation.citation.bibliography import ALLGOWER_GEORG, DEN_HEIJER_RHEINBOLDT
from continuation.controllers.base import Bounds, Decision, State, StepMeasures, checked_bounds

LEAST_SHRINK = 1.2
"""A rejected step becomes shorter by this factor at least: else asymptotics that do not hold yet repeat it."""

STRAIGHT, LEAST_CURVATURE, LEAST_CONTRACTION = 0.01, 1e-3, 1e-3
"""What keeps PITCON's formula from dividing by zero: the next step's turn in radians and its curvature, relative to
the last one's, are taken for this at least; a corrector that contracts better tells nothing more."""


def _of_fixed(bounds: Any) -> Bounds:
    return checked_bounds(bounds).beginning_with(0.1)


def _of_geometric(bounds: Any) -> Bounds:
    """The paper's step: ratio^0."""
    return checked_bounds(bounds).beginning_with(1.0)


def _of_series(bounds: Any) -> Bounds:
    """The whole range of the series."""
    return checked_bounds(bounds).beginning_with(math.inf)


@frozen
class Fixed:
    """The same step always, `bounds.initial` (0.1); halved within a step that fails, and restored after it."""

    bounds: Bounds = field(factory=Bounds, converter=_of_fixed)
    max_angle: float = field(default=0.8, validator=POSITIVE)

    def init(self) -> State:
        """No state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Accept whatever converged within the angle."""
        if attempt.converged and attempt.angle <= self.max_angle:
            return Decision(True, self.bounds.longest, state)
        return Decision(False, attempt.h / 2.0, state)


@frozen
class Geometric:
    """The backtracking of Dutta, Das and Jana (Steps 2 and 3): the step is ratio^l, and l starts at 0 at every point.

    `bounds.initial` is the longest step (1, as in the paper). It accepts whatever the corrector does, however far the
    tangent turned, so it can jump between paths: here to be compared with, not to be used.
    """

    ratio: float = field(default=0.5, validator=FRACTION)
    bounds: Bounds = field(factory=lambda: Bounds(minimum=1e-6), converter=_of_geometric)

    def init(self) -> State:
        """No state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Back to the longest step after success, one power of the ratio down after failure."""
        if attempt.converged:
            return Decision(True, self.bounds.longest, state)
        return Decision(False, attempt.h * self.ratio, state)


@frozen
class IterationCount:
    """The step grows when the corrector needs fewer increments than `target`, and shrinks when it needs more."""

    target: int = field(default=3, validator=integer(1))
    grow: float = field(default=2.0, validator=FACTOR)
    shrink: float = field(default=0.5, validator=FRACTION)
    max_angle: float = field(default=0.4, validator=POSITIVE)
    bounds: Bounds = field(factory=Bounds, converter=checked_bounds)

    def init(self) -> State:
        """No state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Accept what converged within the angle; scale by grow^((target - iterations) / target)."""
        if not attempt.converged or attempt.angle > self.max_angle:
            return Decision(False, attempt.h * self.shrink, state)
        factor = self.grow ** ((self.target - attempt.iterations) / self.target)
        return Decision(True, self.bounds.cap(attempt.h * max(factor, self.shrink)), state)


@frozen
class AllgowerGeorg:
    """Asymptotic expansions of contraction, distance and angle in h (Allgower and Georg, Algorithm 6.1.10).

    For a predictor of order p the contraction and the distance behave like h^(p + 1) and the angle like h, so each
    measure over its goal says by which factor the step was too long; the worst decides. An attempt with a measure
    beyond `deceleration` times its goal is rejected.

    Parameters
    ----------
    contraction, distance, angle : float
        The goals; distance is relative to the step length, the angle is in radians.
    deceleration, acceleration : float
        How far beyond a goal is still accepted; how fast the step may grow.
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
        # Judged by the measures themselves, not by their roots: for a predictor of high order a root forgives a
        # correction half as long as the step, and that is how paths are jumped.
        if max(contraction, distance, angle) > self.deceleration:
            return Decision(False, attempt.h / min(max(factor, LEAST_SHRINK), 2.0 * self.deceleration), state)
        limited = max(factor, 1.0 / self.acceleration)
        # Right after a rejection the step must not grow: the reason for it lies just ahead.
        grown = attempt.h / (max(limited, 1.0) if attempt.rejections else limited)
        return Decision(True, self.bounds.cap(grown), state)


@frozen
class Curvature:
    """Steps from the predicted curvature and the corrector's quality, as in PITCON (den Heijer and Rheinboldt 1981).

    The curvature over the last step is |2 sin(angle / 2)| / h; the next step's is extrapolated linearly, and the step
    chosen so that Euler's predictor would err by the distance the corrector is known to like, h = sqrt(2 distance /
    curvature). That distance is adapted by the corrector's contraction.

    State: the curvature of the step before, its length, and the liked distance.
    """

    references: ClassVar[tuple[str, ...]] = (DEN_HEIJER_RHEINBOLDT,)
    contraction: float = field(default=0.1, validator=FRACTION)
    initial_distance: float = field(default=1e-2, validator=POSITIVE)
    max_angle: float = field(default=0.4, validator=POSITIVE)
    growth: float = field(default=3.0, validator=FACTOR)
    bounds: Bounds = field(factory=Bounds, converter=checked_bounds)

    def _step(self, liked: float, curvature: float) -> float:
        # PITCON's own limit: a step that would turn the tangent by more than the accepted angle is never tried.
        return min(math.sqrt(2.0 * liked / curvature), self.max_angle / curvature)

    def init(self) -> State:
        """No curvature known."""
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
    """The whole range of a series predictor at every step; a failed attempt halves it for that step alone.

    The range carries its own error bound, so what is watched is the corrector: a correction longer than `distance`
    times the step means that the series and the path have parted.
    """

    distance: float = field(default=1e-3, validator=POSITIVE)
    max_angle: float = field(default=1.4, validator=POSITIVE)
    bounds: Bounds = field(factory=Bounds, converter=_of_series)

    def init(self) -> State:
        """No state."""
        return ()

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Accept small corrections; ask for the whole range again."""
        near = attempt.distance <= self.distance * attempt.h and attempt.angle <= self.max_angle
        if attempt.converged and near:
            return Decision(True, self.bounds.cap(math.inf), state)
        return Decision(False, attempt.h / 2.0, state)
