"""Kinks drawn by hand: what is located there, which rays leave, where the path goes on, and where it ends."""

from itertools import product

import attrs
import numpy as np
import pytest

from continuation import Budget, Kind, KinkPoint, Monitor, Status, TargetValue, audit, switch_branch, trace
from continuation import kink_rays as rays
from continuation.archive import resume
from continuation.evaluation.pieces import Pieces
from continuation.testing import check_homotopy

from ...util import path_of
from ..archive.test_archive_resume import OPTIONS, name
from .util import Joined

OFF = Monitor(lambda u, v: float(np.abs(u).max()) - 50.0, "off", terminal=1)

VEE = Joined(lambda a: lambda y, lam: a * y - lam, lambda y, lam: y, (-1.0, 1.0), target=2.0)
CROSS = Joined(lambda a, b: lambda y, lam: a * y - b * lam, lambda y, lam: np.append(y, lam), (-1.0, 1.0))
# |y| + max(lam, 0) = 0: the path ends at the origin, and its switch y vanishes all the way without being a kink.
STOP = Joined(lambda a, b: lambda y, lam: a * y + (b > 0) * lam, lambda y, lam: np.append(y, lam), (0.0, -1.0))
# An ideal diode and a resistor: the current y is that of the resistor where the voltage lam is positive, else zero.
DIODE = Joined(
    lambda a: lambda y, lam: y - lam if a > 0 else y + 0.0 * lam, lambda y, lam: np.append(y[:0], lam), (1.0, 1.0), -1.0
)
# min(y, y^3 - 3 y + 2 - lam): down the cubic over a fold each way, then along y = 0.
CUBIC = Joined(
    lambda a: lambda y, lam: y**3 - 3 * y + 2 - lam if a > 0 else y + 0.0 * lam,
    lambda y, lam: y - (y**3 - 3 * y + 2 - lam),
    (2.5, 10.125),
    -3.0,
    lambda a: lambda y, lam: (np.diag(3 * y**2 - 3), -np.ones(1)) if a > 0 else (np.eye(1), np.zeros(1)),
)
SQUARE = Joined(lambda a, b: lambda y, lam: a * y + b * lam - 1.0, lambda y, lam: np.append(y, lam), (0.5, 0.5))
# Two kinks 1e-9 apart; a switch y^2, which only touches zero; and one that y = lam is in and out of within a step.
GAP, D = 1e-9, 1e-4
SHARP = Joined(
    lambda a, b: lambda y, lam: a * y + b * (y - GAP) + 3.0 * y - lam,
    lambda y, lam: np.append(y, y - GAP),
    (-1.0, -1.0 + GAP),
    target=5.0,
)
TOUCHED = Joined(lambda a: lambda y, lam: y - lam, lambda y, lam: y**2, (-1.0, -1.0), target=1.0)
GRAZED = Joined(
    lambda a: lambda y, lam: y - lam - (0.0 if a > 0 else ((lam - 0.5) ** 2 - D**2)),
    lambda y, lam: np.append(np.zeros(0), (lam - 0.5) ** 2 - D**2),
    (0.0, 0.0),
    target=1.0,
)
TORN = Joined(lambda a: lambda y, lam: y - lam - 0.1 * a, lambda y, lam: y, (-1.0, -0.9), target=1.0)
TERMINAL = {"direction": -1, "events": [KinkPoint()]}
TURNING = ["turning kink", "kink", "turning kink", "kink"]
ROUND = [(0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0)]


