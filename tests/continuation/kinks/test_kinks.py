"""Kinks drawn by hand: what is located there, which rays leave, where the path goes on, and where it ends."""

from itertools import product

import attrs
import numpy as np
import pytest

import continuation
from continuation import (
    Budget,
    Kind,
    KinkPoint,
    Monitor,
    Status,
    TargetValue,
    audit,
    from_functions,
    switch_branch,
    trace,
)
from continuation import kink_rays as rays
from continuation.archive import PathLog, open_archive, resume
from continuation.evaluation.pieces import Pieces
from continuation.testing import CheckFailure, check_homotopy

from ...util import every_preset
from ..archive.test_archive_resume import OPTIONS, name

OFF = Monitor(lambda u, v: float(np.abs(u).max()) - 50.0, "off", terminal=1)


@attrs.frozen(eq=False)
class Joined:
    """A map of its pieces: `make(*signs)` gives the residual of one, `watched` the switches."""

    make: object
    watched: object
    at: tuple
    target: float | None = None
    slope: object = None

    def start(self):
        return np.atleast_1d(np.array(self.at[0], dtype=float)), float(self.at[1])

    def switches(self, y, lam):
        return self.watched(y, lam)

    def piece(self, signs):
        jacobian = None if self.slope is None else self.slope(*map(int, signs))
        return from_functions(self.make(*map(int, signs)), jacobian, start=self.start())

    def residual(self, y, lam):
        signs = np.where(np.asarray(self.switches(y, lam)) >= 0.0, 1, -1)
        return self.make(*map(int, signs))(y, lam)


@attrs.frozen
class Cubic:
    """min(y, y^3 - 3 y + 2 - lam): down the cubic over a fold each way, then along y = 0."""

    target: float | None = -3.0

    def start(self):
        return np.array([2.5]), 10.125

    def residual(self, y, lam):
        return np.minimum(y, y**3 - 3 * y + 2 - lam)

    def switches(self, y, lam):
        return y - (y**3 - 3 * y + 2 - lam)

    def piece(self, signs):
        return CubicPiece(int(signs[0]))


@attrs.frozen
class CubicPiece:
    sign: int

    def start(self):
        return np.array([2.5]), 10.125

    def residual(self, y, lam):
        return y**3 - 3 * y + 2 - lam if self.sign > 0 else y + 0.0 * lam

    def jacobian(self, y, lam):
        return (np.diag(3 * y**2 - 3), -np.ones(1)) if self.sign > 0 else (np.eye(1), np.zeros(1))


VEE = Joined(lambda a: lambda y, lam: a * y - lam, lambda y, lam: y, (-1.0, 1.0), target=2.0)
CROSS = Joined(lambda a, b: lambda y, lam: a * y - b * lam, lambda y, lam: np.append(y, lam), (-1.0, 1.0))
STOP = Joined(lambda a, b: lambda y, lam: a * y + (b > 0) * lam, lambda y, lam: np.append(y, lam), (0.0, -1.0))
# An ideal diode and a resistor: the current y is that of the resistor where the voltage lam is positive, else zero.
DIODE = Joined(
    lambda a: lambda y, lam: y - lam if a > 0 else y + 0.0 * lam, lambda y, lam: np.append(y[:0], lam), (1.0, 1.0), -1.0
)


def test_a_vee():
    path = trace(VEE, direction=-1)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.u.tolist() == [2.0, 2.0]
    (kink,) = path.kinks
    assert (kink.name, kink.kind, kink.switches, kink.ends_step) == ("turning kink", Kind.KINK, (0,), True)
    assert np.abs(kink.u).max() < 1e-15
    assert np.allclose(kink.rays[:, 0] / kink.rays[:, 1], [-1.0, 1.0], rtol=1e-15)
    assert path.steps[kink.step].kind is Kind.KINK
    assert path.turning_points == []


def test_the_vee_as_dense_output():
    path = trace(VEE, direction=-1)
    s = np.linspace(0.0, path.arclength[-1], 101)
    assert np.abs(np.abs(path(s)[:, 0]) - path(s)[:, 1]).max() < 1e-14


def test_a_diode_goes_round_its_corner():
    path = trace(DIODE, direction=-1)
    assert path.status is Status.REACHED_TARGET
    assert np.abs(path.endpoint.u - [0.0, -1.0]).max() < 1e-14
    assert [kink.name for kink in path.kinks] == ["kink"]
    assert np.abs(path.kinks[0].u).max() < 1e-15


