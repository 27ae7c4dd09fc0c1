"""The options of a path."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, NamedTuple, TypedDict, TypeVar

from continuation.arguments.checks import check_flag, check_sign, complain, instance_with, is_number
from continuation.arrays import Array
from continuation.budget import Budget
from continuation.controllers import Controller
from continuation.correctors import Corrector
from continuation.events import Event
from continuation.events.box import Box
from continuation.metric import Metric
from continuation.path import Path
from continuation.predictors import Predictor
from continuation.step.guard import Guard
from continuation.step.presets import DEFAULT, Preset
from continuation.step.start import arriving, guessed, is_guess, point_and_direction
from continuation.step.state import State
from continuation.tolerance import Tolerance, as_tolerance

Finish = Callable[[Array, float], Array | None]


class PartOptions(TypedDict, total=False):
    """How to trace a path.

    Parameters
    ----------
    preset : Preset, default DEFAULT
        `FAST`, `DEFAULT`, `CONSERVATIVE`, `SERIES` or another choice of the next three parts.
    predictor : Predictor, default None
        Replaces the preset's, like the next two.
    corrector : Corrector, default None
    controller : Controller, default None
    metric : Metric, default None
        For arclength. Default: the homotopy's, else `Automatic`.
    events : sequence of Event, default ()
        Added to the homotopy's, turning points and branch points.
    guards : sequence of Guard, default ()
        Functions that return a reason to reject an arc, or None; the step is then shortened. Not archived.
    check_jacobian : bool, default False
        Compare Jacobian and residual at the start; a wrong entry is a ValueError.
    examine : bool, default True
        Watch turning points and branch points. False saves a third of the cost; steps over branch points are refused.
    """

    preset: Preset
    predictor: Predictor | None
    corrector: Corrector | None
    controller: Controller | None
    metric: Metric | None
    events: Sequence[Event]
    guards: Sequence[Guard]
    check_jacobian: bool
    examine: bool


class Options(PartOptions, total=False):
    """All options of a path.

    Parameters
    ----------
    tolerance : float or Tolerance, default 1e-8
        Largest correction; a number is its relative part.
    budget : Budget, default Budget()
        Limits of steps, factorisations and seconds; default 10,000 steps.
    target : float or None, default "homotopy"
        Final parameter value; None for none. Default: the homotopy's, else 0.
    direction : int, default 0
        Sign of the parameter's first change; 0: towards the target.
    start : tuple of (u, v) or (y, lam), or Path, default None
        Replaces the homotopy's start: point ``(y, lam)`` and direction; a guess of y at a parameter value; or a path to
        continue.
    finish : callable, default None
        Called with ``(y, lam)`` after each step; gives y at the target, or None; replaces the homotopy's. Not archived.
    max_step : float, default None
        Largest step in arclength: bends narrower than half of it may be missed (docs/guarantee.md).
    box : mapping or None, default "homotopy"
        The path ends outside the box: ``"lam"``, the number or name of an unknown, or ``"y"`` for all, to (low, high),
        None for open. Default: the homotopy's.
    """

    tolerance: float | Tolerance
    budget: Budget | None
    target: float | str | None
    direction: int
    start: tuple[Array, Array | float] | Path | None
    finish: Finish | None
    max_step: float | None
    box: Box | str | None


DEFAULTS: Options = {
    "preset": DEFAULT,
    "predictor": None,
    "corrector": None,
    "controller": None,
    "metric": None,
    "events": (),
    "guards": (),
    "check_jacobian": False,
    "examine": True,
    "tolerance": 1e-8,
    "budget": Budget(),
    "target": "homotopy",
    "direction": 0,
    "start": None,
    "finish": None,
    "max_step": None,
    "box": "homotopy",
}

OPTIONS = tuple(Options.__annotations__)
PART_OPTIONS = tuple(PartOptions.__annotations__)


class Part(NamedTuple):
    """Attributes that an argument must have, and its name in messages."""

    attributes: tuple[str, ...]
    kind: str


PARTS = {
    "predictor": Part(("prepare", "memory", "order"), "a predictor"),
    "corrector": Part(("correct",), "a corrector"),
    "controller": Part(("init", "update", "bounds"), "a step controller"),
    "metric": Part(("weights",), "a metric"),
}

OBSERVER = Part(("step", "event", "end"), "an observer")
GUARD = Part(("__call__",), "guards: functions of an arc")
EVENT = Part(("monitor", "name", "kind", "terminal", "direction"), "events (wrap a function in Monitor(function))")


def check_names(names: Iterable[str], known: Collection[str] = OPTIONS, owned: Mapping[str, str] | None = None) -> None:
    """Refuse unknown options (`TypeError` with the nearest `known` one), and `owned` ones with the reason."""
    for name in names:
        if owned and name in owned:
            raise TypeError(f"{name}: expected no such option here, {owned[name]}")
        if name not in known:
            near = get_close_matches(name, known, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise TypeError(f"{name}: expected one of the options {', '.join(sorted(known))}{hint}")


def checked(options: Mapping[str, Any]) -> Options:
    """The options with defaults; `TypeError, ValueError` for wrong values."""
    check_names(options)
    # `check_names` has checked the names.
    asked: Options = {**DEFAULTS, **options}  # type: ignore[typeddict-item]
    if not isinstance(asked["preset"], Preset):
        raise complain(TypeError, "preset", "FAST, DEFAULT, CONSERVATIVE, SERIES or another Preset", asked["preset"])
    for name, part in PARTS.items():
        if options.get(name) is not None:
            instance_with(name, options[name], *part)
    each("events", asked["events"], EVENT)
    each("guards", asked["guards"], GUARD)
    for name in ("check_jacobian", "examine"):
        check_flag(name, options.get(name, False))
    as_tolerance(asked["tolerance"])
    if not isinstance(asked["budget"], Budget | None):
        raise complain(TypeError, "budget", "a Budget", asked["budget"])
    if not names_homotopy(asked["target"]):
        checked_target(asked["target"])
    check_sign("direction", asked["direction"])
    if asked["finish"] is not None and not callable(asked["finish"]):
        raise complain(TypeError, "finish", "a function of (y, lam)", asked["finish"])
    if isinstance(asked["start"], Path):
        asked["start"] = arriving(asked["start"])
    if asked["start"] is not None:
        (guessed if is_guess(asked["start"]) else point_and_direction)(asked["start"])
    if asked["max_step"] is not None and not (is_number(asked["max_step"]) and asked["max_step"] > 0.0):
        raise complain(ValueError, "max_step", "a positive number", asked["max_step"])
    return asked


def check_run(observers: Any, state: Any) -> None:
    """Raise TypeError for wrong observers or state."""
    each("observers", observers, OBSERVER)
    if state is not None and not isinstance(state, State):
        raise complain(TypeError, "state", "the state of a tracer, or None", state)


def names_homotopy(target: Any) -> bool:
    """Whether a target or box is "homotopy"."""
    return isinstance(target, str) and target == "homotopy"


def checked_target(target: Any) -> float | None:
    """The target as float or None; TypeError or ValueError otherwise."""
    if target is None:
        return None
    if not is_number(target) or not math.isfinite(target):
        error = ValueError if is_number(target) or isinstance(target, str) else TypeError
        raise complain(error, "target", "a finite number or None", target)
    return float(target)


def each(name: str, values: Any, part: Part) -> None:
    """Raise TypeError unless `values` is a sequence of objects with the attributes of `part`."""
    if not isinstance(values, Sequence):
        raise complain(TypeError, name, f"a list of {name}", values)
    for value in values:
        instance_with(name, value, *part)


Documented = TypeVar("Documented", bound=Callable[..., Any])


def documented(function: Documented) -> Documented:
    """Replace ``{options}`` and ``{parts}`` (`PartOptions`) in the docstring."""
    text = inspect.getdoc(function)
    if text is not None:
        parts, others = (_parameters(options) for options in (PartOptions, Options))
        function.__doc__ = text.replace("{options}", parts + others).replace("{parts}", parts).replace("\n\n\n", "\n\n")
    return function


def _parameters(options: Any) -> str:
    return (inspect.getdoc(options) or "").partition("----------\n")[2] + "\n"
