"""Brown's almost linear function by the fixed-point homotopy: the root, and the length of the path."""

import numpy as np
import pytest

from continuation import Status, trace
from continuation.auditing.length import arclength
from problems.nonlinear import brown, fixed_point, newton

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
    assert arclength(from_zero(n), path) == pytest.approx(LENGTHS[n], abs=1e-9)


def test_without_a_jacobian_the_path_is_the_same():
    plain = trace(fixed_point(brown(5), np.zeros(5)))
    assert plain.status is Status.REACHED_TARGET
    np.testing.assert_allclose(plain.endpoint.y, trace(from_zero(5)).endpoint.y, rtol=0, atol=1e-12)


def test_the_newton_homotopy_finds_it_too():
    F = brown(5)
    path = trace(newton(F, np.full(5, 0.8), F.jacobian))
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(F(path.endpoint.y), 0.0, rtol=0, atol=1e-10)
