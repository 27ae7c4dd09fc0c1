"""Problems, methods and their answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Unpack

from attrs import Factory, field, frozen

from continuation.arrays import Array
from continuation.counts import Counts
from continuation.homotopy import Homotopy, offers
from continuation.path import Path
from continuation.step.options import Options, check_names
from continuation.step.presets import CONSERVATIVE
from continuation.tracing import trace


@frozen(eq=False)
class Truth:
    """Known results of a path.

    Attributes
    ----------
    end : ndarray or None
        Shape (N + 1,): (y, lam).
    turns : int or None
        Number of turning points.
    """

    end: Array | None = None
    turns: int | None = None


REFERENCE_TOLERANCE = 1e-11
"""Last Newton increment of a reference; the next would be round-off."""


def reference(homotopy: Any, **options: Any) -> Truth:
    """Trace a reference: short steps, full Newton, tolerance near round-off.

    Parameters
    ----------
    homotopy : Homotopy
    **options
        For `continuation.trace`.

    Raises
    ------
    ArithmeticError
        If the path does not arrive.
    """
    path: Path = trace(homotopy, **{"preset": CONSERVATIVE, "tolerance": REFERENCE_TOLERANCE, **options})
    if not path.success:
        raise ArithmeticError(f"the reference path did not arrive: {path.message}")
    return Truth(path.endpoint.u, len(path.turning_points))


@frozen(eq=False)
class Problem:
    """A problem of a study.

    Attributes
    ----------
    name, family : str
        A family's problems differ in size or seed.
    subject : Any
        Homotopy, or other input of methods.
    truth : Truth
    options : mapping
        For `continuation.trace`.
    n : int
        Size.
    """

    name: str
    subject: Any
    truth: Truth = field(factory=Truth)
    options: Mapping[str, Any] = field(factory=dict)
    n: int = field(default=Factory(lambda problem: order_of(problem.subject), takes_self=True))
    family: str = field(default=Factory(lambda problem: problem.name, takes_self=True))


def order_of(subject: Any) -> int:
    """The number of unknowns of a homotopy, else the subject's `n`, or 0."""
    return len(subject.start()[0]) if offers(subject, Homotopy) else int(getattr(subject, "n", 0))


@frozen(eq=False)
class Answer:
    """Outcome of a run.

    Attributes
    ----------
    counts : Counts
    path : Path or None
    end : ndarray or None
        Point found; (y, lam) for a path.
    observed : mapping
        Scalars at the end.
    failure, message : str
        Kind of failure, empty on success: "jump", "wrong end", "exception", "budget", "stopped"; reason.
    """

    counts: Counts
    path: Path | None = None
    end: Array | None = None
    observed: Mapping[str, float] = field(factory=dict)
    failure: str = ""
    message: str = ""


@frozen(eq=False)
class Method:
    """A way to solve problems.

    Attributes
    ----------
    name : str
    run : callable
        Maps (problem, rung) to an Answer; a rung is a tolerance, or another number that the study varies.
    applies : callable
        Whether it fits a problem.
    outside : bool
        Whether others provide the method.
    """

    name: str
    run: Callable[[Problem, float], Answer]
    applies: Callable[[Problem], bool] = lambda problem: True
    outside: bool = False


def traced(name: str, **options: Unpack[Options]) -> Method:
    """Trace the problem's path.

    Parameters
    ----------
    name : str
    **options
        For `continuation.trace`.

    Raises
    ------
    TypeError
        For an unknown option.
    """
    check_names(options)

    def run(problem: Problem, rung: float) -> Answer:
        return answer_of(trace(problem.subject, **{**problem.options, **options, "tolerance": rung}))

    return Method(name, run)


def answer_of(path: Path) -> Answer:
    """Convert a path to an answer."""
    end = path.endpoint if path.steps else None
    u, observed = (None, dict[str, float]()) if end is None else (end.u, end.observed)
    return Answer(path.counts, path, u, observed, message=path.message)
