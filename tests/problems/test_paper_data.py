"""The data of the paper: consistent with each other, with what is printed, and with exact arithmetic."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from problems.paper import COUNTEREXAMPLES, EXAMPLES, Example

from ..exact import gauss_jordan

examples = pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: f"{example.number}-{example.label}")


def decimals(array):
    """The decimal numbers as printed, exactly."""
    return np.vectorize(lambda value: Fraction(repr(float(value))), otypes=[object])(array)


def exactly(item):
    """A and q as printed, and all solutions of nonsingular complementary bases, in rational numbers."""
    A, q = decimals(item.A), decimals(item.q)
    found, n = set(), len(q)
    for chosen in product([False, True], repeat=n):
        # w_i = 0 on the basis, x_i = 0 off it.
        rows = [A[i] if chosen[i] else np.eye(n, dtype=object)[i] for i in range(n)]
        x, _ = gauss_jordan(rows, [-q[i] if chosen[i] else 0 for i in range(n)])
        if x is not None and min(*x, *(A @ np.array(x, dtype=object) + q)) >= 0:
            found.add(tuple(x))
    return A, q, found


@pytest.mark.parametrize("item", [*EXAMPLES, *COUNTEREXAMPLES], ids=lambda item: getattr(item, "label", "none"))
def test_solutions_are_all_of_them_and_exact_and_the_start_is_strictly_feasible(item):
    A, q, found = exactly(item)
    assert found == set(getattr(item, "solutions", ()))
    x0 = decimals(item.x0)
    assert min(*x0, *(A @ x0 + q)) > 0
    with pytest.raises(ValueError, match="read-only"):
        item.A[0, 0] = 7.0


@examples
def test_printed_solution_is_the_first_exact_one_to_its_digits(example: Example):
    exact = np.array([float(value) for value in example.solutions[0]])
    half_a_digit = {5: 5e-5, 10: 5e-7}.get(example.number, 0.0)
    assert np.abs(example.printed_solution - exact).max() <= half_a_digit