@every_preset
def test_a_cubic_with_a_kink(preset):
    path = trace(Cubic(), preset=preset)
    assert path.status is Status.REACHED_TARGET
    assert [event.name for event in path.events] == ["turning point", "turning kink"]
    assert np.abs(path.events[0].u - [1.0, 0.0]).max() < 1e-7
    assert np.abs(path.kinks[0].u - [0.0, 2.0]).max() < 1e-14
    assert np.abs(path.endpoint.u - [0.0, -3.0]).max() < 1e-14


@pytest.mark.parametrize("options", OPTIONS, ids=name)
def test_every_part_crosses_a_kink_and_resumes_there(options, tmp_path):
    whole = trace(Cubic(), **options)
    assert [event.name for event in whole.events] == ["turning point", "turning kink"]
    kink = whole.kinks[0].step
    for steps in {max(kink - 1, 1), kink, kink + 1} if options is OPTIONS[0] else {kink}:
        if steps >= len(whole) - 1:
            continue
        file = tmp_path / f"{steps}.h5"
        trace(Cubic(), archive=file, budget=Budget(steps=steps), **options)
        again = resume(file, Cubic(), budget=Budget())
        assert np.array_equal(again.u, whole.u)
        assert [event.name for event in again.events] == [event.name for event in whole.events]
        assert np.array_equal(again.kinks[0].rays, whole.kinks[0].rays)


def test_an_archive_holds_kink_and_curve(tmp_path):
    file = tmp_path / "run.h5"
    path = trace(Cubic(), archive=PathLog(file, title="kink"))
    with open_archive(file) as archive:
        again = archive.path(0)
    assert np.array_equal(again.kinks[0].rays, path.kinks[0].rays)
    assert again.kinks[0].switches == (0,)
    after = again.steps[path.kinks[0].step + 1].segment
    assert np.abs(after.at(0.5)[0]) < 1e-15


def test_a_branching_kink_has_four_rays_and_each_can_be_followed():
    path = trace(CROSS, direction=-1, events=[OFF])
    (kink,) = path.kinks
    assert (kink.name, kink.switches) == ("branching kink", (0, 1))
    assert {tuple(np.sign(ray).tolist()) for ray in kink.rays} == set(product((-1.0, 1.0), repeat=2))
    assert np.sign(kink.rays[0]).tolist() == [-1.0, 1.0]
    assert np.sign(path.endpoint.u).tolist() == np.sign(kink.rays[1]).tolist()
    others = switch_branch(CROSS, kink)
    assert len(others) == 2
    for k in range(4):
        (start,) = switch_branch(path, kink, ray=k)
        branch = trace(CROSS, start=start, events=[OFF])
        assert branch.status is Status.STOPPED_AT_EVENT
        assert np.sign(branch.endpoint.u).tolist() == np.sign(kink.rays[k]).tolist()
        assert branch.kinks == []


def test_the_orientation_decides_where_a_path_goes_on():
    path = trace(CROSS, direction=-1, events=[OFF])
    signs = {step.orientation for step in path.steps}
    assert len(signs) == 1


def test_a_ray_that_does_not_exist_is_refused():
    kink = trace(VEE, direction=-1).kinks[0]
    with pytest.raises(ValueError, match="ray: expected the number of one of its 2 rays, found 2"):
        switch_branch(VEE, kink, ray=2)
    event = attrs.evolve(kink, kind=Kind.BRANCH_POINT)
    with pytest.raises(ValueError, match="ray: expected None"):
        switch_branch(VEE, event, ray=0)


def test_a_dead_end_is_one():
    # |y| + max(lam, 0) = 0: the path ends at the origin, and its switch y vanishes all the way without being a kink.
    path = trace(STOP, direction=1)
    assert path.status is Status.DEAD_END
    assert "No branch leaves the kink" in path.message
    assert [(kink.name, len(kink.rays)) for kink in path.kinks] == [("dead end", 1)]
    assert np.abs(path.endpoint.u).max() < 1e-15


def test_a_terminal_kink_ends_the_path():
    path = trace(VEE, direction=-1, events=[KinkPoint()])
    assert path.status is Status.STOPPED_AT_EVENT
    assert path.endpoint.kind is Kind.KINK
    assert len(path.kinks[0].rays) == 2


def test_events_of_other_kinds_beside_a_kink():
    path = trace(VEE, direction=-1, events=[TargetValue(0.5, terminal=0)])
    assert [event.name for event in path.events] == ["lam = 0.5", "turning kink", "lam = 0.5"]
    assert [event.lam for event in path.events if event.kind == Kind.EVENT] == [0.5, 0.5]


def test_a_target_in_a_kink_is_reached():
    path = trace(attrs.evolve(VEE, target=0.0))
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.lam == 0.0


@pytest.mark.parametrize(("at", "direction"), [((0.0, 0.0), 1), ((-0.5, 0.5), -1), ((0.5, 0.5), 1)])
def test_a_start_in_a_kink_or_beside_it(at, direction):
    path = trace(attrs.evolve(VEE, at=at), direction=direction)
    assert path.status is Status.REACHED_TARGET
    assert abs(path.endpoint.y[0]) == 2.0


