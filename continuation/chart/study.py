"""A study: methods on problems at the values of one setting, with the errors to measure and the pictures to draw."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from attrs import Attribute, Factory, field, frozen
from attrs.validators import min_len

from continuation.arguments.checks import NOT_NEGATIVE, integer
from continuation.arrays import Array
from continuation.chart.model import Answer, Method, Problem, Rung, tolerances
from continuation.chart.results import WORK, Results
from continuation.chart.table import Table
from continuation.correctors import MoorePenrose
from continuation.counts import Counts
from continuation.evaluation.evaluator import Evaluator
from continuation.point.linearization import linearize
from continuation.tolerance import Tolerance

Size = Literal["smoke", "moderate", "full"]
"""Of a ready study, which is a function (size, compare) to studies: for tests, for a few minutes on two cores, for
reports; `compare` asks for outside solvers where they are installed."""

# -- errors -------------------------------------------------------------------------------------------------------


@frozen
class Error:
    """A measure of the error of an answer; all of them are relative.

    Attributes
    ----------
    name : str
        A column's.
    label : str
        An axis's.
    measure : callable
        (problem, answer) to a number >= 0, or NaN where it does not apply.
    """

    name: str
    label: str
    measure: Callable[[Problem, Answer], float]


def distance(found: Array, true: Array) -> float:
    """The largest difference of components, relative to 1 plus the largest true one."""
    return float(np.abs(found - true).max() / (1.0 + np.abs(true).max()))


def _end_point(problem: Problem, answer: Answer) -> float:
    true = problem.truth.end
    return math.nan if true is None or answer.end is None else distance(answer.end, true)


def _turning_points(problem: Problem, answer: Answer) -> float:
    true = problem.truth.turning_points
    if true is None or answer.path is None or not len(true) or len(answer.path.turning_points) != len(true):
        return math.nan
    return max(distance(event.u, row) for event, row in zip(answer.path.turning_points, true))


BETWEEN = (0.25, 0.5, 0.75)
"""Where in each step the dense output is compared with the curve."""


def _curve_distance(problem: Problem, answer: Answer) -> float:
    """The largest distance of the points, and of the dense output between them, from the nearest points of the curve.

    These are found along the normal, by Newton's method to round-off; NaN where that fails.
    """
    path = answer.path
    if path is None or len(path) < 2:
        return math.nan
    between = [
        after.segment.at(t) if after.segment is not None else (1.0 - t) * before.u + t * after.u
        for before, after in pairwise(path.steps)
        for t in BETWEEN
    ]
    evaluator, corrector = Evaluator(problem.subject, Counts()), MoorePenrose(max_contraction=10.0)
    largest = 0.0
    for u in [*path.u, *between]:
        try:
            here = linearize(evaluator, u, np.ones_like(u), np.ones_like(u))
            found = corrector.correct(evaluator, here, u, here.border, Tolerance(relative=1e-12))
        except ArithmeticError:
            return math.nan
        if not found.converged:
            return math.nan
        largest = max(largest, distance(u, found.u))
    return largest


def observed(name: str, label: str) -> Error:
    """A scalar that the homotopy (its `observe`) or the method reports at the end and that is zero at a solution.

    Parameters
    ----------
    name : str
        The key in `Answer.observed`; the error is NaN where nothing of that name is reported.
    label : str
        Of an axis.
    """
    return Error(name, label, lambda problem, answer: float(answer.observed.get(name, math.nan)))


END_POINT = Error("end_point", "relative error of the end point", _end_point)
TURNING_POINTS = Error("turning_points", "relative error of the turning points", _turning_points)
CURVE_DISTANCE = Error("curve_distance", "relative distance of the dense output from the curve", _curve_distance)

# -- the study ----------------------------------------------------------------------------------------------------


def _named_once(instance: Any, attribute: Attribute[Any], value: Any) -> None:
    names = [getattr(item, "name", None) for item in value] if isinstance(value, Sequence) else []
    if not names or None in names or len(set(names)) < len(names):
        raise ValueError(f"{attribute.name}: expected a list of some, each with a name of its own, found {value!r}")


def _known(instance: Any, attribute: Attribute[Any], value: Sequence[str]) -> None:
    if isinstance(value, str) or not value or not set(value) <= set(WORK):
        raise ValueError(f"work: expected a list of some of {', '.join(WORK)}, found {value!r}")


@frozen(eq=False, kw_only=True)
class Study:
    """Problems x methods x a ladder.

    Parameters
    ----------
    name : str
        Of its files.
    problems : sequence of Problem
    methods : sequence of Method
        See `traced` for the usual ones.
    ladder : sequence of Rung
        See `tolerances`, `longest_steps`; by default tolerances from 1e-4 to 1e-10.
    errors : sequence of Error
        The first one counts where a table has room for one.
    work : sequence of str
        Names in `WORK`; the first one counts where there is room for one.
    figures : sequence
        Of `Lines`, `Profile`, `Dumbbell`: what ``continuation chart`` draws.
    tables : mapping of str to callable
        By title, of the results: what ``continuation chart`` prints beside the summary by method.
    title : str
    repeats : int
        Timed runs after the first, which warms up and is judged; the shortest counts.
    patience : float
        Seconds: a run that took longer than this, or failed, is not repeated, its own time counts.
    give_up : bool
        Whether a method that ran out of budget is spared the further rungs of that problem and the larger problems of
        its family: they are failures of the same kind, without having been run.
    notes : sequence of str
        Sentences for the reader of the results, kept with them: outside solvers that are not installed, say.

    Raises
    ------
    ValueError
        If there is no problem, method or error, two of a kind have the same name, or a kind of work is unknown.
    """

    name: str
    problems: Sequence[Problem] = field(validator=_named_once)
    methods: Sequence[Method] = field(validator=_named_once)
    ladder: Sequence[Rung] = field(factory=lambda: tolerances(1e-4, 1e-6, 1e-8, 1e-10), validator=min_len(1))
    errors: Sequence[Error] = field(validator=_named_once)
    work: Sequence[str] = field(default=("factorizations", "seconds"), validator=_known)
    figures: Sequence[Any] = ()
    tables: Mapping[str, Callable[[Results], Table]] = field(factory=dict)
    title: str = field(default=Factory(lambda study: study.name, takes_self=True))
    repeats: int = field(default=2, validator=integer(0))
    patience: float = field(default=0.5, validator=NOT_NEGATIVE)
    give_up: bool = False
    notes: Sequence[str] = ()
