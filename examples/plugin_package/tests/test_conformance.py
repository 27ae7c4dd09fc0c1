"""The conformance suite of `continuation`, one test a check, and what this truss is known to do."""

import numpy as np
import pytest
from snapthrough import VonMisesTruss

import continuation
from continuation.testing import homotopy_checks


@pytest.mark.parametrize("check", homotopy_checks(VonMisesTruss()), ids=str)
def test_conformance(check):
    check()


@pytest.mark.parametrize("rise", [0.1, 0.3, 0.5])
def test_it_snaps_through_at_the_loads_of_the_closed_form(rise):
    truss = VonMisesTruss(rise, target=rise**3)
    path = continuation.trace(truss)
    assert path.status is continuation.Status.REACHED_TARGET
    found = [(turn.y[1], turn.lam) for turn in path.turning_points]
    np.testing.assert_allclose(found, truss.turning_points(), atol=1e-9)


def test_a_truss_must_rise():
    with pytest.raises(ValueError, match="rise: expected a positive number, found 0"):
        VonMisesTruss(0)
