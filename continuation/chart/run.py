"""Run, judge, time and save studies."""

from __future__ import annotations

import math
import time
from pathlib import Path as File

from continuation.archive.provenance import now, software
from continuation.chart.model import Answer, Method, Problem
from continuation.chart.results import Results, Row, write
from continuation.chart.study import WRONG, Study, distance
from continuation.chart.table import Table, solved, summary
from continuation.counts import Counts
from continuation.linear.threads import one_thread
from continuation.status import Status


@one_thread
def run(study: Study) -> Results:
    """Run a study.

    The first run is judged; the time is the least processor time of later ones, with one BLAS thread by default.
    Exceptions become failures.

    Parameters
    ----------
    study : Study
    """
    rows = [
        _row(study, problem, method, rung)
        for problem in study.problems
        for method in study.methods
        if method.applies(problem)
        for rung in study.ladder
    ]
    return Results(
        study=study.name,
        title=study.title,
        ladder=study.varied,
        errors=study.errors,
        work=study.work,
        rows=rows,
        provenance={**software(), "created": now()},
    )


def _row(study: Study, problem: Problem, method: Method, rung: float) -> Row:
    answer, seconds = _timed(problem, method, rung)
    failure, message = verdict(problem, answer)
    end = math.nan if answer.end is None else distance(answer.end, problem.truth.end)
    known = {"end_point": end, **answer.observed}
    again = [_timed(problem, method, rung)[1] for _ in range(0 if failure else study.repeats)]
    return Row(
        problem=problem.name,
        family=problem.family,
        n=problem.n,
        method=method.name,
        outside=method.outside,
        rung=rung,
        failure=failure,
        message=message,
        errors={name: float(known.get(name, math.nan)) for name in study.errors},
        counts=answer.counts,
        seconds=min(again, default=seconds),
    )


def _timed(problem: Problem, method: Method, rung: float) -> tuple[Answer, float]:
    begin = time.process_time()
    try:
        answer = method.run(problem, rung)
    except Exception as error:
        sentence = f"{type(error).__name__}: {error}"
        answer = Answer(counts=Counts(), failure="exception", message=sentence)
    return answer, time.process_time() - begin


def verdict(problem: Problem, answer: Answer) -> tuple[str, str]:
    """The pair (failure, message); a right end with wrong turning points means a jump or a missed loop."""
    path, truth = answer.path, problem.truth
    off = math.nan if answer.end is None else distance(answer.end, truth.end)
    if answer.failure:
        return answer.failure, answer.message
    if path is not None and not path.success:
        ended = path.status.name.lower().replace("_", " ")
        return "budget" if path.status is Status.BUDGET_EXHAUSTED else ended, path.message
    if path is not None and truth.turns not in (None, len(path.turning_points)):
        return "jump", f"{len(path.turning_points)} turning points, the path has {truth.turns}"
    if truth.end is not None and answer.end is None:
        return "stopped", answer.message or "no end point"
    right = truth.end is None or off <= WRONG
    return ("", answer.message) if right else ("wrong end", f"the end is {off:.1e} away")


def tables(results: Results) -> dict[str, Table]:
    """Tables by title."""
    found = {"Median excess": summary(results)}
    return {**found, "Families": solved(results)} if len(results.families) > 1 else found


def report(study: Study, results: Results, folder: File) -> list[File]:
    """Write ``NAME.json`` and ``NAME-1.png``, ... to an existing folder; return the files.

    They replace existing ones; without matplotlib figures are left out.
    """
    files = [write(results, folder / f"{study.name}.json")]
    for k, figure in enumerate(study.figures, start=1):
        try:
            drawing = figure.draw(results)
        except ImportError:
            break
        files.append(folder / f"{study.name}-{k}.png")
        drawing.savefig(files[-1])
    return files
