"""Vector Pade approximants: exact on rational curves, ended by their poles."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from continuation.predictors.pade import approximant, best, first_pole
from continuation.predictors.taylor import series_reach


def rational_curve(pole: float, order: int) -> np.ndarray:
    """Coefficients of (1/(1 - s/p), s/(1 - s/p), 1 + s)."""
    k = np.arange(order + 1)
    first = pole ** (-k.astype(float))
    second = np.concatenate(([0.0], first[:-1]))
    third = np.zeros(order + 1)
    third[:2] = 1.0
    return np.stack([first, second, third], axis=1)


@given(st.floats(0.3, 3.0), st.floats(-3.0, 0.8))
@settings(max_examples=50, deadline=None)
def test_exact_on_a_rational_curve_far_beyond_its_radius(pole, where):
    c = rational_curve(pole, 8)
    shape = approximant(c, np.ones(3))
    s = where * pole
    expected = np.array([1.0 / (1.0 - where), s / (1.0 - where), 1.0 + s])
    np.testing.assert_allclose(shape(s), expected, rtol=1e-8, atol=1e-8)


def test_the_pole_ends_the_range():
    c = rational_curve(0.7, 10)
    assert first_pole(approximant(c, np.ones(3)).denominator) == pytest.approx(0.7, rel=1e-8)
    rational = best(c, np.ones(3), 1e-3, series_reach(c, 1e-3, np.ones(3)), 1.0)
    assert rational is None or rational.reach < 0.7


def test_reaches_beyond_the_circle_of_convergence():
    # 1/(1 + s^2) and arctan: no real pole, radius 1.
    order = 24
    k = np.arange(order + 1)
    even = np.where(k % 2 == 0, (-1.0) ** (k // 2), 0.0)
    odd = np.where(k % 2 == 1, (-1.0) ** (k // 2) / np.maximum(k, 1), 0.0)
    c = np.stack([even, odd], axis=1)
    reach = series_reach(c, 1e-6, np.ones(c.shape[1]))
    rational = best(c, np.ones(2), 1e-6, reach, 0.95)
    assert reach < 0.7
    assert rational is not None
    assert rational.reach > 1.05
    s = 0.95 * rational.reach
    np.testing.assert_allclose(rational(s), [1.0 / (1.0 + s * s), np.arctan(s)], atol=1e-5)


def test_terms_whose_squares_overflow_are_no_reason_to_raise():
    c = rational_curve(1e-12, 15)
    assert best(c, np.ones(3), 1e-5, 1e-13, 0.95) is None


@given(st.integers(4, 20), st.integers(0, 1000))
@settings(max_examples=40, deadline=None)
def test_derivative_and_agreement_with_the_series_near_zero(order, seed):
    c = np.random.default_rng(seed).standard_normal((order + 1, 5)) * 0.5 ** np.arange(order + 1)[:, None]
    shape = approximant(c, np.ones(5))
    h = 1e-6
    slope = (shape(0.01 + h) - shape(0.01 - h)) / (2 * h)
    np.testing.assert_allclose(shape.derivative(0.01), slope, rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(shape(1e-3), (1e-3 ** np.arange(order + 1)) @ c, atol=1e-9)
