"""Brown's almost linear function by the fixed-point homotopy: the root, and the length of the path."""

import numpy as np
import pytest

from continuation import Status, trace
from continuation import arclength as length
from problems.nonlinear import brown, fixed_point

from ..util import every_preset

LENGTHS = {5: 2.7114077076, 10: 3.7199286259, 20: 5.1259069338, 30: 6.1886027468}


def from_zero(n):
    F = brown(n)
    return fixed_point(F, np.zeros(n), F.jacobian)


@every_preset
@pytest.mark.parametrize("n", LENGTHS)
def test_the_root_and_the_length(n, preset):
    path = trace(from_zero(n), preset=preset)
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(path.endpoint.y, np.ones(n), rtol=0, atol=1e-9)
    # Six digits are promised, the tables have eleven.
    assert length(from_zero(n), path) == pytest.approx(LENGTHS[n], abs=1e-9)
