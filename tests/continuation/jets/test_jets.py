"""Series, derivatives and path coefficients against closed forms and high precision."""

import mpmath as mp
import numpy as np
import pytest

from continuation.jets import (
    Jet,
    JetDomainError,
    jacobian,
    path_series,
    second_derivatives,
    taylor,
    variable,
)

ORDER = 20


def assert_series(found, expected, rtol=1e-13):
    """Relative to a coefficient or its larger neighbour: a coefficient may pass near 0 between large ones."""
    expected = np.array([float(x) for x in expected])
    padded = np.pad(np.abs(expected), 1)
    scale = np.maximum(padded[1:-1], np.maximum(padded[:-2], padded[2:]))
    assert found.shape == expected.shape
    assert np.all(np.abs(found - expected) <= rtol * scale), (found - expected) / scale


FUNCTIONS = {
    "exp": (mp.exp, [-0.7, 2.0]),
    "expm1": (mp.expm1, [1e-9, 2.0]),
    "exp2": (lambda x: mp.mpf(2) ** x, [-0.7, 2.0]),
    "log": (mp.log, [0.2, 7.0]),
    "log1p": (mp.log1p, [1e-9, 2.0]),
    "log2": (lambda x: mp.log(x, 2), [0.2, 7.0]),
    "log10": (mp.log10, [0.2, 7.0]),
    "sin": (mp.sin, [0.4, 5.0]),
    "cos": (mp.cos, [0.4, 5.0]),
    "tan": (mp.tan, [1.1, -1.4]),
    "arcsin": (mp.asin, [0.1, -0.95]),
    "arccos": (mp.acos, [0.1, -0.95]),
    "arctan": (mp.atan, [0.1, -3.0]),
    "sinh": (mp.sinh, [0.1, -3.0]),
    "cosh": (mp.cosh, [0.1, -3.0]),
    "tanh": (mp.tanh, [0.7, -3.0]),
    "arcsinh": (mp.asinh, [0.7, -3.0]),
    "arccosh": (mp.acosh, [1.05, 9.0]),
    "arctanh": (mp.atanh, [0.1, -0.95]),
    "sqrt": (mp.sqrt, [0.1, 5.0]),
    "cbrt": (mp.cbrt, [0.1, 5.0]),
    "reciprocal": (lambda x: 1 / x, [-0.3, 5.0]),
    "square": (lambda x: x * x, [-0.3]),
    "absolute": (lambda x: -x, [-0.3]),
    "fabs": (lambda x: -x, [-0.3]),
}


COMPOSITIONS = [
    (lambda x: np.exp(np.sin(x)) / (2 + np.cos(x)), lambda x: mp.exp(mp.sin(x)) / (2 + mp.cos(x)), 0.3),
    (lambda x: np.tanh(x**2 - 1) * np.log(3 + x), lambda x: mp.tanh(x**2 - 1) * mp.log(3 + x), 0.8),
    (lambda x: x**1.7 + x**-2.5 + x**-3, lambda x: x ** mp.mpf(1.7) + x ** mp.mpf(-2.5) + x**-3, 1.3),
    (lambda x: x**x + 2.0**x, lambda x: x**x + mp.mpf(2) ** x, 1.4),
    (lambda x: np.hypot(x, np.exp(x)), lambda x: mp.sqrt(x * x + mp.exp(2 * x)), 0.2),
    (lambda x: np.arctan2(x - 2, np.cos(x) - 3), lambda x: mp.atan2(x - 2, mp.cos(x) - 3), 0.2),
    (lambda x: np.sqrt(1 + np.arctan(x) ** 2), lambda x: mp.sqrt(1 + mp.atan(x) ** 2), -0.4),
    (lambda x: np.cbrt(x - 3), lambda x: -mp.cbrt(3 - x), 1.0),
]


ELEMENTARY = [(getattr(np, name), reference, x0) for name, (reference, places) in FUNCTIONS.items() for x0 in places]


@pytest.mark.parametrize(("f", "reference", "x0"), ELEMENTARY + COMPOSITIONS)
def test_series_of_functions_and_compositions(f, reference, x0):
    with mp.workdps(80):
        expected = mp.taylor(reference, mp.mpf(x0), ORDER)
    assert_series(taylor(f, x0, ORDER), expected)