def test_a_start_in_a_kink_from_which_no_branch_leaves_that_way():
    path = trace(attrs.evolve(VEE, at=(0.0, 0.0)), direction=-1)
    assert path.status is Status.SINGULAR_START
    assert "no branch leaves in the direction asked for" in path.message


def test_two_crossings_within_one_step_are_told_apart():
    gap = 1e-9
    sharp = Joined(
        lambda a, b: lambda y, lam: a * y + b * (y - gap) + 3.0 * y - lam,
        lambda y, lam: np.append(y, y - gap),
        (-1.0, -5.0 - gap * 0.0),
        target=5.0,
    )
    path = trace(attrs.evolve(sharp, at=(-1.0, -1.0 + gap)))
    assert [kink.switches for kink in path.kinks] == [(0,), (1,)]
    assert np.abs(np.array([kink.y[0] for kink in path.kinks]) - [0.0, gap]).max() < 1e-15


def test_a_switch_that_only_touches_zero_is_no_kink():
    # The switch is y^2: positive on both sides of y = 0.
    touched = Joined(lambda a: lambda y, lam: y - lam, lambda y, lam: y**2, (-1.0, -1.0), target=1.0)
    path = trace(touched)
    assert path.status is Status.REACHED_TARGET
    assert path.kinks == []


def test_a_path_that_grazes_a_border_twice_between_two_points():
    # y = lam under the switch (lam - 0.5)^2 - d^2 for a small d: in and out again well within a step.
    d = 1e-4
    grazed = Joined(
        lambda a: lambda y, lam: y - lam - (0.0 if a > 0 else ((lam - 0.5) ** 2 - d**2)),
        lambda y, lam: np.append(np.zeros(0), (lam - 0.5) ** 2 - d**2),
        (0.0, 0.0),
        target=1.0,
    )
    path = trace(grazed)
    assert np.abs(np.array([kink.lam for kink in path.kinks]) - [0.5 - d, 0.5 + d]).max() < 1e-12


def test_pieces_that_do_not_agree_are_found_out():
    torn = Joined(lambda a: lambda y, lam: y - lam - 0.1 * a, lambda y, lam: y, (-1.0, -0.9), target=1.0)
    path = trace(torn)
    assert path.status is Status.UNRESOLVED_KINK
    assert "do not agree" in path.message
    with pytest.raises(CheckFailure, match="piece"):
        check_homotopy(torn)


SQUARE = Joined(lambda a, b: lambda y, lam: a * y + b * lam - 1.0, lambda y, lam: np.append(y, lam), (0.5, 0.5))


def test_a_closed_curve_that_begins_in_a_kink():
    path = trace(attrs.evolve(SQUARE, at=(1.0, 0.0)), direction=1)
    assert path.status is Status.CLOSED
    assert [kink.name for kink in path.kinks] == ["turning kink", "kink", "turning kink", "kink"]
    assert np.abs(path.endpoint.u - [1.0, 0.0]).max() < 1e-14


def test_a_closed_curve_of_four_lines():
    square = SQUARE
    path = trace(square)
    assert path.status is Status.CLOSED
    assert sorted(tuple(np.round(kink.u, 12)) for kink in path.kinks) == [(-1, 0), (0, -1), (0, 1), (1, 0)]
    assert audit(square, path).same
    assert audit(square, path, backwards=True).same


def test_rays_of_points():
    assert np.allclose(rays(VEE, np.zeros(2)) * np.sqrt(2.0), [[1.0, 1.0], [-1.0, 1.0]])
    assert rays(CROSS, np.zeros(2)).shape == (4, 2)
    along = rays(VEE, np.array([1.0, 1.0]))
    assert np.allclose(along[0], -along[1])


def test_a_homotopy_with_pieces_conforms():
    check_homotopy(Cubic())


def test_jets_and_differences_give_the_derivatives_of_switches():
    smooth = Pieces(Joined(None, lambda y, lam: y**2 * lam, (0.0, 0.0)))
    rough = Pieces(Joined(None, lambda y, lam: np.array([float(y[0]) ** 2 * float(lam)]), (0.0, 0.0)))
    u, v = np.array([3.0, 2.0]), np.array([1.0, -1.0])
    assert smooth.along(u, v)[0] == pytest.approx(3.0, rel=1e-15)
    assert rough.along(u, v)[0] == pytest.approx(3.0, rel=1e-9)


def test_smooth_homotopies_have_no_event_for_kinks():
    assert continuation.Tracer(CubicPiece(1)).settings.kink_index is None