@pytest.mark.parametrize(
    ("homotopy", "options", "status", "names", "places", "end"),
    [
        (VEE, {"direction": -1}, Status.REACHED_TARGET, ["turning kink"], [(0.0, 0.0)], (2.0, 2.0)),
        (DIODE, {"direction": -1}, Status.REACHED_TARGET, ["kink"], [(0.0, 0.0)], (0.0, -1.0)),
        (STOP, {"direction": 1}, Status.DEAD_END, ["dead end"], [(0.0, 0.0)], (0.0, 0.0)),
        (TORN, {}, Status.UNRESOLVED_KINK, ["unresolved kink"], [(0.0, 0.1)], (0.0, 0.1)),
        (SHARP, {}, Status.REACHED_TARGET, ["kink", "kink"], [(0.0, GAP), (GAP, 4.0 * GAP)], (1.0 + GAP / 5.0, 5.0)),
        (TOUCHED, {}, Status.REACHED_TARGET, [], [], (1.0, 1.0)),
        (GRAZED, {}, Status.REACHED_TARGET, ["kink", "kink"], [(0.5 - D, 0.5 - D), (0.5 + D, 0.5 + D)], (1.0, 1.0)),
        (SQUARE, {}, Status.CLOSED, TURNING, ROUND, (0.5, 0.5)),
        # A target, an end and a start in a kink, or a start beside it.
        (attrs.evolve(VEE, target=0.0), {}, Status.REACHED_TARGET, [], [], (0.0, 0.0)),
        (attrs.evolve(VEE, at=(0.5, 0.5)), {"direction": 1}, Status.REACHED_TARGET, [], [], (2.0, 2.0)),
        (VEE, TERMINAL, Status.STOPPED_AT_EVENT, TURNING[:1], [(0, 0)], (0, 0)),
        (VEE, {**TERMINAL, "examine": False}, Status.STOPPED_AT_EVENT, TURNING[:1], [(0, 0)], (0, 0)),
        (attrs.evolve(SQUARE, at=(1.0, 0.0)), {"direction": 1}, Status.CLOSED, TURNING, ROUND, (1.0, 0.0)),
    ],
    ids=[
        "vee", "diode", "dead end", "torn", "two in a step", "touched", "grazed", "square", "target in a kink",
        "start beside", "terminal kink", "alone", "square from a kink",
    ],
)  # fmt: skip
def test_kinks_are_where_they_are_and_the_path_goes_on_behind(homotopy, options, status, names, places, end):
    path = path_of(homotopy, **options, status=status)
    assert [event.name for event in path.events] == names
    # Of GRAZED the switch hardly slopes.
    for kink, at in zip(path.kinks, places, strict=True):
        np.testing.assert_allclose(kink.u, at, rtol=0, atol=1e-12 if homotopy is GRAZED else 1e-15)
        assert (path.steps[kink.step].kind, len(kink.rays)) == (Kind.KINK, 1 if homotopy in (STOP, TORN) else 2)
        assert len(kink.switches) == (2 if homotopy is STOP else 1)
    np.testing.assert_allclose(path.endpoint.u, end, rtol=0, atol=1e-14)
    # So does the dense output; GRAZED is a parabola.
    for u in path(np.linspace(0.0, path.arclength[-1], 101)):
        assert abs(homotopy.residual(u[:-1], u[-1])[0]) <= 1e-13 or homotopy in (TORN, GRAZED)


def test_what_a_kink_holds():
    # The second event's function jumps over zero in the kink, which is no zero.
    path = trace(VEE, direction=-1, events=[TargetValue(0.5, terminal=0), Monitor(lambda u, v: v[-1])])
    assert [(event.name, event.lam) for event in path.events[::2]] == 2 * [("lam = 0.5", 0.5)]
    (kink,) = path.kinks
    assert (kink.kind, kink.switches, kink.ends_step) == (Kind.KINK, (0,), True)
    np.testing.assert_allclose(kink.rays[:, 0] / kink.rays[:, 1], [-1.0, 1.0], rtol=1e-15)
    assert [kink.switches for kink in trace(SHARP).kinks] == [(0,), (1,)]


@pytest.mark.parametrize(
    ("homotopy", "direction", "status", "words"),
    [
        (STOP, 1, Status.DEAD_END, "the one it came on. Switches that vanish there: 0, 1."),
        (TORN, 1, Status.UNRESOLVED_KINK, "do not agree"),
        (attrs.evolve(VEE, at=(0.0, 0.0)), -1, Status.SINGULAR_START, "no branch leaves in the direction asked for"),
    ],
)
def test_where_no_branch_leaves_it_is_said(homotopy, direction, status, words):
    path = path_of(homotopy, direction=direction, status=status)
    assert words in path.message


