"""Studies: methods on problems along a ladder."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal

import numpy as np
from attrs import Attribute, Factory, field, frozen
from attrs.validators import min_len

from continuation.arguments.checks import integer
from continuation.arrays import Array
from continuation.auditing import refine
from continuation.chart.model import Answer, Method, Problem, Rung, tolerances
from continuation.chart.results import WORK, some
from continuation.tolerance import Tolerance

Size = Literal["smoke", "moderate", "full"]
"""Size of a ready study: for tests, for minutes on two cores, for reports. A ready study maps (size, compare) to
studies; `compare` adds outside solvers."""


WRONG = 1e-2
"""Relative error of a wrong answer: right ones are far nearer."""


@frozen
class Error:
    """A relative error measure.

    Attributes
    ----------
    name, label : str
        Of a column; of an axis.
    measure : callable
        Maps (problem, answer) to a number >= 0, or NaN.
    """

    name: str
    label: str
    measure: Callable[[Problem, Answer], float]


def distance(found: Array, true: Array | None) -> float:
    """Largest component difference over 1 + largest true component; nan if that is not known."""
    return math.nan if true is None else float(np.abs(found - true).max() / (1.0 + np.abs(true).max()))


def _curve_distance(problem: Problem, answer: Answer) -> float:
    path = answer.path
    if path is None or len(path) < 2:
        return math.nan
    s, accuracy = path.arclength, Tolerance(relative=1e-12)
    places = np.concatenate([s, *(s[:-1] + part * np.diff(s) for part in (0.25, 0.5, 0.75))])
    try:
        return max(distance(path(t), refine(problem.subject, path, t, accuracy)) for t in places.tolist())
    except ArithmeticError:
        return math.nan


def observed(name: str, label: str) -> Error:
    """An observed scalar that vanishes at solutions.

    Parameters
    ----------
    name : str
        Key in `Answer.observed`; NaN if absent.
    label : str
        For an axis.
    """
    return Error(name, label, lambda problem, answer: float(answer.observed.get(name, math.nan)))


END_POINT = Error(
    "end_point",
    "relative error of the end point",
    lambda problem, answer: math.nan if answer.end is None else distance(answer.end, problem.truth.end),
)
CURVE_DISTANCE = Error("curve_distance", "relative distance of the dense output from the curve", _curve_distance)


def _named_once(study: Study, attribute: Attribute[Any], value: Any) -> None:
    names = [getattr(item, "name", None) for item in value] if isinstance(value, Sequence) else []
    if not names or None in names or len(set(names)) < len(names):
        raise ValueError(f"{attribute.name}: expected a list of some, each with a name of its own, found {value!r}")


@frozen(eq=False, kw_only=True)
class Study:
    """Problems x methods x a ladder.

    Parameters
    ----------
    name, title : str
        For files; for figures.
    problems, methods, ladder : sequence of Problem, Method, Rung
        Default ladder: tolerances 1e-4 to 1e-10.
    errors, work : sequence of Error, of str
        Most important first; work from `WORK`.
    figures : sequence
        `Lines`, `Profile`, `Dumbbell`.
    repeats : int
        Timed runs after the first, of what succeeded.
    notes : sequence of str
        Remarks kept with the results.

    Raises
    ------
    ValueError
        For missing or repeated names, or unknown work.
    """

    name: str
    problems: Sequence[Problem] = field(validator=_named_once)
    methods: Sequence[Method] = field(validator=_named_once)
    ladder: Sequence[Rung] = field(factory=lambda: tolerances(1e-4, 1e-6, 1e-8, 1e-10), validator=min_len(1))
    errors: Sequence[Error] = field(validator=_named_once)
    work: Sequence[str] = field(
        default=("factorizations", "seconds"), validator=lambda study, attribute, value: some("work", value, WORK)
    )
    figures: Sequence[Any] = ()
    title: str = field(default=Factory(lambda study: study.name, takes_self=True))
    repeats: int = field(default=2, validator=integer(0))
    notes: Sequence[str] = ()
