"""Maps some of whose pieces do not exist, and pieces that have factors of their own."""

from types import SimpleNamespace

import attrs
import numpy as np
import pytest

from continuation import Monitor, Status
from continuation.linear import factor_bordered

from ...util import path_of

OFF = Monitor(lambda u, v: float(np.abs(u).max()) - 50.0, "off", terminal=1)
ROWS = np.array([[1.0, 1.0], [-1.0, 1.0], [1.5, 0.5]])


def row(a, **more):
    """One linear function, with factors of its own."""
    return SimpleNamespace(
        start=lambda: (np.array([1.0]), -3.0),
        residual=lambda y, lam: np.array([a @ np.append(y, lam)]),
        bordered=lambda y, lam, border: factor_bordered(a[None, :1], a[1:], border),
        **more,
    )


def applied(a):
    """And with a differential."""
    return row(a, differential=lambda y, lam, v: np.array([a @ v]))


@attrs.frozen
class Largest:
    """The largest of three linear functions of (y, lam) is 0: pieces by order, some of which there are not."""

    make: object
    target: float | None = None

    def start(self):
        return np.array([1.0]), -3.0

    def residual(self, y, lam):
        return np.array([(ROWS @ np.append(y, lam)).max()])

    def switches(self, y, lam):
        parts = np.stack([a * y[0] + b * lam for a, b in ROWS])
        return parts - np.roll(parts, -1)

    def piece(self, signs):
        if abs(signs.sum()) == 3:
            raise ValueError("signs: expected an order, found a circle")
        # The largest is the one that neither of its two switches puts below another.
        return self.make(ROWS[next(k for k in range(3) if signs[k] > 0 > signs[k - 1])])


@pytest.mark.parametrize("make", [row, applied])
def test_pieces_that_are_not_there_are_left_out(make):
    largest = Largest(make)
    path = path_of(largest, direction=1, events=[OFF], status=Status.STOPPED_AT_EVENT)
    (kink,) = path.kinks
    assert (kink.switches, len(kink.rays)) == ((0, 1, 2), 2)
    assert max(abs(largest.residual(ray[:1], ray[1])[0]) for ray in kink.rays) < 1e-14
