"""The paper's ten examples, traced to lambda = 0 from its starts with no active-set finish: ends, turns and work."""

import numpy as np
import pytest

from continuation import SERIES, Status, trace
from continuation.predictors import Taylor
from problems.lcp import KKTHomotopy, certify_exactly
from problems.paper import EXAMPLES

each = pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: f"{example.number}-{example.label}")


@pytest.fixture(scope="module")
def both():
    """By number: the paths of SERIES and Pade approximants of order 30, and those of the default parts."""
    ways = {"preset": SERIES, "predictor": Taylor(order=30, rational=True)}, {}
    return [{e.number: trace(KKTHomotopy(e.problem, e.x0, e.z1, e.z2), **way) for e in EXAMPLES} for way in ways]


@each
def test_the_end_is_the_printed_solution_and_the_exact_one(example, both):
    for paths, accuracy in zip(both, (1e-10, 1e-7)):
        path = paths[example.number]
        x = path.endpoint.y[: example.q.size]
        assert path.status is Status.REACHED_TARGET
        assert path.endpoint.lam == 0.0
        np.testing.assert_allclose(x, example.printed_solution, rtol=0, atol=1e-4)
        np.testing.assert_allclose(x, [float(value) for value in example.solutions[0]], rtol=0, atol=accuracy)
        assert example.problem.relative_residual(x) <= 1e-10
        assert len(path.turning_points) == (2 if example.number == 10 else 0)


@each
def test_the_end_certifies_an_exact_solution(example, both):
    """The active set at the end, solved in rational arithmetic; exact for the floats, if not for all decimals."""
    x = np.maximum(both[0][example.number].endpoint.y[: example.q.size], 0.0)
    certificate = certify_exactly(example.problem, x)
    assert certificate.solves
    np.testing.assert_allclose(certificate.x_rounded, [float(v) for v in example.solutions[0]], rtol=1e-14, atol=0)


def test_the_work(both):
    assert sum(both[0][number].counts.factorizations for number in range(1, 10)) <= 90
    assert both[0][10].counts.factorizations <= 80


def test_the_square_root_end_of_example_7(both):
    for paths in both:
        assert paths[7].winding_number == 2
        assert EXAMPLES[6].problem.natural_residual(paths[7].endpoint.y[:4]) <= 1e-12
