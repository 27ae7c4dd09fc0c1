"""Vector Pade approximants: exact on rational curves, ended by their poles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from continuation.predictors.pade import approximant, best, first_pole


def rational_curve(pole: float, order: int) -> np.ndarray:
    """Coefficients of (1/(1 - s/p), s/(1 - s/p), 1 + s)."""
    c = np.zeros((order + 1, 3))
    c[:, 0] = pole ** -np.arange(order + 1.0)
    c[1:, 1] = c[:-1, 0]
    c[:2, 2] = 1.0
    return c


@given(st.floats(0.3, 3.0), st.floats(-3.0, 0.8))
def test_exact_on_a_rational_curve_far_beyond_its_radius_up_to_the_pole(pole, where):
    shape = approximant(rational_curve(pole, 8), np.ones(3))
    assert first_pole(shape.denominator) == pytest.approx(pole, rel=1e-8)
    s, left, h = where * pole, 1.0 - where, 1e-6
    np.testing.assert_allclose(shape(s), [1.0 / left, s / left, 1.0 + s], rtol=1e-8, atol=1e-8)
    slope = (shape(0.01 + h) - shape(0.01 - h)) / (2.0 * h)
    np.testing.assert_allclose(shape.derivative(0.01), slope, rtol=1e-5, atol=1e-7)


def test_terms_whose_squares_overflow_are_no_reason_to_raise():
    assert best(rational_curve(1e-12, 15), np.ones(3), 1e-5, 1e-13, 0.95) is None
