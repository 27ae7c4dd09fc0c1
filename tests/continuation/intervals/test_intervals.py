"""Interval arrays: no value outside, numpy's functions as jets have them, and what is not defined stays undefined."""

from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
import scipy.sparse as sp

from continuation import jets
from continuation.intervals import Interval, UndecidedError, enclose, jacobian
from continuation.numbers.ends import Ends, thin

from ..util import assigned
from .against_mpmath import DIGITS, ONE, TWO, drawn, inside

RNG = np.random.default_rng(5)
X = RNG.normal(size=6)
M = RNG.normal(size=(6, 6))


@pytest.mark.parametrize("name", [*ONE, *TWO])
def test_no_value_lies_outside_of_its_interval(name):
    found, exact = drawn(name, 600, seed=1)
    with mp.workdps(DIGITS):
        assert inside(found, exact)
    assert len(exact) == 600
    told = np.isfinite(found.hi).mean()
    assert told > (0.2 if name in ("tan", "divide", "reciprocal", "log1p", "cbrt", "arctan2") else 0.6)


def test_sums_and_products_of_all_sizes_are_enclosed():
    # Rational arithmetic as the judge; subnormal numbers, products that underflow, sums that cancel.
    rng = np.random.default_rng(3)
    x, y = (
        rng.choice([-1.0, 1.0], 4000) * rng.uniform(1.0, 2.0, 4000) * 2.0 ** rng.integers(-540, 500, 4000) for _ in "xy"
    )
    small = rng.integers(-(2**54), 2**54, (2, 1000)) * 2.0**-1074
    x, y = np.concatenate([x, x, small[0], [0.0, 0.0, 1.0]]), np.concatenate([y, -x, small[1], [0.0, 2.0**-1074, -1.0]])
    u, v = thin(x), Ends(y - 0.0, y + 0.0)
    for found, exact in ((u + v, Fraction.__add__), (u - v, Fraction.__sub__), (u * v, Fraction.__mul__)):
        for lo, hi, a, b in zip(found.lo.tolist(), found.hi.tolist(), x.tolist(), y.tolist()):
            value = exact(Fraction(a), Fraction(b))
            assert Fraction(lo) <= value <= Fraction(hi)
            assert value or lo == hi == 0.0
            assert hi - lo <= 1e-15 * abs(value) + 2.0**-1070


RESIDUALS = {
    "elementwise": lambda y: np.exp(-y) * np.sin(y) - y**3 / (2.0 + np.cos(y)) + np.arctan2(y, 1.0 + y * y),
    "matmul": lambda y: M @ y + (y @ M) * y,
    "sparse": lambda y: sp.csr_array(M) @ y - y @ sp.csr_array(M),
    "list": lambda y: [y[0] * y[1], np.sum(y), y[2:4] @ y[4:], np.prod(y[:3]), y.sum() ** 2, np.mean(y)],
    "assembly": lambda y: np.concatenate([np.roll(y, 1)[:3], np.append(y[1:3], 0.5)]) * np.diff(np.append(y, 1.0)),
    "assigned": assigned,
    "einsum": lambda y: np.einsum("ij,j->i", np.outer(y, y), y),
    "where": lambda y: np.where(y > 0.0, y, 2.0 * y) + np.maximum(y, 5.0) + np.minimum(y * y, y - 9.0) + np.abs(y),
    "norm": lambda y: y / np.linalg.norm(y) + np.dot(np.outer(y, y), y),
    "powers": lambda y: (y**2) ** 1.5 + (1.0 + y**2) ** -2.0 + 2.0**y + (y**2) ** np.array([1.0, 2, 3, 0.5, -1, 0]),
}


@pytest.mark.parametrize("radius", [0.0, 1e-9, 1e-3, 1e-2])
@pytest.mark.parametrize("name", RESIDUALS)
def test_a_residual_in_plain_numpy_runs_on_boxes_as_on_jets_and_holds_every_point(name, radius):
    f = RESIDUALS[name]
    value, slope = enclose(f, X - radius, X + radius), jacobian(f, X - radius, X + radius)
    assert (value.hi - value.lo <= 2e3 * radius + 1e-12).all()
    assert (slope.hi - slope.lo <= 2e4 * radius + 1e-11).all()
    for x in X + radius * RNG.uniform(-1.0, 1.0, (10, 6)):
        image, slopes = np.asarray(f(x), dtype=float), jets.jacobian(f, x)
        for box, exact, digits in ((value, image, 1e-14), (slope, slopes, 1e-12)):
            # Of the plain evaluation and of the jets, which round; the widest box holds that, too.
            slack = digits * (1.0 + np.abs(exact)) * (radius < 1e-2)
            assert ((box.lo <= exact + slack) & (exact - slack <= box.hi)).all()


