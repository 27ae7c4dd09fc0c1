"""Whether a run succeeded: failures are named, and stay in the results."""

from __future__ import annotations

from continuation.chart.errors import distance
from continuation.chart.model import Answer, Failure, Problem
from continuation.path import Path
from continuation.status import Status


def verdict(problem: Problem, answer: Answer) -> tuple[str, str]:
    """(failure, message) of an answer; the failure is empty where none is seen.

    A path with the right end but the wrong number of turning points has jumped, or left out a loop.
    """
    if answer.failure:
        return answer.failure, answer.message
    if answer.path is not None:
        found = _of_path(problem, answer.path)
        if found is not None:
            return found
    true = problem.truth.end
    if true is not None:
        if answer.end is None:
            return Failure.STOPPED, answer.message or "no end point"
        error = distance(answer.end, true)
        if not error <= problem.truth.within:
            return Failure.WRONG_END, f"the end point is {error:.1e} away from the true one"
    return Failure.NONE, answer.message


def _of_path(problem: Problem, path: Path) -> tuple[str, str] | None:
    if path.status is Status.BUDGET_EXHAUSTED:
        return Failure.BUDGET, path.message
    if not path.success:
        return Failure.STOPPED, path.message
    true = problem.truth.turning_points
    turns = len(path.turning_points)
    if true is not None and turns != len(true):
        return Failure.JUMP, f"{turns} turning points, the path has {len(true)}"
    return None