@pytest.mark.parametrize("options", OPTIONS, ids=name)
def test_every_part_crosses_a_kink_and_resumes_there(options, tmp_path):
    whole = trace(CUBIC, **options)
    assert [event.name for event in whole.events] == ["turning point", "turning kink"]
    kink = whole.kinks[0].step
    for steps in {max(kink - 1, 1), kink, kink + 1} if options is OPTIONS[0] else {kink}:
        file = tmp_path / f"{steps}.h5"
        trace(CUBIC, archive=file, budget=Budget(steps=min(steps, len(whole) - 2)), **options)
        again = resume(file, CUBIC, budget=Budget())
        assert np.array_equal(again.u, whole.u)
        assert [event.name for event in again.events] == [event.name for event in whole.events]
        assert np.array_equal(again.kinks[0].rays, whole.kinks[0].rays)


def test_a_branching_kink_has_four_rays_and_each_can_be_followed():
    path = trace(CROSS, direction=-1, events=[OFF])
    (kink,) = path.kinks
    assert (kink.name, kink.switches) == ("branching kink", (0, 1))
    assert {tuple(np.sign(ray).tolist()) for ray in kink.rays} == set(product((-1.0, 1.0), repeat=2))
    # The first is that on which the path came; the orientation decides where it goes on.
    np.testing.assert_array_equal(np.sign(kink.rays[0]), [-1.0, 1.0])
    np.testing.assert_array_equal(np.sign(path.endpoint.u), np.sign(kink.rays[1]))
    assert len({step.orientation for step in path.steps}) == 1
    assert len(switch_branch(CROSS, kink)) == 2
    for k in range(4):
        branch = trace(CROSS, start=(kink.u, kink.rays[k]), events=[OFF])
        assert (branch.status, branch.kinks) == (Status.STOPPED_AT_EVENT, [])
        np.testing.assert_array_equal(np.sign(branch.endpoint.u), np.sign(kink.rays[k]))


def test_a_closed_curve_of_four_lines_is_audited():
    assert audit(SQUARE, trace(SQUARE)).same


def test_a_start_in_a_kink_leaves_it_on_one_of_its_branches():
    path = trace(attrs.evolve(VEE, at=(0.0, 0.0)), direction=1)
    assert (path.status, np.abs(path.endpoint.u).tolist()) == (Status.REACHED_TARGET, [2.0, 2.0])


def test_a_start_on_a_border_that_bends_away_leaves_it_on_its_own_side():
    # y = 1.25 lam^2 where y >= lam^2; what is y = 2 lam^2 on the other side lies beyond its border.
    bent = Joined(
        lambda a: lambda y, lam: y - 2.0 * lam**2 + (a < 0) * 3.0 * (y - lam**2), lambda y, lam: lam**2 - y, (0.0, 0.0)
    )
    path = trace(bent, direction=1, target=1.0)
    np.testing.assert_allclose(path.endpoint.u, [1.25, 1.0], rtol=0, atol=1e-12)


def test_rays_of_a_regular_point_are_both_ways():
    along = rays(VEE, np.array([1.0, 1.0]))
    np.testing.assert_allclose(along[0], -along[1])


def test_a_homotopy_with_pieces_conforms():
    check_homotopy(CUBIC, expected_failed_checks={"picklable": "its functions have no names"})


@pytest.mark.parametrize(
    ("watched", "digits"),
    [(lambda y, lam: y**2 * lam, 1e-15), (lambda y, lam: np.array([float(y[0]) ** 2 * float(lam)]), 1e-9)],
    ids=["jets", "differences"],
)
def test_jets_and_differences_give_the_derivatives_of_switches(watched, digits):
    pieces = Pieces(Joined(None, watched, (0.0, 0.0)))
    assert pieces.along(np.array([3.0, 2.0]), np.array([1.0, -1.0]))[0] == pytest.approx(3.0, rel=digits)
