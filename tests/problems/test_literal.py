"""The paper's algorithm, read literally: the counts measured with an independent program, and what they hide."""

from functools import cache

import numpy as np
import pytest

from problems.literal import run_literally
from problems.paper import EXAMPLES

# Iterations of an independent implementation with l0 = 0.5, eps1 = 1e-9, eps2 = 1e-3, eps3 = 1e-6.
COUNTS = {1: 18, 2: 21, 3: 15, 4: 24, 5: 17, 6: 24, 7: 18, 8: 3289, 9: 27, 10: 1955}


@cache
def run(number):
    example = EXAMPLES[number - 1]
    return example, run_literally(example.problem, example.x0, example.z1, example.z2)


@pytest.mark.parametrize("number", COUNTS)
def test_the_measured_iterations_come_out(number):
    _, result = run(number)
    assert result.iterations == COUNTS[number]
    assert result.claims_solution
    assert result.ended_by.startswith("Step 5")
    assert 0 < result.lam[-1] <= 1e-9


@pytest.mark.parametrize("number", COUNTS)
def test_the_claim_is_true_on_all_examples_but_the_first(number):
    example, result = run(number)
    if number == 1:
        assert result.residual == pytest.approx(1 / 6, abs=1e-6)
        np.testing.assert_allclose(result.x, [1 / 6, 0], atol=1e-6)
    else:
        # Example 7 ends with an error like sqrt(lambda) = 3e-5, since its solution is not strictly complementary.
        assert result.residual <= (1e-4 if number == 7 else 2e-7)
        np.testing.assert_allclose(result.x, example.printed_solution, atol=1e-4)


@pytest.mark.parametrize(
    ("number", "settings", "ended", "claims"),
    [(2, {"a0": 1e-3}, "Step 4", True), (8, {"max_iterations": 5}, "5 iterations", False)],
)
def test_a_run_ends_early_and_says_how(number, settings, ended, claims):
    example = EXAMPLES[number - 1]
    result = run_literally(example.problem, example.x0, **settings)
    assert ended in result.ended_by
    assert result.claims_solution is claims
    assert claims or result.iterations == 5
    assert not claims or result.lam[-1] < 0, "outside the interval"
