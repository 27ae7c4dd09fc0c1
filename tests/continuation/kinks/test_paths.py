"""Paths of piecewise linear maps: kinks as exact arithmetic has them, none missed and no wrong branch."""

from fractions import Fraction

import numpy as np
import pytest

from continuation import Budget, Monitor, Status, trace

from .util import Folded

MOST = 8
ENDS = Status.STOPPED_AT_EVENT, Status.BUDGET_EXHAUSTED, Status.UNRESOLVED_KINK, Status.DEAD_END, Status.CLOSED
FAR = Monitor(lambda u, v: float(np.abs(u).max()) - 1e4, "far", terminal=1)


def exact_path(case):
    """The first direction and the kinks up to the first that is no simple one; None where it does not begin well."""
    values = case.values(case.at)
    if not all(values):
        return None
    v = case.kernel([1 if value > 0 else -1 for value in values])
    if not v[-1]:
        return None
    v = [x if v[-1] > 0 else -x for x in v]
    return case.kinks([Fraction(x) for x in case.at], v, MOST)


@pytest.mark.parametrize(("n", "m"), [(1, 2), (2, 3), (2, 6), (3, 5)])
def test_kinks_are_those_of_exact_arithmetic(n, m):
    generator = np.random.default_rng(10 * n + m)
    compared = 0
    for _ in range(25):
        case = Folded.random(generator, n, m)
        wanted = None if any(not any(row) for row in case.G) else exact_path(case)
        if not wanted:
            continue
        path = trace(case, direction=1, budget=Budget(steps=100), events=[FAR])
        found = np.array([kink.u for kink in path.kinks[: len(wanted)]])
        exact = np.array([[float(x) for x in u] for u in wanted])
        assert found.shape == exact.shape, (case, path)
        assert np.abs(found - exact).max() <= 1e-13 * max(1.0, np.abs(exact).max()), case
        assert path.status in ENDS
        compared += len(wanted)
    assert compared >= 15
