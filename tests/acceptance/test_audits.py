"""The audit, which traces with other steps and backwards, agrees with the path."""

import numpy as np
import pytest

from continuation import TargetValue, TurningPoint, trace
from continuation.auditing import audit
from problems.bifurcation import Aircraft, Bratu1D, Circle, Cusp, ExponentialCosine, FreudensteinRoth
from problems.nonlinear import brown, fixed_point
from tests.truth import aircraft

PATHS = {
    "circle": (Circle(), {}),
    "cusp": (Cusp(), {}),
    "Freudenstein-Roth": (FreudensteinRoth(), {}),
    "Brown": (fixed_point(brown(10), np.zeros(10), brown(10).jacobian), {}),
    **{f"exponential-cosine {n}": (ExponentialCosine(n), {}) for n in (3, 8)},
    "Bratu": (Bratu1D(200), {"events": [TargetValue(1.0, direction=-1)]}),
    **{
        f"aircraft {e}": (
            Aircraft(e),
            {"direction": -1, "events": [TurningPoint(terminal=len(aircraft.limit_points(e)))]},
        )
        for e in aircraft.ELEVATORS
    },
}


# Backwards from a turning point in which the path was stopped there are two ways.
CASES = [*((name, False) for name in PATHS), *((name, True) for name in PATHS if "aircraft" not in name)]


@pytest.mark.parametrize(("name", "backwards"), CASES)
def test_the_audit_agrees(name, backwards):
    homotopy, options = PATHS[name]
    found = audit(homotopy, trace(homotopy, **options), backwards=backwards)
    assert found.same, found
