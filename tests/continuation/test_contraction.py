"""The loop that every contracting iteration shares: when it is done, when it is given up, and what it has come to."""

import numpy as np
import pytest

from continuation.arrays import largest
from continuation.contraction import Contraction, Iteration


def run(ratios, rule, enough=1.5e-6, first=1.0):
    """Increments of given ratios, as an iteration would make them."""
    sizes = iter(np.cumprod([first, *ratios]))
    iteration = Iteration(np.zeros(2), rule)
    done = iteration.run(lambda: np.full(2, next(sizes)), largest, lambda size: size <= enough)
    return iteration, done


def test_it_is_done_with_a_small_increment_which_is_added():
    iteration, done = run([0.1] * 6, Contraction(20))
    assert done
    assert iteration.count == 7
    assert iteration.x == pytest.approx(np.full(2, 1.111111))
    assert iteration.worst == pytest.approx(0.1)


def test_an_increment_that_does_not_shrink_is_not_added():
    iteration, done = run([0.4, 0.6], Contraction(20))
    assert not done
    assert iteration.stalled
    assert (iteration.count, iteration.size) == (3, 0.4)
    assert iteration.x == pytest.approx(np.full(2, 1.4))
    assert iteration.worst == pytest.approx(0.6)


def test_the_first_ratio_may_have_a_limit_of_its_own():
    rule = Contraction(20, ratio=0.3, first=0.9)
    iteration, _ = run([0.8, 0.2, 0.4], rule)
    assert (iteration.count, iteration.stalled) == (4, True)
    assert run([0.8, 0.8], rule)[0].count == 3
    assert run([0.95], rule)[0].count == 2


def test_ratios_below_the_noise_are_not_looked_at():
    iteration, done = run([0.1, 5.0, 0.1, 1e-6], Contraction(20, noise=0.6))
    assert done
    assert iteration.worst == 0.0


def test_it_ends_after_so_many_increments():
    iteration, done = run([0.49] * 9, Contraction(4))
    assert not done
    assert not iteration.stalled
    assert iteration.count == 4


def test_what_it_has_come_to_survives_an_increment_that_raises():
    iteration = Iteration(np.zeros(1), Contraction(5))
    sizes = iter([1.0, 0.25])

    def increment():
        return np.array([next(sizes)])

    with pytest.raises(StopIteration):
        iteration.run(increment, largest, lambda size: False)
    assert iteration.x == pytest.approx([1.25])
    assert iteration.count == 2