@pytest.mark.parametrize("m", [3, 130])
def test_second_derivatives_are_those_of_the_jacobian(m):
    x, v = 1.5 + np.cos(np.arange(m)), np.sin(1.0 + np.arange(m))

    def f(x):
        ends = np.stack([np.arctan2(x[0], x[2]), np.hypot(x[0], x[1]), x[1] ** x[2], x[0] * 0.0 + 3.0])
        return np.concatenate([np.exp(x[:2] * x[1]) / (1.0 + x[2]), np.sqrt(x[:3]) * np.sum(x * x), ends])

    found = second_derivatives(f, x, v)
    h = 1e-4
    jacobians = [jacobian(f, x + k * h * v) for k in (-2, -1, 1, 2)]
    wanted = (np.array([1.0, -8.0, 8.0, -1.0]) @ np.array(jacobians).reshape(4, -1)).reshape(found.shape) / (12.0 * h)
    np.testing.assert_allclose(found, wanted, atol=1e-9 * np.abs(wanted).max())
    np.testing.assert_array_equal(second_derivatives(lambda x: x[:1] * 0.0 + 1.0, x, v), np.zeros((1, m)))


# --- errors -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("f", "x0", "name"),
    [
        (np.sqrt, 0.0, "numpy.sqrt"),
        (np.sqrt, -1.0, "numpy.sqrt"),
        (np.cbrt, 0.0, "numpy.cbrt"),
        (np.log, 0.0, "numpy.log"),
        (np.log1p, -1.0, "numpy.log1p"),
        (np.abs, 0.0, "numpy.absolute"),
        (lambda x: 1 / x, 0.0, "numpy.divide"),
        (lambda x: x / 0.0, 1.0, "numpy.divide"),
        (np.reciprocal, 0.0, "numpy.reciprocal"),
        (lambda x: x**-1, 0.0, "numpy.power"),
        (lambda x: x**0.5, 0.0, "numpy.power"),
        (lambda x: x**x, 0.0, "numpy.power"),
        (np.arcsin, 1.0, "numpy.arcsin"),
        (np.arccos, -1.0, "numpy.arccos"),
        (np.arccosh, 1.0, "numpy.arccosh"),
        (np.arctanh, 1.0, "numpy.arctanh"),
        (lambda x: np.hypot(x, 0.0), 0.0, "numpy.sqrt"),
        (lambda x: np.arctan2(x, 0.0), 0.0, "numpy.arctan2"),
        (lambda x: np.maximum(x, 0.0), 0.0, "numpy.maximum"),
        (lambda x: np.minimum(1.0, x), 1.0, "numpy.minimum"),
        (lambda x: np.linalg.norm(np.stack([x, x])), 0.0, "numpy.sqrt"),
    ],
)
def test_points_without_a_series_are_refused_by_name(f, x0, name):
    with pytest.raises(JetDomainError, match=rf"^{name} has no Taylor series"):
        taylor(f, x0, 4)
    with pytest.raises(JetDomainError, match=rf"^{name} has no Taylor series"):
        jacobian(lambda x: f(x[0]), [x0])


def test_overflow_is_silent_and_shows():
    x = np.exp(variable(800.0, 1.0, 3))
    assert not np.isfinite(x)
    assert np.isfinite(variable(1.0, 1.0, 3))
    assert np.isnan(x - x)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Jet(1.0), r"c has shape \(\)"),
        (lambda: Jet(np.zeros((0, 3))), r"c has shape \(0, 3\)"),
        (lambda: variable(0.0, 1.0, -1), "order is -1"),
        (lambda: variable(0.0, 1.0, 3) + variable(0.0, 1.0, 4), "orders 3 and 4"),
        (lambda: jacobian(np.exp, 1.0), r"x has shape \(\)"),
        (lambda: path_series(np.subtract, [0.0, 1], [1.0], lambda r, rho: r, 3), "u0 and tangent have shapes"),
        (lambda: path_series(np.subtract, [0.0, 1], [1.0, 0], lambda r, rho: r, 0), "order is 0; expected 1"),
        (lambda: path_series(lambda y, lam: [lam, lam], [0.0, 1], [1.0, 0], lambda r, rho: r, 3), "residual has shape"),
        (lambda: taylor(lambda x: taylor(np.exp, x, 2), 0.0, 2), "jets of jets"),
    ],
)
def test_bad_input_is_refused_at_the_door(call, message):
    with pytest.raises((TypeError, ValueError), match=message):
        call()
