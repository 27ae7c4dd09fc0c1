"""What an audit finds: branches switched in silence, events that are missing or invented."""

import numpy as np
import pytest
from attrs import evolve

from continuation import BranchPoint, Kind, audit, refine, trace

from .events.util import two_graphs
from .util import scalar


def graph(c):
    return lambda lam: c[0] * lam + c[1] * lam**2 / 2.0 + c[2] * 0.3 * (np.sin(2.0 * lam) - 2.0 * lam)


# Two curves that cross at lam = 0.
CROSSED = two_graphs(graph((1.0, 0.2, 0.1)), graph((0.7, 0.1, 0.3)), -1.5, 1.5)


@pytest.mark.parametrize(("seed", "backwards"), [(0, False), (1, True), (2, False), (2, True)])
def test_a_branch_switched_in_silence(seed, backwards):
    rng = np.random.default_rng(seed)
    a = rng.normal(0.0, 1.0, 3)
    b = a + rng.uniform(0.1, 0.3) * np.array([1.0, *rng.uniform(-0.5, 0.5, 2)])
    homotopy = two_graphs(graph(a), graph(b), -1.5, 1.5)
    path, other = trace(homotopy), trace(two_graphs(graph(b), graph(a), -1.5, 1.5))
    assert audit(homotopy, path, backwards=backwards).same
    steps = [step for step in path.steps if step.lam < 0.0]
    steps += [evolve(step, index=len(steps) + k) for k, step in enumerate(s for s in other.steps if s.lam > 0.0)]
    path.steps[:], path.events[:] = steps, []
    found = audit(homotopy, path, backwards=backwards)
    assert not found.same
    assert (path.steps[found.first].lam > 0.0) is not backwards


def test_a_branch_point_that_the_path_does_not_have():
    path = trace(CROSSED)
    assert [event.kind for event in path.events] == [Kind.BRANCH_POINT]
    assert str(audit(CROSSED, path)).endswith("with 0 turning points and 1 branch points.")
    events = list(path.events)
    for k, found in ((0, "1 branch points instead of 0"), (2, "1 branch points instead of 2")):
        path.events[:] = k * events
        assert not audit(CROSSED, path).same
        assert found in str(audit(CROSSED, path))


@pytest.mark.parametrize("backwards", [False, True])
def test_one_on_which_the_path_ends(backwards):
    path = trace(CROSSED, events=[BranchPoint(terminal=1)])
    assert path.endpoint.lam == pytest.approx(0.0, abs=1e-12)
    assert audit(CROSSED, path, backwards=backwards).same


def test_a_point_is_refined_from_afar_where_one_factorisation_does_not_serve():
    level = trace(scalar(lambda y, lam: y - 3.0, start=(3.0, 0.0)))
    assert refine(scalar(lambda y, lam: y**3 - 1.0), level, 0.2)[0] == pytest.approx(1.0, rel=1e-13)
