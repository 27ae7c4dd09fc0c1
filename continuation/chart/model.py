"""Problems and what is known of them, methods, and what a method answers to a problem."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Unpack

import numpy as np
from attrs import Factory, field, frozen

from continuation.arguments.checks import POSITIVE
from continuation.arrays import Array
from continuation.chart.ladder import Rung
from continuation.counts import Counts
from continuation.path import Path
from continuation.step.options import Options, check_names
from continuation.step.presets import CONSERVATIVE
from continuation.tracing import trace

REFERENCE_TOLERANCE = 1e-11
"""The last Newton increment of a reference: the point after it is exact to round-off."""


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
    arclength : float or None
        In the Euclidean metric of (y, lam).
    nearest : callable or None
        Points of shape (m, N + 1) near the curve to points of the curve beside them.
    within : float
        A path whose end is farther from `end` than this, relative to its size, has come to a wrong end.
    """

    end: Array | None = None
    turning_points: Array | None = None
    arclength: float | None = None
    nearest: Callable[[Array], Array] | None = None
    within: float = field(default=1e-2, validator=POSITIVE)


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
    turns = np.array([event.u for event in path.turning_points]).reshape(-1, path.endpoint.u.size)
    return Truth(end=path.endpoint.u, turning_points=turns)


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
    seed : int
        -1 where nothing is random.
    """

    name: str
    subject: Any
    truth: Truth = field(factory=Truth)
    options: Mapping[str, Any] = field(factory=dict)
    n: int = field()
    family: str = field(default=Factory(lambda problem: problem.name, takes_self=True))
    seed: int = -1

    @n.default
    def _size(self) -> int:
        if hasattr(self.subject, "start"):
            return len(self.subject.start()[0])
        return int(getattr(self.subject, "n", 0))


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


def traced(name: str, homotopy: Callable[[Any], Any] | None = None, **options: Unpack[Options]) -> Method:
    """A method that traces the problem's path.

    Parameters
    ----------
    name : str
    homotopy : callable, optional
        The problem's subject to a homotopy; made anew for each run, and timed. By default the subject is one.
    **options
        As for `continuation.trace`: preset, predictor, corrector, controller, metric, budget.

    Raises
    ------
    TypeError
        For an unknown option, at once rather than in every run.
    """
    check_names(options)

    def run(problem: Problem, rung: Rung) -> Answer:
        followed = problem.subject if homotopy is None else homotopy(problem.subject)
        return answer_of(trace(followed, **rung.apply({**problem.options, **options})))

    return Method(name, run)


def answer_of(path: Path) -> Answer:
    """A traced path as an answer."""
    end = path.endpoint if path.steps else None
    return Answer(
        counts=path.counts,
        path=path,
        end=None if end is None else end.u,
        observed={} if end is None else end.observed,
        message=path.message,
    )
