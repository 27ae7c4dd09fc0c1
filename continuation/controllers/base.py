"""What a step controller is: frozen settings, and a state that is a tuple of floats, so that it can be archived."""

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
    """What a controller learns of one attempt.

    Attributes
    ----------
    h : float
        Its step length, in arclength of the metric.
    rejection : Rejection or None
        Why it failed before it could be measured; None where the corrector converged inside the domain. The measures
        below are meaningful only then.
    iterations : int
        The corrector's increments.
    contraction : float
        Worst ratio of successive increments.
    distance : float
        Length of the correction.
    angle : float
        Between the tangents, radians.
    order : int
        The predictor's order p: the distance behaves like h^(p + 1).
    rejections : int
        Attempts at this step before this one.
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
        """Whether the other measures are to be judged."""
        return self.rejection is None


@frozen
class Decision:
    """Whether the attempt is accepted, the next step length to try, and the controller's new state."""

    accept: bool
    h: float
    state: State


@frozen
class Bounds:
    """Floor, ceiling and first value of the step length, in arclength of the metric.

    Attributes
    ----------
    minimum : float, default 1e-10
        A path whose step falls below it ends.
    maximum : float, default inf
        No step is longer, the first one included.
    initial : float or None, default None
        The first step. None is chosen from the problem (`continuation.step.extent`), or by a controller that has a
        usual step of its own.
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
        """The step kept below the ceiling; the floor is the tracer's to check.

        Parameters
        ----------
        h : float

        Returns
        -------
        float
        """
        return min(h, self.maximum)

    def beginning_with(self, usual: float) -> Bounds:
        """The same bounds, with a first step where they do not say one.

        Parameters
        ----------
        usual : float
            That of the controller.
        """
        return self if self.initial is not None else evolve(self, initial=max(self.cap(usual), self.minimum))

    @property
    def longest(self) -> float:
        """The first value, for a controller that goes back to it after every step."""
        return self.maximum if self.initial is None else self.cap(self.initial)


def checked_bounds(value: Any) -> Bounds:
    """The bounds of a step; TypeError for anything else."""
    if not isinstance(value, Bounds):
        raise complain(TypeError, "bounds", "Bounds(minimum, maximum, initial)", value)
    return value


class Controller(Protocol):
    """A rule for the step length."""

    @property
    def bounds(self) -> Bounds:
        """Floor, ceiling and first value."""
        ...

    def init(self) -> State:
        """The state before the first step."""
        ...

    def update(self, state: State, attempt: StepMeasures) -> Decision:
        """Judge an attempt; pure, so that a resumed run decides alike.

        Parameters
        ----------
        state : tuple of float
            What `init`, or the decision before this one, gave.
        attempt : StepMeasures

        Returns
        -------
        Decision
        """
        ...
