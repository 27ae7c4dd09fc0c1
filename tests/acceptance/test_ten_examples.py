"""The paper's ten examples, traced to lambda = 0 from its starts with no active-set finish: ends, turns and work."""

import numpy as np
import pytest

from continuation import SERIES, Status, trace
from continuation.predictors import Taylor
from problems.lcp import KKTHomotopy, certify_exactly
from problems.paper import EXAMPLES

each = pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: f"{example.number}-{example.label}")


def traced(**options):
    return {e.number: trace(KKTHomotopy(e.problem, e.x0, e.z1, e.z2), **options) for e in EXAMPLES}


@pytest.fixture(scope="module")
def default():
    """By number: the paths of the default parts."""
    return traced()


@pytest.fixture(scope="module")
def series():
    """The same with the preset SERIES and Pade approximants of order 30."""
    return traced(preset=SERIES, predictor=Taylor(order=30, rational=True))


@each
def test_the_end_is_the_printed_solution_and_the_exact_one(example, series, default):
    for path, accuracy in ((series[example.number], 1e-10), (default[example.number], 1e-7)):
        x = path.endpoint.y[: example.q.size]
        assert path.status is Status.REACHED_TARGET
        assert path.endpoint.lam == 0.0
        np.testing.assert_allclose(x, example.printed_solution, rtol=0, atol=1e-4)
        np.testing.assert_allclose(x, [float(value) for value in example.solutions[0]], rtol=0, atol=accuracy)
        assert example.problem.relative_residual(x) <= 1e-10
        assert len(path.turning_points) == (2 if example.number == 10 else 0)


@each
def test_the_end_certifies_an_exact_solution(example, series):
    """The active set at the end, solved in rational arithmetic; exact for the floats, if not for all decimals."""
    x = np.maximum(series[example.number].endpoint.y[: example.q.size], 0.0)
    certificate = certify_exactly(example.problem, x)
    assert certificate.solves
    np.testing.assert_allclose(certificate.x_rounded, [float(v) for v in example.solutions[0]], rtol=1e-14, atol=0)


def test_the_work(series):
    assert sum(series[number].counts.factorizations for number in range(1, 10)) <= 90
    assert series[10].counts.factorizations <= 80


def test_the_square_root_end_of_example_7(series, default):
    for path in (series[7], default[7]):
        assert path.winding_number == 2
        assert EXAMPLES[6].problem.natural_residual(path.endpoint.y[:4]) <= 1e-12
