"""The loop that every contracting iteration shares: when it is done, when it is given up, and what it has come to."""

import numpy as np
import pytest

from continuation.arrays import largest
from continuation.contraction import Contraction, Iteration

APART = Contraction(20, ratio=0.3, first=0.9)


@pytest.mark.parametrize(
    ("ratios", "rule", "done", "count", "stalled", "x", "worst"),
    [
        # Done with a small increment, which is added; one that does not shrink is not.
        ([0.1] * 6, Contraction(20), True, 7, False, 1.111111, 0.1),
        ([0.4, 0.6], Contraction(20), False, 3, True, 1.4, 0.6),
        # The first ratio may have a limit of its own.
        ([0.8, 0.2, 0.4], APART, False, 4, True, 1.96, 0.8),
        ([0.8, 0.8], APART, False, 3, True, 1.8, 0.8),
        ([0.95], APART, False, 2, True, 1.0, 0.95),
        # Ratios below the noise are not looked at.
        ([0.1, 5.0, 0.1, 1e-6], Contraction(20, noise=0.6), True, 5, False, 1.65, 0.0),
        ([0.49] * 9, Contraction(4), False, 4, False, 1.847749, 0.49),
    ],
)
def test_when_it_ends_and_what_it_has_come_to(ratios, rule, done, count, stalled, x, worst):
    sizes = iter(np.cumprod([1.0, *ratios]))
    iteration = Iteration(np.zeros(2), rule)
    assert iteration.run(lambda: np.full(2, next(sizes)), largest, lambda size: size <= 1.5e-6) == done
    assert (iteration.count, iteration.stalled) == (count, stalled)
    assert iteration.x == pytest.approx(np.full(2, x), abs=1e-6)
    assert iteration.worst == pytest.approx(worst)
