"""The bifurcation problems: what they do with wild iterates.

That they keep the promises of the protocol, their derivatives among them, is shown in test_conformance; that their
curves and limit points are those in closed form or published, in the acceptance tests.
"""

import pytest

from problems.bifurcation import (
    Aircraft,
)


def test_aircraft_without_an_equilibrium_near_level_flight_says_so(monkeypatch):
    monkeypatch.setattr("problems.bifurcation.aircraft._NEWTON_STEPS", 1)
    with pytest.raises(ArithmeticError, match=r"elevator = 0\.1: no equilibrium at aileron 0"):
        Aircraft(elevator=0.1).start()