@pytest.mark.parametrize("seed", range(3))
def test_sums_and_products_of_matrices_hold_the_exact_ones(seed):
    rng = np.random.default_rng(seed)
    a, x = rng.normal(size=(4, 30)) * 10.0 ** rng.uniform(-9, 9, (4, 30)), rng.normal(size=30)
    a[:, 15:] = -a[:, :15] * (1.0 + 1e-15 * rng.normal(size=(4, 15)))  # cancels
    exact = [sum((Fraction(p) * Fraction(q) for p, q in zip(row, x.tolist())), Fraction(0)) for row in a.tolist()]
    for image in (a @ Interval(x), sp.csr_array(a) @ Interval(x), np.einsum("ij,j->i", a, Interval(x))):
        ends = zip(image.lo.tolist(), exact, image.hi.tolist())
        assert all(Fraction(lo) <= value <= Fraction(hi) for lo, value, hi in ends)
    total = np.sum(Interval(a), axis=1)
    assert all(
        Fraction(lo) <= sum(map(Fraction, row.tolist()), Fraction(0)) <= Fraction(hi)
        for lo, row, hi in zip(total.lo, a, total.hi)
    )


@pytest.mark.parametrize(
    ("f", "ends", "lo", "hi"),
    [
        (np.sin, (1.0, 2.0), (0.8, 0.9), 1.0),
        (np.cos, (3.0, 3.3), -1.0, (-0.99, -0.98)),
        (np.cos, (-0.1, 0.2), (0.98, 0.99), 1.0),
        (np.sin, (1e17, 1e17), -1.0, 1.0),
        (np.cosh, (-1.0, 2.0), 1.0, (3.7, 3.8)),
        (lambda y: y**2, (-1.0, 2.0), 0.0, (4.0, 4.1)),
        (lambda y: y * y, (-1.0, 2.0), 0.0, (4.0, 4.1)),
        (lambda y: y**3, (-1.0, 2.0), (-1.1, -1.0), (8.0, 8.1)),
    ],
)
def test_extrema_inside_and_arguments_far_away(f, ends, lo, hi):
    """An end is exactly a number, or between two."""
    image = f(Interval(*ends))
    for end, (low, high) in ((image.lo, np.resize(lo, 2)), (image.hi, np.resize(hi, 2))):
        assert low <= end <= high


UNDEFINED = {
    "division": lambda y: 1.0 / y,
    "logarithm": np.log,
    "root": np.sqrt,
    "pole": lambda y: np.tan(y + np.pi / 2),
    "power": lambda y: y**0.5,
    "negative power": lambda y: y**-2,
    "overflow": lambda y: np.exp(1e6 * (y + 2.0)),
}


@pytest.mark.parametrize("name", UNDEFINED)
def test_what_is_not_defined_on_a_box_says_nothing_and_stays_so(name):
    box = Interval(-0.5, 0.5)
    image = UNDEFINED[name](box)
    for later in (
        image,
        np.arctan(image),
        image * 0.0,
        np.maximum(image, 1.0),
        image**0,
        np.tanh(image),
        image - image,
    ):
        assert np.isnan(later.lo) or np.isnan(later.hi)
        assert np.isnan(later)


def test_a_kink_has_the_slopes_of_both_sides():
    slope = jacobian(lambda y: np.abs(y) + np.maximum(y, 0.0), np.array([-1.0]), np.array([1.0]))
    assert slope.lo[0, 0] <= -1.0
    assert 2.0 <= slope.hi[0, 0] < 2.1
    with pytest.raises(UndecidedError, match="not decided"):
        enclose(lambda y: np.where(y > 0.0, y, 0.0), np.array([-1.0]), np.array([1.0]))


PAIR = Interval(np.zeros(2), np.ones(2))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: np.floor(PAIR), r"numpy\.floor"),
        (lambda: np.sort(PAIR), r"numpy\.sort"),
        (lambda: np.asarray(PAIR), "drop its width"),
        (lambda: float(PAIR[0]), "drop its width"),
        (lambda: Interval(1.0, 0.0), "lo <= hi"),
    ],
)
def test_what_cannot_be_done_says_so(call, words):
    with pytest.raises((TypeError, ValueError), match=words):
        call()
