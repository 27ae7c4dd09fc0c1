"""Settings of a path."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from attrs import evolve, frozen, has

from continuation.arguments.checks import complain, instance_with
from continuation.arguments.labels import Labels
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.controllers import Bounds, Controller
from continuation.correctors import Corrector
from continuation.evaluation.evaluator import Evaluator
from continuation.events import Event, KinkPoint, TargetValue, TurningPoint
from continuation.events.box import faces
from continuation.events.branch_point import BranchPoint
from continuation.homotopy import SupportsBlocks, SupportsBound, SupportsEvents, SupportsMetric, SupportsPieces, offers
from continuation.metric import Automatic, Metric
from continuation.predictors import Predictor
from continuation.step.guard import Guard
from continuation.step.options import EVENT, PARTS, Options, checked_target, each, names_homotopy
from continuation.tolerance import Tolerance, as_tolerance


@frozen(eq=False)
class Settings:
    """Everything that decides a path, except homotopy and start.

    `events`: the homotopy's and the caller's, turning points, branch points. `examine`: whether to watch the latter
    two.
    """

    predictor: Predictor
    corrector: Corrector
    controller: Controller
    metric: Metric
    events: tuple[Event, ...]
    guards: tuple[Guard, ...]
    tolerance: Tolerance
    budget: Budget
    target: float | None
    direction: int
    examine: bool

    def index_of(self, kind: type) -> int | None:
        """Index of the first event of a kind, or None."""
        return next((i for i, event in enumerate(self.events) if isinstance(event, kind)), None)

    @property
    def stops(self) -> list[tuple[int, float]]:
        """Pairs (component, value) at which the path ends."""
        ends = [event for event in self.events if isinstance(event, TargetValue) and event.terminal > 0]
        return [*([] if self.target is None else [(-1, self.target)]), *((e.component, e.value) for e in ends)]

    def room(self, u: Array, v: Array) -> float:
        """Distance along v to the nearest terminal value of a path without target, or inf; u, v: shape (N + 1,)."""
        if self.target is not None:
            return math.inf
        ends = [event for event in self.events if isinstance(event, TargetValue) and event.terminal == 1]
        known = ((event.value - u[event.component], v[event.component]) for event in ends)
        return float(min((gap / slope for gap, slope in known if gap * slope > 0.0), default=math.inf))

    def bound(self, evaluator: Evaluator) -> Settings:
        """Bind events that need the evaluator; archives keep unbound ones."""
        known = (event.bound(evaluator) if isinstance(event, SupportsBound) else event for event in self.events)
        return evolve(self, events=tuple(known))


def complete_settings(
    homotopy: Any, asked: Options, start: Callable[[], Array], observers: Sequence[Any] = ()
) -> Settings:
    """Complete checked options from the homotopy.

    `start`: returns (y, lam). `observers`: their `events` are watched. `TypeError, ValueError` for wrong metric, events
    or target.
    """
    preset, target = asked["preset"], asked["target"]
    own = homotopy.metric if offers(homotopy, SupportsMetric) else None
    if own is not None:
        instance_with("metric", own, *PARTS["metric"])
    return Settings(
        predictor=_first(asked["predictor"], preset.predictor),
        corrector=_first(asked["corrector"], preset.corrector),
        controller=_capped(_first(asked["controller"], preset.controller), asked["max_step"]),
        metric=_first(asked["metric"], own, Automatic(blocks=_blocks(homotopy, start))),
        events=(*_events(homotopy, asked, observers), *_box(homotopy, asked, start)),
        guards=tuple(asked["guards"]),
        tolerance=as_tolerance(asked["tolerance"]),
        budget=_first(asked["budget"], Budget()),
        target=checked_target(getattr(homotopy, "target", 0.0) if names_homotopy(target) else target),
        direction=asked["direction"],
        examine=bool(asked["examine"]),
    )


def _blocks(homotopy: Any, start: Callable[[], Array]) -> Any:
    if not offers(homotopy, SupportsBlocks):
        return None
    blocks = np.asarray(homotopy.blocks)
    if blocks.dtype.kind not in "iu" or blocks.shape != (start().size - 1,) or blocks.min() < 0:
        raise complain(ValueError, "blocks", "a label 0, 1, ... for each unknown", homotopy.blocks)
    return blocks


def _capped(controller: Any, longest: float | None) -> Any:
    if longest is None or longest >= controller.bounds.maximum:
        return controller
    bounds: Bounds = controller.bounds
    if longest < bounds.minimum or not has(type(controller)):
        expected = f"at least the least step, {bounds.minimum:g}, and a controller of the library"
        raise complain(ValueError, "max_step", expected, longest)
    first = None if bounds.initial is None else min(bounds.initial, float(longest))
    return evolve(controller, bounds=evolve(bounds, maximum=float(longest), initial=first))


def _box(homotopy: Any, asked: Options, start: Callable[[], Array]) -> tuple[Event, ...]:
    box: Any = asked["box"]
    if names_homotopy(box):
        # A target or events of the caller replace the homotopy's box.
        said = asked["events"] or not names_homotopy(asked["target"])
        box = None if said else getattr(homotopy, "box", None)
    return () if box is None else faces(box, Labels.of(homotopy), start())


def _first(*candidates: Any) -> Any:
    return next(candidate for candidate in candidates if candidate is not None)


def _events(homotopy: Any, asked: Options, observers: Sequence[Any]) -> tuple[Event, ...]:
    own = homotopy.events if offers(homotopy, SupportsEvents) else ()
    each("events", own, EVENT)
    watched: tuple[Event, ...] = (*own, *asked["events"])
    watched += tuple(e for part in observers for e in getattr(part, "events", ()) if e not in watched)
    if offers(homotopy, SupportsPieces) and not any(isinstance(event, KinkPoint) for event in watched):
        watched = (*watched, KinkPoint(terminal=0))
    if not asked["examine"]:
        return watched
    if not any(isinstance(event, TurningPoint) and event.component == -1 for event in watched):
        watched = (TurningPoint(), *watched)
    if not any(isinstance(event, BranchPoint) for event in watched):
        watched = (*watched, BranchPoint(terminal=0))
    return watched
