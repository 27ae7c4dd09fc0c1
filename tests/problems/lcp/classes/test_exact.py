"""What the classes are decided with: determinants, minors and linear systems in exact arithmetic."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from problems.lcp import classes
from problems.lcp.classes import ExactMatrix
from problems.lcp.classes.exact import principal_minors
from problems.lcp.classes.simplex import at_least, exactly, feasible_point
from problems.lcp.strategies import matrices

from ....exact import determinant
from .test_classes import sub, times


@given(matrices("any", st.integers(1, 5)))
@example(np.zeros((4, 4)))
@example(np.fliplr(np.eye(4)))
def test_principal_minors_are_the_determinants_of_the_principal_submatrices(A):
    rows = A.astype(int).tolist()
    minors = principal_minors(rows)
    for mask in range(1 << len(rows)):
        chosen = [i for i in range(len(rows)) if mask >> i & 1]
        assert minors[mask] == determinant(sub(rows, chosen))


@given(st.integers(1, 4), st.integers(1, 4), st.data())
def test_exactly_one_of_a_linear_system_and_its_farkas_alternative_is_feasible(m, n, data):
    """Farkas: M x = b, x >= 0 has a solution, or y'M >= 0 with y'b < 0 has one, never both."""
    entry = st.integers(-3, 3)
    M = [[data.draw(entry) for _ in range(n)] for _ in range(m)]
    b = [data.draw(entry) for _ in range(m)]
    x = feasible_point(exactly([*zip(M, b, strict=True)]), n)
    transposed = [[*column, *(-v for v in column)] for column in zip(*M, strict=True)]
    alternative = [at_least(row) for row in transposed] + [at_least([-v for v in b] + b, 1)]
    y = feasible_point(alternative, 2 * m)
    assert (x is None) != (y is None)
    if x is not None:
        assert min(x) >= 0
        assert times(M, x) == b
    else:
        assert min(y) >= 0
        assert all(times([row], y)[0] >= right for row, right in alternative)


TINY = np.diag([1e-300, 1.0])


@pytest.mark.parametrize(
    ("A", "answer", "expected"),
    [
        ([[0.1 + 0.2 - 0.3]], lambda A: classes.is_p(A).holds, True),
        ([[0.3 - 0.1 - 0.2]], lambda A: classes.is_n(A).holds, True),
        ([[0.1, 0.3], [0.1, 0.3]], lambda A: classes.is_nondegenerate(A).certificate.value, 0),
        ([[0.8]], lambda A: ExactMatrix.of(A).minor(1), Fraction(0.8)),
        ([[Fraction(4, 5)]], lambda A: ExactMatrix.of(A).minor(1), Fraction(4, 5)),
        (TINY, lambda A: classes.is_p(A).holds, True),
        (TINY - np.diag([2e-300, 0.0]), lambda A: classes.is_psd(A).holds, False),
    ],
)
def test_floats_are_taken_as_the_rationals_that_they_are(A, answer, expected):
    """0.1 + 0.2 - 0.3 is 2^-54, not zero; 0.8 is not 4/5."""
    assert answer(A) == expected
