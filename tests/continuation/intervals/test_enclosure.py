"""Values, first and second derivatives over boxes hold those at points inside, in 120 digits: every rule."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from continuation import jets
from continuation.intervals import Interval, enclose, jacobian
from continuation.numbers.boxes import along_curve, with_gradient
from continuation.numbers.ends import Ends, thin
from continuation.numbers.series import ELEMENTARY

from .against_mpmath import ONE, inside

DOMAIN = {
    **dict.fromkeys(("arcsin", "arccos", "arctanh"), (-0.95, 0.95)),
    **dict.fromkeys(("sqrt", "log", "log2", "log10", "cbrt", "reciprocal", "absolute"), (0.05, 4.0)),
    "arccosh": (1.05, 5.0),
    "log1p": (-0.9, 4.0),
    "tan": (-1.4, 1.4),
}
WIDTHS = st.sampled_from([0.0, 1e-14, 1e-8, 1e-3, 0.03])
PARTS = st.floats(0.0, 1.0)


def box_around(x, width, part):
    """Ends that hold x."""
    return np.minimum(x, x - width * part), np.maximum(x, x + width * (1.0 - part))


@pytest.mark.parametrize("name", [f.__name__ for f in ELEMENTARY])
@settings(max_examples=25, deadline=None)
@given(place=PARTS, width=WIDTHS, part=PARTS, v=st.floats(-2.0, 2.0), w=st.floats(-2.0, 2.0))
def test_the_series_of_a_function_along_a_curve_is_enclosed(name, place, width, part, v, w):
    low, high = DOMAIN.get(name, (-3.0, 3.0))
    x = low + (high - low) * place
    box, first, second = (Ends(*np.array(box_around(np.array([[y]]), width, part))) for y in (x, v, w))
    image = getattr(np, name)(along_curve(box, first, second)).c
    again, slope = jets.derivative_along(getattr(np, name), with_gradient(box.lo, box.hi), Interval([v]))
    with mp.workdps(120):
        f = mp.taylor(ONE[name], mp.mpf(x), 3)
        curve = [f[0], f[1] * v, f[1] * w + f[2] * mp.mpf(v) ** 2]
        assert inside(image, curve)
        assert inside(again.c, f[:2])
        assert inside(slope.c, [f[1] * v, 2 * f[2] * v])
    told = np.isfinite(image.lo) & np.isfinite(image.hi)
    assert told.all() or width > 0.01  # near an edge of the domain a box is outside of it


EXPRESSIONS = {
    "quotients": lambda y: (y[1:] - 2.0) / (y[:-1] * y[1:] + 1.0) + 3.0 / y[1:] - y[1:] / 7.0,
    "whole powers": lambda y: y**3 - y**-2 + y ** np.array([0.0, 1.0, 4.0, -3.0]),
    "einsum of three": lambda y: np.einsum("i,j,k->jk", y[:3], y[1:], y[::-1])[0],
    "a trace of three": lambda y: np.einsum("ij,jk,ki->", np.outer(y, y), np.outer(y, y + 1.0), np.outer(y, y)) * y,
    "sums": lambda y: y * y + np.prod(y) - np.diff(y, 2)[1] + np.sum(y) / 3.0,
    "products": lambda y: np.outer(y, y) @ y + np.dot(y, y) * np.vdot(y, y),
    "assembly": lambda y: np.where([True, False, True, False], np.stack([y[0], *y[1:]]), np.roll(y, 1)) * np.flip(y),
    "larger": lambda y: np.maximum(y, y[::-1]) * np.minimum(y * y, 3.0 * y) + np.abs(y - 1.5),
    "square": lambda y: (y - y[0]) * (y - y[0]) + np.square(y - 1.0),
}


@pytest.mark.parametrize("name", EXPRESSIONS)
@settings(max_examples=15, deadline=None)
@given(x=st.lists(st.floats(0.25, 2.5), min_size=4, max_size=4), width=WIDTHS, part=PARTS, v=st.floats(-1.0, 1.0))
def test_the_slopes_of_an_expression_are_enclosed(name, x, width, part, v):
    f, directions = EXPRESSIONS[name], np.array([v, 1.0, -0.5, 0.25])
    lo, hi = box_around(np.array(x), width, part)
    curve = along_curve(Ends(lo[None], hi[None]), thin(directions[None]), thin(np.zeros((1, 4))))
    value, slopes, along = enclose(f, lo, hi), jacobian(f, lo, hi), f(curve).c
    changed = jets.derivative_along(f, with_gradient(lo[None], hi[None]), Interval(directions))[1]
    with mp.workdps(120):
        h, room, at = mp.mpf(10) ** -30, mp.mpf(10) ** -40, [mp.mpf(entry) for entry in x]
        v = [mp.mpf(entry) for entry in directions.tolist()]

        def moved(*steps):
            entries = np.array([a + sum(h * s[k] for s in steps) for k, a in enumerate(at)], dtype=object)
            return np.asarray(f(entries), dtype=object).ravel().tolist()

        kinks = [abs(a - b) for a in at for b in (*at[::-1], mp.mpf(1.5), mp.mpf(3)) if a is not b]
        if name == "larger" and min(kinks) < 1e-3:
            return  # at a kink differences are no derivatives
        units = np.eye(4, dtype=int).tolist()
        here, ahead, behind = moved(), moved(v), moved([-s for s in v])
        assert inside(value.c, here)
        columns = [[(p - q) / (2 * h) for p, q in zip(moved(e), moved([-s for s in e]))] for e in units]
        assert inside(slopes.c, [column[row] for row in range(len(here)) for column in columns], room)
        assert inside(along[2], [(p - 2 * q + r) / (2 * h * h) for p, q, r in zip(ahead, here, behind)], room)
        corners = [[moved([j * s for s in e], [k * s for s in v]) for j in (1, -1) for k in (1, -1)] for e in units]
        mixed = [(p - q - r + s) / (4 * h * h) for column in corners for p, q, r, s in zip(*column)]
        assert inside(changed.c[1:], mixed, room)


def test_where_boxes_do_not_decide_there_is_no_second_derivative():
    box = Ends(np.array([[-1.0, 1.0]]), np.array([[1.0, 2.0]]))
    curve = along_curve(box, thin(np.ones((1, 2))), thin(np.ones((1, 2))))
    for image in (np.abs(curve), np.maximum(curve, -curve)):
        assert np.array_equal(np.isnan(image.c.lo[:, 0]), [[False, False], [False, False], [True, False]])
        assert image.c.lo[1, 0, 0] <= -1.0
        assert image.c.hi[1, 0, 0] >= 1.0


def test_angles_are_decided_box_by_box():
    lo, hi = (
        np.array([[1.0, 1.0], [1.0, -1.0], [1.0, 0.0], [-1.0, -1.0]]),
        np.array([[1.5, 2.0], [2.0, 1.0], [1.5, 1.0], [1.0, -0.5]]),
    )
    boxes = with_gradient(lo, hi)
    image = np.arctan2(boxes[0], boxes[1])
    for k in range(3):
        ends = [np.arctan2(a, b) for a in (lo[k, 0], hi[k, 0]) for b in (lo[k, 1], hi[k, 1])]
        assert image.c.lo[0, k] <= min(ends) <= max(ends) <= image.c.hi[0, k]
    assert np.isnan(image.c.lo[0, 3])  # across the negative axis


def test_products_of_vectors_are_taken_box_by_box():
    lo = np.array([[1.0, -2.0], [0.5, 3.0], [-1.0, 0.0]])
    boxes = with_gradient(lo, lo + 0.1)
    for image in (boxes @ boxes, boxes @ (boxes + np.zeros(2)), np.stack([boxes, boxes]) @ boxes):
        for x in (lo, lo + 0.1):
            value, slopes = (x * x).sum(axis=1), 2.0 * x.T
            ends = image.c.lo.reshape(3, 3, -1)[..., 0], image.c.hi.reshape(3, 3, -1)[..., 0]
            assert ((ends[0][0] <= value) & (value <= ends[1][0])).all()
            assert ((ends[0][1:] <= slopes) & (slopes <= ends[1][1:])).all()


def test_entries_that_are_assigned_stay_between_their_own_ends():
    y = Interval(np.zeros(3))  # both ends are one array
    y[1] = Interval(1.0, 2.0)
    y[2:] += Interval(-1.0, 1.0)
    assert (y.lo <= [0.0, 1.0, -1.0]).all()
    assert (y.hi >= [0.0, 2.0, 1.0]).all()
    assert np.allclose(y.lo, [0.0, 1.0, -1.0], rtol=1e-15, atol=0.0)
    assert np.allclose(y.hi, [0.0, 2.0, 1.0], rtol=1e-15, atol=0.0)
