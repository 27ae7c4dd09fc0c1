"""The controller protocol."""

from __future__ import annotations

import math
from typing import Any, Protocol, TypeAlias

from attrs import evolve, field, frozen
from attrs.validators import optional

from continuation.arguments.checks import POSITIVE, POSITIVE_FINITE, complain
from continuation.rejection import Rejection

State: TypeAlias = tuple[float, ...]


@frozen
class StepMeasures:
    """Measures of one attempted step.

    Attributes
    ----------
    h : float
        Step length.
    rejection : Rejection or None
        Why it failed early; else None, and the other measures are valid.
    iterations : int
        Corrector increments.
    contraction : float
        Largest ratio of successive increments.
    distance : float
        From the prediction to the corrected point.
    angle : float
        Between the tangents at both ends, radians.
    order : int
        Predictor's order p: distance is O(h^(p + 1)).
    rejections : int
        Earlier attempts at this step.
    """

    h: float
    order: int
    rejections: int
    iterations: int = 0
    contraction: float = math.inf
    distance: float = math.inf
    angle: float = 0.0
    rejection: Rejection | None = None

    @property
    def converged(self) -> bool:
        """Whether the measures are valid."""
        return self.rejection is None


@frozen
class Decision:
    """Acceptance, next step length, and new state."""

    accept: bool
    h: float
    state: State


@frozen
class Bounds:
    """Bounds and first value of the step length, in arclength.

    Attributes
    ----------
    minimum : float, default 1e-10
        The path ends below it.
    maximum : float, default inf
    initial : float or None, default None
        None: from the problem (`continuation.step.extent`) or the controller.
    """

    minimum: float = field(default=1e-10, validator=POSITIVE_FINITE)
    maximum: float = field(default=float("inf"), validator=POSITIVE)
    initial: float | None = field(default=None, validator=optional(POSITIVE))

    def __attrs_post_init__(self) -> None:
        if self.initial is not None and not self.minimum <= self.initial:
            raise ValueError(f"minimum: expected at most the initial step {self.initial:g}, found {self.minimum:g}")
        if self.initial is not None and self.initial > self.maximum:
            raise ValueError(f"initial: expected at most the maximum {self.maximum:g}, found {self.initial:g}")
        if not self.minimum <= self.maximum:
            raise ValueError(f"maximum: expected at least the minimum {self.minimum:g}, found {self.maximum:g}")

    def cap(self, h: float) -> float:
        """The step, at most the maximum.

        Parameters
        ----------
        h : float
        """
        return min(h, self.maximum)

    def beginning_with(self, usual: float) -> Bounds:
        """Bounds with a first step.

        Parameters
        ----------
        usual : float
            Used unless `initial` is given.
        """
        return self if self.initial is not None else evolve(self, initial=max(self.cap(usual), self.minimum))

    @property
    def longest(self) -> float:
        """First step, for controllers that return to it."""
        return self.maximum if self.initial is None else self.cap(self.initial)


def checked_bounds(value: Any) -> Bounds:
    """Check that bounds are `Bounds`."""
    if not isinstance(value, Bounds):
        raise complain(TypeError, "bounds", "Bounds(minimum, maximum, initial)", value)
    return value


class Controller(Protocol):
    """A rule for the step length."""

    @property
    def bounds(self) -> Bounds:
        """Minimum, maximum and first value."""
        ...

    def init(self) -> State:
        """The state before the first step."""
        ...

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Judge an attempt, by state and measures only.

        Parameters
        ----------
        state : tuple of float
        attempt : StepMeasures
        """
        ...
