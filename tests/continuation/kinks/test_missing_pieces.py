"""Maps some of whose pieces do not exist, and pieces that have factors of their own."""

import attrs
import numpy as np
import pytest

from continuation import Monitor, Status, trace
from continuation.linear import factor_bordered

OFF = Monitor(lambda u, v: float(np.abs(u).max()) - 50.0, "off", terminal=1)


@attrs.frozen
class Largest:
    """max(a, b, c) = 0 for three linear functions of (y, lam): pieces by order, some of which there are not."""

    rows: tuple = ((1.0, 1.0), (-1.0, 1.0), (1.5, 0.5))
    hidden: tuple = ()
    target: float | None = None

    def start(self):
        return np.array([1.0]), -3.0

    def parts(self, y, lam):
        return [a * y[0] + b * lam for a, b in self.rows]

    def residual(self, y, lam):
        return np.array([max(self.parts(y, lam))])

    def switches(self, y, lam):
        p, q, r = self.parts(y, lam)
        return np.stack([p - q, q - r, r - p])

    def piece(self, signs):
        if abs(signs.sum()) == 3:
            raise ValueError("signs: expected an order, found a circle")
        # The largest is the one that neither of its two switches puts below another.
        k = next(k for k in range(3) if signs[k] > 0 > signs[k - 1])
        return Row(self.rows[k], "differential" not in self.hidden)


class Row:
    """One of them, with factors of its own, and with a differential or without."""

    def __init__(self, row, differential):
        self.row = np.array(row)
        if differential:
            self.differential = lambda y, lam, v: np.array([self.row @ v])

    def start(self):
        return np.array([1.0]), -3.0

    def residual(self, y, lam):
        return np.array([self.row @ np.append(y, lam)])

    def bordered(self, y, lam, border):
        return factor_bordered(self.row[None, :1], self.row[1:], border)


@pytest.mark.parametrize("hidden", [(), ("differential",)], ids=["applied", "factored only"])
def test_pieces_that_are_not_there_are_left_out(hidden):
    largest = Largest(hidden=hidden)
    path = trace(largest, direction=1, events=[OFF])
    (kink,) = path.kinks
    assert kink.switches == (0, 1, 2)
    assert len(kink.rays) == 2
    for ray in kink.rays:
        parts = largest.parts(ray[:1], ray[1])
        assert abs(max(parts)) < 1e-14
    assert path.status is Status.STOPPED_AT_EVENT
