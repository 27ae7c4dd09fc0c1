"""What is varied, problems and what is known of them, methods, and what a method answers to a problem."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Unpack

import numpy as np
from attrs import Factory, evolve, field, frozen

from continuation.arguments.checks import POSITIVE, POSITIVE_FINITE
from continuation.arrays import Array
from continuation.counts import Counts
from continuation.path import Path
from continuation.step.options import Options, check_names
from continuation.step.presets import CONSERVATIVE, DEFAULT
from continuation.tracing import trace

# -- what is varied -----------------------------------------------------------------------------------------------


@frozen
class Rung:
    """One value of the setting that a study varies; a ladder is a sequence of them.

    Attributes
    ----------
    name : str
        What is varied, as axes and tables call it.
    value : float
        Positive.
    change : callable
        (options, value) to new options; by default the setting is none of a trace's.
    """

    name: str
    value: float = field(validator=POSITIVE_FINITE)
    change: Callable[[dict[str, Any], float], dict[str, Any]] = lambda options, value: options

    def apply(self, options: Mapping[str, Any]) -> dict[str, Any]:
        """The options of a trace with this value set.

        Parameters
        ----------
        options : mapping
            For `continuation.trace`.
        """
        return self.change(dict(options), self.value)


def tolerances(*values: float) -> tuple[Rung, ...]:
    """The tolerance of the trace.

    Parameters
    ----------
    *values : float
        Positive.
    """
    return tuple(Rung("tolerance", value, lambda options, value: {**options, "tolerance": value}) for value in values)


def longest_steps(*values: float) -> tuple[Rung, ...]:
    """The longest step that the controller may take, in arclength of the metric; the first step is no longer.

    Parameters
    ----------
    *values : float
        Positive.
    """
    return tuple(Rung("longest step", value, _limited) for value in values)


def _limited(options: dict[str, Any], value: float) -> dict[str, Any]:
    controller = options.get("controller") or options.get("preset", DEFAULT).controller
    bounds = controller.bounds
    # A first step that the controller leaves open, or one that is shorter, stays.
    first = bounds.initial if bounds.initial is None else min(bounds.initial, value)
    limited = evolve(bounds, maximum=value, minimum=min(bounds.minimum, value), initial=first)
    return {**options, "controller": evolve(controller, bounds=limited)}


# -- problems, methods, answers -----------------------------------------------------------------------------------


class Failure:
    """How a run failed; the empty text if it did not."""

    NONE = ""
    JUMP = "jump"
    WRONG_END = "wrong end"
    EXCEPTION = "exception"
    BUDGET = "budget"
    STOPPED = "stopped"


@frozen(eq=False)
class Truth:
    """What is known of a path; None where it is not known.

    Attributes
    ----------
    end : ndarray, shape (N + 1,), or None
        The end point (y, lam).
    turning_points : ndarray, shape (k, N + 1), or None
        In the order of the path.
    within : float
        A path whose end is farther from `end` than this, relative to its size, has come to a wrong end.
    """

    end: Array | None = None
    turning_points: Array | None = None
    within: float = field(default=1e-2, validator=POSITIVE)


REFERENCE_TOLERANCE = 1e-11
"""The last Newton increment of a reference: the point after it is exact to round-off."""


def reference(homotopy: Any, **options: Any) -> Truth:
    """The truth by a trace with short steps, Newton's own corrector and a tolerance near round-off.

    Parameters
    ----------
    homotopy : Homotopy
    **options
        As for `continuation.trace`: the target, the direction, the events that end the path.

    Raises
    ------
    ArithmeticError
        If the path does not arrive.
    """
    path: Path = trace(homotopy, **{"preset": CONSERVATIVE, "tolerance": REFERENCE_TOLERANCE, **options})
    if not path.success:
        raise ArithmeticError(f"the reference path did not arrive: {path.message}")
    return Truth(path.endpoint.u, np.reshape([event.u for event in path.turning_points], (-1, path.endpoint.u.size)))


@frozen(eq=False)
class Problem:
    """What is solved.

    Attributes
    ----------
    name : str
    subject : Any
        A homotopy, or what else the methods of the study take.
    truth : Truth
    options : mapping
        For `continuation.trace`, with every method: target, direction, events.
    n : int
        Size, for scaling; by default the subject's own.
    family : str
        Problems of one family differ in size or seed alone; by default the name.
    """

    name: str
    subject: Any
    truth: Truth = field(factory=Truth)
    options: Mapping[str, Any] = field(factory=dict)
    n: int = field()
    family: str = field(default=Factory(lambda problem: problem.name, takes_self=True))

    @n.default
    def _size(self) -> int:
        return len(self.subject.start()[0]) if hasattr(self.subject, "start") else int(getattr(self.subject, "n", 0))


@frozen(eq=False)
class Answer:
    """The outcome of one run of a method.

    Attributes
    ----------
    counts : Counts
    path : Path or None
        None for methods that trace none.
    end : ndarray or None
        The point found, (y, lam) for a path.
    observed : mapping
        Named scalars at the end, such as the natural residual.
    failure, message : str
        One of `Failure`, if the method itself knows; why.
    """

    counts: Counts
    path: Path | None = None
    end: Array | None = None
    observed: Mapping[str, float] = field(factory=dict)
    failure: str = Failure.NONE
    message: str = ""


@frozen(eq=False)
class Method:
    """A way to solve the problems of a study.

    Attributes
    ----------
    name : str
        At its line.
    run : callable
        (problem, rung) to an Answer. What it raises is caught and counts as a failure.
    laddered : bool
        Whether the ladder concerns it; otherwise it runs once a problem.
    applies : callable
        A problem to whether the method is one for it; by default for all. Where it is none there is no row.
    outside : bool
        Whether it is another package's, or the textbooks': pictures have it in grey, beside what is compared with it.
    """

    name: str
    run: Callable[[Problem, Rung], Answer]
    laddered: bool = True
    applies: Callable[[Problem], bool] = lambda problem: True
    outside: bool = False


def traced(name: str, **options: Unpack[Options]) -> Method:
    """A method that traces the problem's path.

    Parameters
    ----------
    name : str
    **options
        As for `continuation.trace`: preset, predictor, corrector, controller, metric, budget.

    Raises
    ------
    TypeError
        For an unknown option, at once rather than in every run.
    """
    check_names(options)
    return Method(
        name, lambda problem, rung: answer_of(trace(problem.subject, **rung.apply({**problem.options, **options})))
    )


def answer_of(path: Path) -> Answer:
    """A traced path as an answer."""
    if not path.steps:
        return Answer(path.counts, path, message=path.message)
    return Answer(path.counts, path, path.endpoint.u, path.endpoint.observed, message=path.message)
