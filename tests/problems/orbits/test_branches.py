"""What leaves an orbit's branch, and what lies on it: doublings, tori, Hopf points; curves in a second parameter."""

import numpy as np
import pytest

import continuation
from continuation import Curve, Family, Kind
from problems.orbits import PeriodicOrbit
from problems.orbits.models import brusselator, normal_form

from ...util import path_of


def test_a_branch_leads_from_the_hopf_point_of_a_path_of_equilibria():
    equilibria = continuation.from_functions(brusselator, start=([1.0, 1.5], 1.5), target=2.5)
    path = continuation.trace(equilibria, observers=[continuation.Stability()])
    (hopf,) = (event for event in path.events if event.kind == Kind.HOPF)
    orbit = PeriodicOrbit.from_hopf(brusselator, hopf, radius=1e-3)
    assert orbit.period == pytest.approx(2.0 * np.pi, abs=1e-6)
    assert orbit.parameter > 2.0
    back = continuation.trace(orbit, start=(np.append(*orbit.start()), -orbit.leaving[1]))
    assert back.events[-1].name == "Hopf point"
    assert back.events[-1].lam == pytest.approx(2.0, abs=1e-6)


def test_the_curve_of_folds_of_cycles():
    """p = -second^2 / 4."""
    orbit = PeriodicOrbit.from_hopf(normal_form, ([0.0, 0.0], 0.0), intervals=10, second=1.0)
    fold = continuation.trace(orbit, start=orbit.leaving, events=[continuation.TurningPoint(terminal=1)]).events[-1]
    finer = PeriodicOrbit.from_orbit(orbit, fold, intervals=24)
    assert finer.parameter == pytest.approx(-0.25, abs=1e-12)
    curve = path_of(Curve(Family(orbit, "second"), fold), target=0.5)
    for step in curve.steps:
        assert step.u[-2] == pytest.approx(-0.25 * step.lam**2, abs=1e-11)
