"""Run, judge, time and save studies."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path as File

from continuation.archive.provenance import now, software
from continuation.chart.model import Answer, Failure, Method, Problem, Rung
from continuation.chart.results import Results, Row, write
from continuation.chart.study import Study, distance
from continuation.chart.table import Table, runs, summary
from continuation.counts import Counts
from continuation.linear.threads import one_thread
from continuation.path import Path
from continuation.status import Status

Watch = Callable[[int, int, Row], None]
"""Called after each run with (done, total, row)."""


@one_thread
def run(study: Study, watch: Watch | None = None) -> Results:
    """Run a study.

    The first run warms up and is judged; the time is the least processor time of later ones, with one BLAS thread
    unless the environment says otherwise. Exceptions become failures.

    Parameters
    ----------
    study : Study
    watch : callable, optional
        See `Watch`.
    """
    cases = [
        (problem, method, rung)
        for problem in study.problems
        for method in study.methods
        if method.applies(problem)
        for rung in (study.ladder if method.laddered else study.ladder[:1])
    ]
    rows: list[Row] = []
    for problem, method, rung in cases:
        spent = _spent(rows, problem, method) if study.give_up else None
        rows.append(_row(study, problem, method, rung, spent))
        if watch is not None:
            watch(len(rows), len(cases), rows[-1])
    return Results(
        study=study.name,
        title=study.title,
        ladder=study.ladder[0].name,
        errors={error.name: error.label for error in study.errors},
        work=study.work,
        rows=rows,
        provenance={**software(), "created": now(), **({"notes": "; ".join(study.notes)} if study.notes else {})},
    )


def _spent(rows: list[Row], problem: Problem, method: Method) -> Row | None:
    """Budget failure on this or a smaller problem of the family."""
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
        method=method.name,
        outside=method.outside,
        rung=rung.value if method.laddered else math.nan,
        failure=failure,
        message=message,
        errors={error.name: float(error.measure(problem, answer)) for error in study.errors},
        counts=answer.counts,
        turns=0 if answer.path is None else len(answer.path.turning_points),
        seconds=min(again, default=seconds),
    )


def _timed(problem: Problem, method: Method, rung: Rung) -> tuple[Answer, float]:
    # Processor time with one BLAS thread is independent of other load.
    begin = time.process_time()
    try:
        answer = method.run(problem, rung)
    except Exception as error:  # Other methods still run.
        sentence = f"{type(error).__name__}: {error}"
        answer = Answer(counts=Counts(), failure=Failure.EXCEPTION, message=sentence)
    return answer, time.process_time() - begin


def verdict(problem: Problem, answer: Answer) -> tuple[str, str]:
    """(failure, message); a right end with wrong turning points means a jump or a missed loop."""
    if answer.failure:
        return answer.failure, answer.message
    if answer.path is not None and (found := _of_path(problem, answer.path)) is not None:
        return found
    true = problem.truth.end
    if true is None:
        return Failure.NONE, answer.message
    if answer.end is None:
        return Failure.STOPPED, answer.message or "no end point"
    error = distance(answer.end, true)
    if error <= problem.truth.within:
        return Failure.NONE, answer.message
    return Failure.WRONG_END, f"the end point is {error:.1e} away from the true one"


def _of_path(problem: Problem, path: Path) -> tuple[str, str] | None:
    if not path.success:
        ended = path.status.name.lower().replace("_", " ")
        return Failure.BUDGET if path.status is Status.BUDGET_EXHAUSTED else ended, path.message
    true, turns = problem.truth.turning_points, len(path.turning_points)
    if true is not None and turns != len(true):
        return Failure.JUMP, f"{turns} turning points, the path has {len(true)}"
    return None


def tables(study: Study, results: Results) -> dict[str, Table]:
    """Tables by title: summary, the study's own, failures."""
    own = {title: make(results) for title, make in study.tables.items()}
    failed = runs(results, failures_only=True)
    return {"Methods": summary(results), **own, **({"Failures": failed} if failed.rows else {})}


def report(study: Study, results: Results, folder: File) -> list[File]:
    """Write ``NAME.json`` and ``NAME-FIGURE.png`` to an existing folder; return the files.

    They replace existing ones; without matplotlib there are no figures.
    """
    files = [write(results, folder / f"{study.name}.json")]
    for figure in study.figures:
        try:
            drawing = figure.draw(results)
        except ImportError:
            break
        files.append(folder / f"{study.name}-{figure.name}.png")
        drawing.savefig(files[-1])
    return files
