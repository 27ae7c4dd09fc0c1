"""Paths of random piecewise linear maps: on the map, no kink missed, and none left the way that the path came."""

from itertools import pairwise

import numpy as np
import pytest

from continuation import Budget, Monitor, Status, trace

from .util import Folded

ENDS = Status.STOPPED_AT_EVENT, Status.BUDGET_EXHAUSTED, Status.UNRESOLVED_KINK, Status.DEAD_END, Status.CLOSED
FAR = Monitor(lambda u, v: float(np.abs(u).max()) - 1e4, "far", terminal=1)


def unit(v):
    return v / np.linalg.norm(v)


def within(*points):
    """Round-off of the map at points."""
    return 1e-13 * (10.0 + 10.0 * np.abs(points).max())


@pytest.mark.parametrize(("n", "m"), [(1, 2), (2, 3), (2, 6), (3, 5)])
def test_kinks_are_passed_one_by_one(n, m):
    generator, passed = np.random.default_rng(10 * n + m), 0
    for _ in range(25):
        case = Folded.random(generator, n, m)
        path = trace(case, direction=1, budget=Budget(steps=100), events=[FAR])
        if path.status is Status.SINGULAR_START:
            continue
        assert path.status in ENDS
        # A path goes on from where one switch alone vanishes.
        assert path.status not in (Status.UNRESOLVED_KINK, Status.DEAD_END) or len(path.kinks[-1].switches) > 1, case
        for step in path.steps:
            assert np.abs(case.residual(step.y, step.lam)).max() <= within(step.u), case
        # Between two points switches are linear.
        for a, b in pairwise(path.steps):
            before, after = case.switches(a.y, a.lam), case.switches(b.y, b.lam)
            assert (before * after >= -within(a.u, b.u) * np.maximum(abs(before), abs(after))).all(), case
        for kink in path.kinks:
            assert np.abs(case.switches(kink.y, kink.lam)).min() <= within(kink.u)
            back, *onward = path.u[kink.step - 1 : kink.step + 2 : 2] - kink.u
            assert all(unit(back) @ unit(way) < 1.0 - 1e-9 for way in onward), case
            passed += len(onward)
    assert passed >= 15
