"""The data of the paper: consistent with each other, with what is printed, and with exact arithmetic."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

from problems.paper import COUNTEREXAMPLES, EXAMPLES, Counterexample, Example

from ..exact import determinant

examples = pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: f"{example.number}-{example.label}")
counterexamples = pytest.mark.parametrize("counterexample", COUNTEREXAMPLES, ids=lambda c: c.matrix_class)


def decimals(array):
    """The decimal numbers as printed, exactly."""
    return np.vectorize(lambda value: Fraction(repr(float(value))), otypes=[object])(array)


def principal_minors(matrix):
    """(order, minor) of every principal submatrix."""
    n = len(matrix)
    return [
        (size, determinant([[matrix[i][j] for j in rows] for i in rows]))
        for size in range(1, n + 1)
        for rows in combinations(range(n), size)
    ]


def complementary_basic_points(A, q):
    """Every LCP solution of a nonsingular complementary basis, by Cramer's rule."""
    n = len(q)
    found = set()
    for size in range(n + 1):
        for active in combinations(range(n), size):
            block = [[A[i][j] for j in active] for i in active]
            scale = determinant(block) if active else Fraction(1)
            if scale == 0:
                continue
            x = [Fraction(0)] * n
            for k, j in enumerate(active):
                replaced = [[*row[:k], -q[i], *row[k + 1 :]] for i, row in zip(active, block)]
                x[j] = determinant(replaced) / scale
            w = A @ np.array(x, dtype=object) + q
            if min(x) >= 0 and min(w) >= 0:
                found.add(tuple(x))
    return found


def test_numbers_and_labels():
    assert [example.number for example in EXAMPLES] == list(range(1, 11))
    assert len({example.label for example in EXAMPLES}) == 10
    assert [example.printed_iterations for example in EXAMPLES] == [20, 22, 15, 14, 17, 24, 17, 17, 27, 1925]
    assert [len(example.solutions) for example in EXAMPLES] == [1, 1, 1, 3, 2, 2, 1, 1, 2, 2]


@examples
def test_start_is_strictly_feasible(example: Example):
    x0 = decimals(example.x0)
    assert min(x0) > 0
    assert min(decimals(example.A) @ x0 + decimals(example.q)) > 0
    assert (example.z1 == 1).all()
    assert (example.z2 == 1).all()
    assert example.z1.shape == example.z2.shape == example.x0.shape == example.q.shape


@examples
def test_exact_solutions_are_exact(example: Example):
    for solution in example.solutions:
        x = np.array(solution, dtype=object)
        w = decimals(example.A) @ x + decimals(example.q)
        assert min(x) >= 0
        assert min(w) >= 0
        assert all(x * w == 0)


@examples
def test_solutions_are_all_of_them(example: Example):
    assert complementary_basic_points(decimals(example.A), decimals(example.q)) == set(example.solutions)


@examples
def test_printed_solution_is_the_first_exact_one_to_its_digits(example: Example):
    exact = np.array([float(value) for value in example.solutions[0]])
    half_a_digit = {5: 5e-5, 10: 5e-7}.get(example.number, 0.0)
    assert np.abs(example.printed_solution - exact).max() <= half_a_digit
    assert example.problem.natural_residual(example.printed_solution) <= 400 * half_a_digit


@examples
def test_printed_point_is_x_w_x_but_for_the_misprints(example: Example):
    """At a solution z1 = w and z2 = x (MATH: dx = dw = 0), so the printed end is (x, w, x, 0)."""
    printed = example.printed_point
    if example.number == 2:
        assert printed.size == 8  # one zero too many
        printed = printed[:7]
        printed = np.where(printed == 1.499, 1.5, np.where(printed == 0.499, 0.5, printed))
    if example.number == 5:
        assert printed.size == 11  # a comma for the decimal point
        printed = np.concatenate([printed[:4], [1.2125], printed[6:]])
    x = np.array([float(value) for value in example.solutions[0]])
    np.testing.assert_allclose(printed, np.concatenate([x, example.problem.w(x), x, [0.0]]), rtol=0, atol=5e-5)


@examples
def test_only_example_7_is_degenerate(example: Example):
    x = np.array(example.solutions[0], dtype=object)
    w = decimals(example.A) @ x + decimals(example.q)
    assert (min(x + w) == 0) == (example.number == 7)


@examples
def test_true_classes(example: Example):
    minors = principal_minors(decimals(example.A).tolist())
    n = example.q.size
    p0 = all(minor >= 0 for _, minor in minors)
    nondegenerate = all(minor != 0 for _, minor in minors)
    assert p0 == (example.number in (2, 3))
    assert nondegenerate == (example.number in (1, 5, 6))
    if example.number == 1:
        assert all(minor < 0 for _, minor in minors)
    if example.number in (7, 8):
        assert all((minor > 0) if size == n else (minor <= 0) for size, minor in minors)
        assert minors[-1] == (n, {7: 1, 8: 8}[example.number])
    if example.number in (9, 10):
        assert all((minor > 0) if size > n - 2 else (minor <= 0) for size, minor in minors)


@examples
def test_data_cannot_be_changed(example: Example):
    with pytest.raises(ValueError, match="read-only"):
        example.A[0, 0] = 7.0
    assert example.problem.n == example.q.size


@counterexamples
def test_counterexample_is_strictly_feasible_and_has_no_solution(counterexample: Counterexample):
    A, q, x0 = (decimals(value) for value in (counterexample.A, counterexample.q, counterexample.x0))
    assert min(x0) > 0
    assert min(A @ x0 + q) > 0
    assert not complementary_basic_points(A, q)


def test_counterexamples_have_their_classes():
    p0, nondegenerate = (
        [minor for _, minor in principal_minors(decimals(example.A).tolist())] for example in COUNTEREXAMPLES
    )
    assert min(p0) >= 0
    assert nondegenerate == [1, -1, -2]


@counterexamples
def test_end_of_the_counterexample_is_stationary_and_no_solution(counterexample: Counterexample):
    """A'z2 + z1 = (A + A')x + q with z1 x = z2 w = 0 has z >= 0 at the end, and x'w is not zero."""
    A, q, x = counterexample.A, counterexample.q, counterexample.end
    w = A @ x + q
    positive_x, positive_w = x > 0, w > 1e-3
    n = q.size
    unknowns = np.hstack([np.eye(n)[:, ~positive_x], A.T[:, ~positive_w]])
    z, *_ = np.linalg.lstsq(unknowns, (A + A.T) @ x + q, rcond=None)
    np.testing.assert_allclose(unknowns @ z, (A + A.T) @ x + q, atol=1e-9)
    assert (z >= 0).all()
    assert x @ w > 0.5
