"""The usual method of a study: a trace with parts of one's choice."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Unpack

from continuation.chart.ladder import Rung
from continuation.chart.model import Answer, Method, Problem
from continuation.path import Path
from continuation.step.options import Options, check_names
from continuation.tracing import trace


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
