"""The door of a trace: what was asked for, checked and completed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from attrs import frozen

from continuation.budget import Budget
from continuation.controllers import Controller
from continuation.correctors import Corrector
from continuation.events import Event, TurningPoint
from continuation.events.branch_point import BranchPoint
from continuation.homotopy import SupportsEvents, SupportsMetric
from continuation.metric import Automatic, Metric
from continuation.predictors import Predictor
from continuation.presets import Preset
from continuation.tolerance import Tolerance, as_tolerance


class Part(NamedTuple):
    """What an argument must offer to be taken for one."""

    attributes: tuple[str, ...]
    kind: str


PARTS = {
    "predictor": Part(("prepare", "memory", "order"), "a predictor"),
    "corrector": Part(("correct",), "a corrector"),
    "controller": Part(("init", "update", "bounds"), "a step controller"),
    "metric": Part(("weights",), "a metric"),
}


@frozen(eq=False)
class Settings:
    """Everything that decides how a path is traced, except the homotopy and the start.

    Attributes
    ----------
    predictor, corrector, controller, metric
        The parts.
    events : tuple of Event
        The homotopy's own and the caller's, with turning points of the parameter and branch points added where
        nobody asks for them.
    tolerance : Tolerance
    budget : Budget
    target : float or None
    direction : int
    examine : bool
        Whether turning points, branch points and singular ends are looked for.
    """

    predictor: Predictor
    corrector: Corrector
    controller: Controller
    metric: Metric
    events: tuple[Event, ...]
    tolerance: Tolerance
    budget: Budget
    target: float | None
    direction: int
    examine: bool

    @property
    def branch_index(self) -> int | None:
        """Which of the events stands for branch points; None where they are not watched for."""
        return next((i for i, event in enumerate(self.events) if isinstance(event, BranchPoint)), None)


def complete_settings(
    homotopy: Any,
    preset: Preset,
    predictor: Predictor | None,
    corrector: Corrector | None,
    controller: Controller | None,
    metric: Metric | None,
    events: Sequence[Event],
    tolerance: float | Tolerance,
    budget: Budget | None,
    target: float | str | None,
    direction: int,
    examine: bool,
) -> Settings:
    """Complete the arguments of a trace.

    Raises
    ------
    TypeError, ValueError
        Naming the argument, what was found and what was expected.
    """
    if not isinstance(preset, Preset):
        raise TypeError(f"preset: expected FAST, DEFAULT, CONSERVATIVE, SERIES or another Preset, found {preset!r}")
    if direction not in (-1, 0, 1):
        raise ValueError(f"direction: expected -1, 0 or 1, found {direction!r}")
    if budget is not None and not isinstance(budget, Budget):
        raise TypeError(f"budget: expected a Budget, found {budget!r}")
    own = homotopy.metric if isinstance(homotopy, SupportsMetric) else None
    given: dict[str, Any] = {
        "predictor": predictor if predictor is not None else preset.predictor,
        "corrector": corrector if corrector is not None else preset.corrector,
        "controller": controller if controller is not None else preset.controller,
        "metric": metric if metric is not None else own if own is not None else Automatic(),
    }
    for name, value in given.items():
        missing = [attribute for attribute in PARTS[name].attributes if not hasattr(value, attribute)]
        if missing:
            raise TypeError(f"{name}: expected {PARTS[name].kind}, found {value!r}, which has no `{missing[0]}`")
    return Settings(
        **given,
        events=_events(homotopy, events, examine),
        tolerance=as_tolerance(tolerance),
        budget=budget if budget is not None else Budget(),
        target=_target(homotopy, target),
        direction=direction,
        examine=bool(examine),
    )


def _events(homotopy: Any, events: Sequence[Event], examine: bool) -> tuple[Event, ...]:
    if not isinstance(events, Sequence):
        raise TypeError(f"events: expected a list of events, found {events!r}")
    own = tuple(homotopy.events) if isinstance(homotopy, SupportsEvents) else ()
    watched: tuple[Event, ...] = (*own, *events)
    for event in watched:
        if not hasattr(event, "monitor"):
            raise TypeError(f"events: expected events, found {event!r}; wrap a function in Monitor(function)")
    if not examine:
        return watched
    if not any(isinstance(event, TurningPoint) and event.component == -1 for event in watched):
        watched = (TurningPoint(), *watched)
    if not any(isinstance(event, BranchPoint) for event in watched):
        watched = (*watched, BranchPoint(terminal=0))
    return watched


def _target(homotopy: Any, target: float | str | None) -> float | None:
    """The caller's target, else the homotopy's, else 0."""
    if isinstance(target, str):
        if target != "homotopy":
            raise ValueError(f"target: expected a number or None, found {target!r}")
        target = getattr(homotopy, "target", 0.0)
    if target is None:
        return None
    if not math.isfinite(float(target)):
        raise ValueError(f"target: expected a finite number or None, found {target!r}")
    return float(target)
