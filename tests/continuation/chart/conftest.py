"""One study, run once."""

import pytest

import continuation
from continuation import chart
from continuation.counts import Counts
from continuation.predictors import Hermite
from problems.charts.subjects import cosine


def jump(problem, rung):
    """Arrives, with two turning points unseen: what a tracer says that has left out a loop."""
    answer = chart.traced("jump").run(problem, rung)
    answer.path.events = answer.path.events[2:]
    return answer


@pytest.fixture(scope="module")
def study():
    return chart.Study(
        name="closed",
        title="Closed forms",
        problems=[cosine(5)],
        methods=[
            chart.traced("Hermite", predictor=Hermite()),
            chart.Method("jumps", jump),
            chart.traced("broke", budget=continuation.Budget(steps=3)),
            chart.Method("raises", lambda problem, rung: 1 // 0),
            chart.Method(
                "lies",
                lambda problem, rung: chart.Answer(Counts(factorizations=1), end=problem.truth.end + 0.1),
            ),
        ],
        ladder=(1e-4, 1e-8),
        work=["factorizations", "seconds"],
        figures=[chart.Lines("end_point", "factorizations"), chart.Profile("factorizations")],
        repeats=1,
    )


@pytest.fixture(scope="module")
def results(study):
    return chart.run(study)
