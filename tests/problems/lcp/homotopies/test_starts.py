"""Starts of the LCP homotopies: on the path, in the units of the problem, reproducible, refused where they are none."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from problems import lcp
from problems.lcp.homotopies.starts import natural_units, typical_units
from problems.lcp.proof.phase1 import NoStrictlyFeasiblePoint
from problems.lcp.strategies import lcps
from problems.paper import EXAMPLES

from .util import ALL, every, made


@given(problem=lcps(), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_starts_are_on_the_path(problem, seed):
    rng = np.random.default_rng(seed)
    another = lcp.random_start(problem, rng)
    kkt = lcp.KKTHomotopy(problem, another.x0, another.z1, another.z2, another.w0)
    defaults = (lcp.KKTHomotopy, lcp.YuHomotopy, lcp.WangHomotopy, lcp.KojimaMegiddoMizunoHomotopy)
    for homotopy in (kkt, *(made(make, problem, rng) for make in ALL), *(make(problem) for make in defaults)):
        y, lam = homotopy.start()
        assert lam == 1.0
        assert (y > 0.0).all()
        assert np.abs(homotopy.residual(y, lam)).max() <= 1e-14 * (1.0 + np.abs(y).max() ** 2)


def test_the_papers_start_is_kept():
    for example in EXAMPLES:
        homotopy = lcp.KKTHomotopy(example.problem, example.x0)
        assert not homotopy.rho.any()
        assert np.array_equal(homotopy.start()[0], np.concatenate([example.x0, example.z1, example.z2]))


def test_default_start_has_the_units_of_the_problem():
    A, q = np.array([[2.0, 1.0], [0.0, 3.0]]), np.array([-4.0, 1.0])
    start, scaled = lcp.default_start(lcp.LCP(A, q)), lcp.default_start(lcp.LCP(1e6 * A, 1e2 * q))
    assert np.allclose(scaled.x0, 1e-4 * start.x0)
    assert np.allclose(scaled.w0, 1e2 * start.w0)
    # Without q the solutions are those of any multiple of A.
    start, scaled = (lcp.default_start(lcp.LCP(factor * A, 0.0 * q)).x0 for factor in (1.0, 2.0**20))
    np.testing.assert_array_equal(scaled, start)
    assert lcp.default_start(lcp.LCP(np.zeros((2, 2)), [0.0, 0.0])).x0 == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize("make", [lcp.ZhaoHomotopy, lcp.XuHomotopy])
def test_feasible_starts(make):
    example = EXAMPLES[1]
    assert np.array_equal(make(example.problem, example.x0).y0, example.problem.w(example.x0))
    found = make(example.problem)
    assert np.array_equal(found.y0, example.problem.w(found.x0))
    with pytest.raises(ValueError, match=r"x0: expected A x0 \+ q > 0"):
        make(example.problem, [0.1, 0.1])
    with pytest.raises(NoStrictlyFeasiblePoint):
        make(lcp.LCP([[-1.0]], [-1.0]))


@pytest.mark.parametrize(
    ("make", "y0"),
    [(lcp.YuHomotopy, [2.0, 0.25]), (lcp.WangHomotopy, [5.0, 1.0]), (lcp.KojimaMegiddoMizunoHomotopy, [8.5, 1.0])],
)
def test_defaults_of_y_for_a_given_x(make, y0):
    homotopy = make(lcp.LCP([[1.0, 2.0], [0.0, -1.0]], [-5.0, 0.5]), [0.5, 4.0])
    np.testing.assert_array_equal(homotopy.start()[0], [0.5, 4.0, *y0])


@every
@pytest.mark.parametrize(
    ("argument", "value", "found"),
    [
        ("x0", [1.0, -1.0], "-1.0 at index 1"),
        ("x0", [1.0, np.nan], "nan at index 1"),
        ("x0", [1.0], r"shape \(1,\)"),
        ("x0", ["a", "b"], "dtype"),
        ("other", [np.inf, 1.0], "inf at index 0"),
    ],
)
def test_bad_starts(make, argument, value, found):
    name = argument if argument == "x0" else ("w0" if make is lcp.KKTHomotopy else "y0")
    with pytest.raises(ValueError, match=f"{name}: expected .* found {found}|{name}: expected .* found .*{found}"):
        make(EXAMPLES[1].problem, **{"x0": [2.0, 1.0], name: value})


@pytest.mark.parametrize("make", [np.asarray, sp.csr_array])
@pytest.mark.parametrize("k", [-1000, -600, 500, 1000])
def test_units_follow_a_common_factor_whose_square_is_no_float(make, k):
    A, q = np.array([[2.0, 1.0], [-1.0, 3.0]]), np.array([-1.0, 2.0])
    problem, other = lcp.LCP(make(A), q), lcp.LCP(make(2.0**k * A), 2.0**k * q)
    for units in (natural_units, typical_units):
        x, w = units(problem)
        with np.errstate(all="raise"):
            assert units(other) == (pytest.approx(x, rel=1e-15), 2.0**k * w)


@pytest.mark.parametrize("w0", [[0.3, 0.02], [5.0, 40.0]])
def test_a_start_and_its_metric_move_with_bounds_and_are_mirrored_with_them(w0):
    A, q, low, x0 = np.array([[2.0, 1.0], [-1.0, 3.0]]), np.array([-1.0, 2.0]), np.array([-3.0, 0.5]), [1.0, 2.0]
    alone = lcp.KKTHomotopy(lcp.LCP(A, q + A @ low), x0, w0=w0)
    above = lcp.KKTHomotopy(lcp.MixedLCP(A, q, low, np.inf), low + x0, w0=w0)
    below = lcp.KKTHomotopy(lcp.MixedLCP(A, -q, -np.inf, -low), -low - x0, w0=w0)
    y, moved, mirrored = (homotopy.start()[0] for homotopy in (alone, above, below))
    np.testing.assert_allclose(moved, y + np.append(low, np.zeros(4)), rtol=1e-14)
    np.testing.assert_allclose(mirrored[[0, 1, 4, 5]], -moved[[0, 1, 4, 5]], rtol=1e-14)
    for homotopy in (alone, above, below):
        weights = homotopy.metric.weights(np.append(*homotopy.start()), np.ones(7), None)
        np.testing.assert_allclose(weights, np.append(1.0 / (6.0 * y * y), 1.0), rtol=1e-13)


def test_a_random_start_between_bounds_has_a_w_for_each_and_equal_products():
    """Lower bounds first: of x_1 and x_2, then the upper ones of x_0 and x_2."""
    problem = lcp.MixedLCP(np.eye(3), [5.0, -1.0, 2.0], [-np.inf, 0.0, -1.0], [0.0, np.inf, 1.0])
    start = lcp.random_start(problem, np.random.default_rng(3))
    w = problem.w(start.x0)
    assert (start.w0 > np.maximum([w[1], w[2], -w[0], -w[2]], 0.0)).all()
    x0, x1, x2 = start.x0
    products = start.z1 * [x1, x2 + 1.0, -x0, 1.0 - x2]
    np.testing.assert_allclose(products, products[0], rtol=1e-12)
    # Likewise of z2; in the box it is between 0 and 2, the multiplier of t what is left of that.
    (s1, s2, t0, t2), (z0, z1, z2) = start.w0, start.z2
    np.testing.assert_allclose([z1 * s1, -z0 * t0, z2 * s2], [products[0], products[0], (2.0 - z2) * t2], rtol=1e-12)
