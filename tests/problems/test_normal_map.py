"""Complementarity problems with a parameter along their kinked paths, against answers from elsewhere."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from continuation import Budget, Kind, Monitor, Status, TargetValue, trace
from problems.lcp.strategies import lcps
from problems.nonlinear import NormalMap, bratu_under_obstacle

from ..util import path_of
from .util import kojima_shindo

PSI = 2.0
FOLD = 8.0 * np.exp(-PSI) * np.arccosh(np.exp(PSI / 2.0)) ** 2
OFF = Monitor(lambda u, v: float(np.abs(u).max()) - 100.0, "off", terminal=1)


def test_bratu_under_an_obstacle_turns_in_a_kink():
    known, errors = {19: 2.969647, 39: 2.973134, 99: 2.974110}, {}
    for n in known:
        path = path_of(bratu_under_obstacle(n, PSI, target=6.0))
        fold, kink = path.events[:2]
        assert (fold.name, fold.kind) == ("turning point", Kind.TURNING_POINT)
        assert (kink.name, kink.switches) == ("turning kink", (n // 2,))
        assert kink.lam == pytest.approx(known[n], abs=1e-6)
        errors[n] = (kink.lam - FOLD) * (n + 1) ** 2
    assert max(errors.values()) / min(errors.values()) == pytest.approx(1.0, abs=1e-3)


def test_kojima_and_shindos_two_solutions_on_one_path():
    problem = NormalMap(lambda x, lam: kojima_shindo(x) + 10.0 * lam, x0=np.zeros(4), lam0=1.0, target=None)
    path = trace(problem, direction=-1, events=[TargetValue(0.0, terminal=0), OFF])
    solutions = [problem.x(event.y) for event in path.events if event.name != "off" and abs(event.lam) < 1e-14]
    assert np.abs(solutions[0] - [1.0, 0.0, 3.0, 0.0]).max() < 1e-13
    # The other one is degenerate: two components of x and F vanish there, and the path has a turning kink in it.
    assert np.abs(solutions[-1] - [np.sqrt(6.0) / 2.0, 0.0, 0.0, 0.5]).max() < 1e-13
    # At lam = 0.3 it goes on in the fold of another piece: the parameter stands still there and turns neither way.
    assert [event.name for event in path.events[:2]] == ["kink", "kink"]


@given(st.sampled_from(("any", "P")), st.data())
def test_paths_end_in_solutions(cls, data):
    problem = data.draw(lcps(cls, st.integers(1, 5)))
    zero, one = np.zeros(problem.n), np.ones(problem.n)
    homotopy = NormalMap.affine(problem.A, problem.q, one, x0=zero, lam0=float(1.5 - problem.q.min()))
    path = trace(homotopy, events=[OFF], budget=Budget(steps=99))
    assert path.status not in (Status.STEP_TOO_SMALL, Status.START_NOT_ON_PATH, Status.BUDGET_EXHAUSTED)
    assert cls == "any" or path.status is Status.REACHED_TARGET
    for step in path.steps:
        x = np.maximum(step.y, 0.0)
        w = problem.w(x) + step.lam
        assert min(x.min(), w.min()) > -1e-7
        assert abs(x @ w) < 1e-6


def test_friction_slips_when_the_bound_is_reached():
    # A block on a spring of stiffness 1, pulled by 2 lam, with friction at most 1 + lam: it slips from lam = 1 on.
    block = NormalMap.affine(
        [[1.0]], [0.0], [-2.0], x0=[0.0], lam0=0.0, lower=-1.0, upper=1.0, lower_rate=-1.0, upper_rate=1.0, target=3.0
    )
    path = trace(block)
    (kink,) = path.kinks
    assert kink.lam == pytest.approx(1.0, rel=1e-15)
    assert block.x(path.endpoint.y, path.endpoint.lam)[0] == pytest.approx(4.0, rel=1e-15)
