"""What is varied along one line of a chart: tolerances, longest steps, orders; each value is a rung."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import inf
from typing import Any

from attrs import evolve, field, frozen

from continuation.predictors import Taylor
from continuation.step.presets import DEFAULT

Options = dict[str, Any]
"""Arguments of `continuation.trace`."""


def _values(values: Iterable[float]) -> tuple[float, ...]:
    try:
        found = tuple(float(value) for value in values)
    except (TypeError, ValueError):
        found = ()
    if not found or not all(0.0 < value < inf for value in found):
        raise ValueError(f"values: expected positive numbers, at least one, found {values}")
    return found


@frozen
class Ladder:
    """The values of one setting, and how a value enters the options of a trace.

    Attributes
    ----------
    name : str
        What is varied, as axes and tables call it.
    values : tuple of float
        Positive.
    change : callable
        (options, value) to new options.
    """

    name: str
    values: tuple[float, ...] = field(converter=_values)
    change: Callable[[Options, float], Options]

    @property
    def rungs(self) -> tuple[Rung, ...]:
        """The values one by one."""
        return tuple(Rung(self, value) for value in self.values)


@frozen
class Rung:
    """One value of a ladder."""

    ladder: Ladder
    value: float

    def apply(self, options: Mapping[str, Any]) -> Options:
        """The options of a trace with this value set.

        Parameters
        ----------
        options : mapping
            For `continuation.trace`.

        Returns
        -------
        dict
            New options.
        """
        return self.ladder.change(dict(options), self.value)


def tolerances(*values: float) -> Ladder:
    """The tolerance of the trace.

    Parameters
    ----------
    *values : float
        Positive.
    """
    return Ladder("tolerance", values, lambda options, value: {**options, "tolerance": value})


def longest_steps(*values: float) -> Ladder:
    """The longest step that the controller may take, in arclength of the metric; the first step is no longer.

    Parameters
    ----------
    *values : float
        Positive.
    """
    return Ladder("longest step", values, _limited)


def orders(*values: int) -> Ladder:
    """The order of the Taylor predictor of the options (or preset), which must have one.

    Parameters
    ----------
    *values : int
        Positive.
    """
    return Ladder("order", values, _of_order)


def _limited(options: Options, value: float) -> Options:
    controller = options.get("controller") or options.get("preset", DEFAULT).controller
    bounds = controller.bounds
    # A first step that the controller leaves open, or one that is shorter, stays.
    first = bounds.initial if bounds.initial is None else min(bounds.initial, value)
    limited = evolve(bounds, maximum=value, minimum=min(bounds.minimum, value), initial=first)
    return {**options, "controller": evolve(controller, bounds=limited)}


def _of_order(options: Options, value: float) -> Options:
    predictor = options.get("predictor") or options.get("preset", DEFAULT).predictor
    if not isinstance(predictor, Taylor):
        raise TypeError(f"predictor: expected a Taylor predictor for a ladder of orders, found {predictor!r}")
    return {**options, "predictor": evolve(predictor, order=int(value))}
