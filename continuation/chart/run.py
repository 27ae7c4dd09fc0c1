"""Running a study: every problem, method and rung, judged once and timed several times."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from continuation.archive.provenance import now, software
from continuation.chart.ladder import Rung
from continuation.chart.model import Answer, Failure, Method, Problem
from continuation.chart.results import Results, Row
from continuation.chart.study import Study
from continuation.chart.threads import pinned
from continuation.chart.verdict import verdict
from continuation.counts import Counts

Watch = Callable[[int, int, Row], None]
"""Called after every run: (runs done, runs in all, row)."""


def run(study: Study, watch: Watch | None = None) -> Results:
    """Run a study.

    The first run of a kind warms up, is judged and gives the counts, which are the same for all runs; the time (of the
    processor, BLAS on one thread) is the shortest of the runs after it. What a method raises becomes a row with the
    failure `exception`.

    Parameters
    ----------
    study : Study
    watch : callable, optional
        Called with every row.
    """
    cases = [
        (problem, method, rung)
        for problem in study.problems
        for method in study.methods
        if method.applies(problem)
        for rung in (study.ladder.rungs if method.laddered else study.ladder.rungs[:1])
    ]
    rows: list[Row] = []
    with pinned() as threads:
        for problem, method, rung in cases:
            spent = _spent(rows, problem, method) if study.give_up else None
            rows.append(_row(study, problem, method, rung, spent))
            if watch is not None:
                watch(len(rows), len(cases), rows[-1])
    return Results(
        study=study.name,
        title=study.title,
        ladder=study.ladder.name,
        errors={error.name: error.label for error in study.errors},
        work=tuple(study.work),
        rows=tuple(rows),
        provenance={
            **software(),
            "created": now(),
            "threads": threads,
            **({"notes": "; ".join(study.notes)} if study.notes else {}),
        },
    )


def _spent(rows: list[Row], problem: Problem, method: Method) -> Row | None:
    """A run of the method that was out of budget on this problem or a smaller one of its family."""
    beyond = (
        row
        for row in rows
        if row.failure == Failure.BUDGET
        and (row.method, row.family) == (method.name, problem.family)
        and (row.problem == problem.name or row.n < problem.n)
    )
    return next(beyond, None)


def _row(study: Study, problem: Problem, method: Method, rung: Rung, spent: Row | None) -> Row:
    if spent is None:
        answer, seconds = _timed(problem, method, rung)
    else:
        sentence = f"Not run: it was out of budget on {spent.problem}."
        answer, seconds = Answer(counts=Counts(), failure=Failure.BUDGET, message=sentence), 0.0
    failure, message = verdict(problem, answer)
    repeats = study.repeats if seconds <= study.patience and not failure else 0
    again = [_timed(problem, method, rung)[1] for _ in range(repeats)]
    return Row(
        problem=problem.name,
        family=problem.family,
        n=problem.n,
        seed=problem.seed,
        method=method.name,
        rung=rung.value if method.laddered else math.nan,
        failure=failure,
        message=message,
        errors={error.name: error.measure(problem, answer) for error in study.errors},
        counts=answer.counts,
        turns=0 if answer.path is None else len(answer.path.turning_points),
        seconds=min(again, default=seconds),
        repeats=repeats,
    )


def _timed(problem: Problem, method: Method, rung: Rung) -> tuple[Answer, float]:
    # Processor time of this process, BLAS on one thread: independent of other load.
    begin = time.process_time()
    try:
        answer = method.run(problem, rung)
    except Exception as error:  # An exception of one method is a failure in the results; the others still run.
        sentence = f"{type(error).__name__}: {error}"
        answer = Answer(counts=Counts(), failure=Failure.EXCEPTION, message=sentence)
    return answer, time.process_time() - begin
