"""What an audit finds: branches switched in silence, events that are missing or invented."""

import numpy as np
import pytest
from attrs import evolve

from continuation import BranchPoint, Kind, audit, from_functions, trace


def graph(c, lam):
    return c[0] * lam + c[1] * lam**2 / 2.0 + c[2] * 0.3 * (np.sin(2.0 * lam) - 2.0 * lam)


def slope(c, lam):
    return c[0] + c[1] * lam + c[2] * 0.6 * (np.cos(2.0 * lam) - 1.0)


def two_graphs(a, b):
    """Two curves y = f(c, lam) that cross at lam = 0, as one homotopy; it starts on the first."""
    return from_functions(
        lambda y, lam: np.stack([(y[0] - graph(a, lam)) * (y[0] - graph(b, lam))]),
        lambda y, lam: (
            np.array([[2.0 * y[0] - graph(a, lam) - graph(b, lam)]]),
            np.array([-slope(a, lam) * (y[0] - graph(b, lam)) - slope(b, lam) * (y[0] - graph(a, lam))]),
        ),
        start=([graph(a, -1.5)], -1.5),
    )


def switched(seed):
    """A path that goes from the first graph to the second where they cross, and says nothing of it."""
    rng = np.random.default_rng(seed)
    a = rng.normal(0.0, 1.0, 3)
    b = a + rng.uniform(0.1, 0.3) * np.array([1.0, *rng.uniform(-0.5, 0.5, 2)])
    homotopy = two_graphs(a, b)
    path, other = trace(homotopy, target=1.5), trace(two_graphs(b, a), target=1.5)
    assert path.success
    assert [event.kind for event in path.events] == [Kind.BRANCH_POINT]
    assert audit(homotopy, path).same
    steps = [step for step in path.steps if step.lam < 0.0]
    steps += [evolve(step, index=len(steps) + k) for k, step in enumerate(s for s in other.steps if s.lam > 0.0)]
    path.steps[:], path.events[:] = steps, []
    return homotopy, path


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_a_branch_switched_in_silence(seed, backwards):
    homotopy, path = switched(seed)
    found = audit(homotopy, path, backwards=backwards)
    assert not found.same
    assert found.first is not None
    assert (path.steps[found.first].lam > 0.0) is not backwards


def test_a_branch_point_that_the_path_does_not_have():
    homotopy = two_graphs((1.0, 0.2, 0.1), (0.7, 0.1, 0.3))
    path = trace(homotopy, target=1.5)
    assert str(audit(homotopy, path)).endswith("with 0 turning points and 1 branch points.")
    events = list(path.events)
    path.events[:] = []
    found = audit(homotopy, path)
    assert not found.same
    assert "1 branch points instead of 0" in str(found)
    path.events[:] = 2 * events
    assert not audit(homotopy, path).same


def test_one_on_which_the_path_ends():
    homotopy = two_graphs((1.0, 0.2, 0.1), (0.7, 0.1, 0.3))
    path = trace(homotopy, target=1.5, events=[BranchPoint(terminal=1)])
    assert path.endpoint.lam == pytest.approx(0.0, abs=1e-12)
    for backwards in (False, True):
        assert audit(homotopy, path, backwards=backwards).same
