"""What a homotopy's own `max_step` and `finish` may return, and buffers that a homotopy may reuse."""

import numpy as np
import pytest

from continuation import Status, check_jacobian, homotopy, trace
from continuation.predictors import Hermite, Taylor
from continuation.step.capabilities import interior_fraction, max_step_of
from problems.bifurcation import FreudensteinRoth

from ...util import every_preset


@pytest.mark.parametrize("name", ["Bordered", "Events", "Jacobian", "MaxStep", "Metric", "Pieces"])
def test_what_is_offered_is_what_isinstance_says(name):
    protocol = getattr(homotopy, f"Supports{name}")
    parts = [Straight(), Straight(jacobian=None), Straight(switches=len), Straight(switches=len, piece=len)]
    for part in (*parts, Straight(events=()), Straight(max_step=len), FreudensteinRoth()):
        assert homotopy.offers(part, protocol) == isinstance(part, protocol)


class Straight:
    """y = lam, from 0 to 1, with capabilities given as arguments."""

    target = 1.0

    def __init__(self, **capabilities):
        self.__dict__.update(capabilities)

    def start(self):
        return np.zeros(1), 0.0

    def residual(self, y, lam):
        return y - lam


def test_a_max_step_of_zero_ends_the_path():
    assert trace(Straight(max_step=lambda u, v: 0.0)).status is Status.STEP_TOO_SMALL


def test_a_direction_that_overflows_has_no_room():
    room = max_step_of(Straight(max_step=lambda u, v: float(v @ u) * np.nan))
    assert room(np.ones(2), np.array([np.inf, 1.0])) == 0.0


@pytest.mark.parametrize("end", [np.array([np.nan]), np.ones(3), "a", 1j * np.ones(1)])
def test_a_finish_that_gives_no_point_is_named(end):
    with pytest.raises(ValueError, match="finish: expected"):
        trace(Straight(finish=lambda y, lam: end))


def test_a_finish_is_believed_where_the_equations_hold_and_its_residual_is_said():
    path = trace(Straight(finish=lambda y, lam: np.ones(1) + 1e-12))
    assert path.status is Status.REACHED_TARGET
    assert len(path) == 3
    assert path.message.endswith(f"the residual of H there is {path.endpoint.residual_norm:.1e}.")


@pytest.mark.parametrize("off", [7.0, -1.5, 1e300])
def test_a_finish_whose_end_does_not_solve_the_equations_is_refused(off):
    with pytest.raises(ValueError, match=r"^finish: expected None or an end of the path, found a point where H is "):
        trace(Straight(finish=lambda y, lam: y + off))


def test_a_predictor_says_how_near_to_the_boundary_it_may_go():
    assert interior_fraction(Taylor()) == 0.9999
    # A polynomial only continues what is past.
    assert interior_fraction(Hermite()) == 0.9


class OneBuffer:
    """A homotopy that returns the same arrays every time."""

    def __init__(self, homotopy, jacobian):
        self.plain, self.target = homotopy, homotopy.target
        self.kept = [np.empty(2), np.empty((2, 2)), np.empty(2)]
        if jacobian:
            self.jacobian = self._jacobian

    def start(self):
        return self.plain.start()

    def residual(self, y, lam):
        self.kept[0][:] = self.plain.residual(y, lam)
        return self.kept[0]

    def _jacobian(self, y, lam):
        self.kept[1][...], self.kept[2][...] = self.plain.jacobian(y, lam)
        return self.kept[1], self.kept[2]


@every_preset
def test_a_homotopy_may_reuse_its_arrays(preset):
    path = trace(OneBuffer(FreudensteinRoth(), jacobian=True), preset=preset)
    np.testing.assert_array_equal(path.u, trace(FreudensteinRoth(), preset=preset).u)


def test_a_residual_that_reuses_its_array_has_derivatives():
    """By differences: jets and complex numbers do not fit into an array of floats."""
    homotopy = OneBuffer(FreudensteinRoth(), jacobian=False)
    path = trace(homotopy)
    assert path.status is Status.REACHED_TARGET
    assert len(path.turning_points) == 2
    assert check_jacobian(OneBuffer(FreudensteinRoth(), jacobian=True)).correct
