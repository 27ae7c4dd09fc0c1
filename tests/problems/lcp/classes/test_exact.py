"""What the classes are decided with: determinants, minors and linear systems in exact arithmetic."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp

from problems.lcp import classes
from problems.lcp.classes import ExactMatrix

TINY = np.diag([1e-300, 1.0])
LARGE = np.array([[2**62 + 1, 2**62], [2**62, 2**62]])
BYTES = sp.csr_array((np.array([100, 100], np.int8), np.array([0, 0]), np.array([0, 2])), shape=(1, 1))
"""Integers whose sums and products wrap around, in their own type."""


@pytest.mark.parametrize(
    ("A", "answer", "expected"),
    [
        ([[0.1 + 0.2 - 0.3]], lambda A: classes.is_p(A).holds, True),
        ([[0.3 - 0.1 - 0.2]], lambda A: classes.is_n(A).holds, True),
        ([[0.1, 0.3], [0.1, 0.3]], lambda A: classes.is_nondegenerate(A).certificate.value, 0),
        ([[0.8]], lambda A: ExactMatrix.of(A).minor(1), Fraction(0.8)),
        ([[Fraction(4, 5)]], lambda A: ExactMatrix.of(A).minor(1), Fraction(4, 5)),
        (TINY, lambda A: classes.is_p(A).holds, True),
        (BYTES, lambda A: classes.is_p(A).holds, True),
        (LARGE, lambda A: classes.is_p(A).holds, True),
        (TINY - np.diag([2e-300, 0.0]), lambda A: classes.is_psd(A).holds, False),
    ],
)
def test_floats_are_taken_as_the_rationals_that_they_are(A, answer, expected):
    """0.1 + 0.2 - 0.3 is 2^-54, not zero; 0.8 is not 4/5."""
    assert answer(A) == expected
