"""What a homotopy's own `max_step` and `finish` may return, and buffers that a homotopy may reuse."""

import numpy as np
import pytest

from continuation import Status, check_jacobian, trace
from continuation.controllers import AllgowerGeorg, Bounds, Fixed
from continuation.predictors import Tangent
from continuation.step.capabilities import max_step_of
from problems.bifurcation import FreudensteinRoth

from ...util import every_preset, path_of


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


@pytest.mark.parametrize("controller", [AllgowerGeorg(), Fixed(Bounds(initial=0.5), max_angle=np.inf)], ids=repr)
def test_a_path_comes_up_to_its_boundary_and_no_farther(controller):
    """Along a tangent it is farther to y = 1 than along y = lam^2: a correction may lead beyond it."""

    def room(u, v):
        return (1.0 - u[0]) / v[0] if v[0] > 0.0 else np.inf

    homotopy = Straight(residual=lambda y, lam: y - lam**2, target=2.0, max_step=room)
    path = path_of(homotopy, predictor=Tangent(), controller=controller, status=Status.STEP_TOO_SMALL)
    assert 0.999 < path.endpoint.y[0] == path.y.max() <= 1.0


def test_a_direction_that_overflows_has_no_room():
    room = max_step_of(Straight(max_step=lambda u, v: float(v @ u) * np.nan))
    assert room(np.ones(2), np.array([np.inf, 1.0])) == 0.0


@pytest.mark.parametrize("end", [np.array([np.nan]), np.ones(3), "a", 1j * np.ones(1)])
def test_a_finish_that_gives_no_point_is_named(end):
    with pytest.raises(ValueError, match="finish: expected"):
        trace(Straight(finish=lambda y, lam: end))


@pytest.mark.parametrize("unit", [1.0, 1e8, 1e-8])
def test_a_finish_is_believed_where_the_equations_hold_and_its_residual_is_said(unit):
    path = trace(Straight(residual=lambda y, lam: unit * (y - lam), finish=lambda y, lam: np.ones(1) + 1e-12))
    assert (path.status, len(path), path.counts.accepted) == (Status.REACHED_TARGET, 3, 2)
    assert path.message.endswith(f"the residual of H there is {path.endpoint.residual_norm:.1e}.")
    assert path.arclength[-1] > path.arclength[-2]


@pytest.mark.parametrize(("off", "unit"), [(7.0, 1.0), (-1.5, 1e8), (-1.5, 1e-8), (1e300, 1.0)])
def test_a_finish_whose_end_does_not_solve_the_equations_is_refused(off, unit):
    with pytest.raises(ValueError, match=r"^finish: expected None or an end of the path, found a point where H is "):
        trace(Straight(residual=lambda y, lam: unit * (y - lam), finish=lambda y, lam: y + off))


class OneBuffer:
    """A homotopy that returns the same arrays every time."""

    target = 1.0

    def __init__(self, jacobian):
        self.plain = FreudensteinRoth()
        self.start = self.plain.start
        self.kept = [np.empty(2), np.empty((2, 2)), np.empty(2)]
        if jacobian:
            self.jacobian = self._jacobian

    def residual(self, y, lam):
        self.kept[0][:] = self.plain.residual(y, lam)
        return self.kept[0]

    def _jacobian(self, y, lam):
        self.kept[1][...], self.kept[2][...] = self.plain.jacobian(y, lam)
        return self.kept[1], self.kept[2]


@every_preset
def test_a_homotopy_may_reuse_its_arrays(preset):
    path = trace(OneBuffer(jacobian=True), preset=preset)
    np.testing.assert_array_equal(path.u, trace(FreudensteinRoth(), preset=preset).u)


def test_a_residual_that_reuses_its_array_has_derivatives():
    """By differences: jets and complex numbers do not fit into an array of floats."""
    path = trace(OneBuffer(jacobian=False))
    assert (path.status, len(path.turning_points)) == (Status.REACHED_TARGET, 2)
    assert check_jacobian(OneBuffer(jacobian=True)).correct
