"""Problems, methods, and what a method answers to a problem."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from attrs import Factory, field, frozen

from continuation.arrays import Array
from continuation.chart.ladder import Rung
from continuation.chart.truth import Truth
from continuation.counts import Counts
from continuation.path import Path


class Failure:
    """How a run failed; the empty text if it did not."""

    NONE = ""
    JUMP = "jump"
    WRONG_END = "wrong end"
    EXCEPTION = "exception"
    BUDGET = "budget"
    STOPPED = "stopped"

    ALL = (JUMP, WRONG_END, EXCEPTION, BUDGET, STOPPED)


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


def everywhere(problem: Problem) -> bool:
    """True."""
    return True


@frozen(eq=False)
class Method:
    """A way to solve the problems of a study.

    Attributes
    ----------
    name : str
        In the legend.
    run : callable
        (problem, rung) to an Answer. What it raises is caught and counts as a failure.
    laddered : bool
        Whether the ladder concerns it; otherwise it runs once a problem.
    applies : callable
        A problem to whether the method is one for it; by default for all. Where it is none there is no row.
    """

    name: str
    run: Callable[[Problem, Rung], Answer]
    laddered: bool = True
    applies: Callable[[Problem], bool] = everywhere
