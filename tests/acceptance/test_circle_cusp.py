"""The circle closes after one turn; the cusp's folds are where algebra puts them."""

import numpy as np
import pytest

from continuation import Status, trace
from continuation import arclength as length
from problems.bifurcation import Circle, Cusp

from ..util import every_preset


@every_preset
@pytest.mark.parametrize("direction", [-1, 1])
def test_the_circle_closes_after_one_turn(preset, direction):
    path = trace(Circle(), preset=preset, direction=direction)
    assert path.status is Status.CLOSED
    np.testing.assert_allclose(path.endpoint.u, (1.0, 0.0), rtol=0, atol=1e-12)
    folds = [event.u for event in path.turning_points]
    np.testing.assert_allclose(folds, [(0.0, direction), (0.0, -direction)], rtol=0, atol=1e-12)
    assert length(Circle(), path) == pytest.approx(2.0 * np.pi, rel=1e-10)


@every_preset
@pytest.mark.parametrize("splitting", [1.0, 0.003, 0.01, 0.0324, 0.07, 30.0])
def test_both_folds_of_the_cusp(preset, splitting):
    path = trace(Cusp(splitting), preset=preset)
    x = np.sqrt(splitting / 3.0)
    mu = 2.0 / 3.0 * splitting * x
    assert path.status is Status.REACHED_TARGET
    folds = [event.u for event in path.turning_points]
    np.testing.assert_allclose(folds, [(-x, mu), (x, -mu)], rtol=1e-12, atol=1e-13)
    # The published digits of lambda = 1.
    if splitting == 1.0:
        assert folds[0][1] == pytest.approx(0.3849001794597505, abs=1e-14)
