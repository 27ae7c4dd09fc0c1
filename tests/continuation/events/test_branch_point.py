"""Simple branch points: located, told from hairpins, and left on the other branch."""

import numpy as np
import pytest
from attrs import evolve

from continuation import (
    CONSERVATIVE,
    DEFAULT,
    FAST,
    SERIES,
    BranchPoint,
    Budget,
    Kind,
    Status,
    TargetValue,
    branch_directions,
    from_functions,
    switch_branch,
    trace,
)
from continuation.controllers import Bounds, Fixed
from continuation.metric import Euclidean
from problems.bifurcation import Pitchfork

from ...util import by_preset, every_preset
from ..util import scalar


def branch_points(path):
    return [event for event in path.events if event.kind == Kind.BRANCH_POINT]


def shifted_pitchfork(at):
    return scalar(lambda y, lam: (lam - at) * y - y**3, lambda y, lam: (lam - at - 3.0 * y * y, y), start=(0.0, -1.0))


def transcritical(start):
    return scalar(lambda y, lam: lam * y - y**2, lambda y, lam: (lam - 2.0 * y, y), start=(start, -1.0))


def line_through_circle(start=(-1.0, -2.0)):
    """(y - lam/2)(y^2 + lam^2 - 1) = 0: two branch points, at +-(1, 2) / sqrt 5."""

    def jacobian(y, lam):
        line, circle = y - 0.5 * lam, y * y + lam * lam - 1.0
        return (circle + 2.0 * y * line)[:, None], -0.5 * circle + 2.0 * lam * line

    return from_functions(
        lambda y, lam: (y - 0.5 * lam) * (y * y + lam * lam - 1.0), jacobian, start=([start[0]], start[1]), target=2.0
    )


@every_preset
@pytest.mark.parametrize("at", [0.0, 0.123, -0.77, 0.999])
def test_the_pitchfork_is_located(preset, at):
    path = trace(shifted_pitchfork(at), preset=preset)
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose(path.endpoint.u, (0.0, 1.0), rtol=0, atol=1e-10)
    (event,) = branch_points(path)
    np.testing.assert_allclose(event.u, (0.0, at), rtol=0, atol=1e-10)
    assert path.turning_points == []
    signs = [step.orientation for step in path.steps[:-1]]
    assert signs[0] == -signs[-1] or at > 0.9


@pytest.mark.parametrize("h", [0.5, 0.4, 0.25, 1.0 / 3.0])
def test_a_knot_may_lie_in_the_branch_point(h):
    path = trace(Pitchfork(), controller=Fixed(Bounds(initial=h)), metric=Euclidean())
    assert path.status is Status.REACHED_TARGET
    (event,) = branch_points(path)
    np.testing.assert_allclose(event.u, 0.0, rtol=0, atol=1e-10)


def test_steps_that_would_creep_up_to_the_branch_point_pass_it():
    controller = evolve(DEFAULT.controller, bounds=Bounds(maximum=0.25, initial=0.25))
    path = trace(Pitchfork(), controller=controller)
    assert path.status is Status.REACHED_TARGET
    assert len(branch_points(path)) == 1


@every_preset
@pytest.mark.parametrize("start", [0.0, -1.0])
def test_the_transcritical_one_is_located_from_both_branches(preset, start):
    path = trace(transcritical(start), preset=preset)
    assert path.status is Status.REACHED_TARGET
    (event,) = branch_points(path)
    np.testing.assert_allclose(event.u, 0.0, rtol=0, atol=1e-10)
    np.testing.assert_allclose(path.endpoint.u, (-start, 1.0), rtol=0, atol=1e-10)


@every_preset
def test_two_on_one_path(preset):
    path = trace(line_through_circle(), preset=preset)
    assert path.status is Status.REACHED_TARGET
    expected = np.array([[-1.0, -2.0], [1.0, 2.0]]) / np.sqrt(5.0)
    np.testing.assert_allclose([event.u for event in branch_points(path)], expected, rtol=0, atol=1e-10)


def test_one_between_the_last_point_and_the_target():
    # The target is in reach of the step that passes the branch point.
    path = trace(shifted_pitchfork(0.95), controller=Fixed(Bounds(initial=0.5)), metric=Euclidean())
    (event,) = branch_points(path)
    np.testing.assert_allclose(event.u, (0.0, 0.95), rtol=0, atol=1e-10)


def test_none_behind_the_target():
    path = trace(shifted_pitchfork(1.05), controller=Fixed(Bounds(initial=0.7)), metric=Euclidean())
    assert path.endpoint.lam == 1.0
    assert branch_points(path) == []


def test_it_may_end_the_trace():
    path = trace(Pitchfork(), events=[BranchPoint()])
    assert path.status is Status.STOPPED_AT_EVENT
    assert path.endpoint.kind == Kind.BRANCH_POINT
    np.testing.assert_allclose(path.endpoint.u, 0.0, rtol=0, atol=1e-10)


def test_both_branches_of_the_pitchfork_are_followed():
    (event,) = branch_points(trace(Pitchfork()))
    known, other = branch_directions(Pitchfork(), event)
    assert abs(known @ (0.0, 1.0)) == pytest.approx(1.0, abs=1e-9)
    assert abs(other @ (1.0, 0.0)) == pytest.approx(1.0, abs=1e-9)
    ends = []
    for start in switch_branch(Pitchfork(), event):
        path = trace(Pitchfork(), start=start)
        assert path.status is Status.REACHED_TARGET
        np.testing.assert_allclose(path.y[:, 0] ** 2, path.lam, rtol=0, atol=1e-8)
        ends.append(path.endpoint.y[0])
    assert sorted(ends) == pytest.approx([-1.0, 1.0], abs=1e-9)


def test_the_other_branch_of_the_transcritical_one():
    homotopy = transcritical(0.0)
    (event,) = branch_points(trace(homotopy))
    ends = set()
    for start in switch_branch(homotopy, event):
        path = trace(homotopy, start=start, target=None, events=[TargetValue(1.0), TargetValue(-1.0)])
        np.testing.assert_allclose(path.y[:, 0], path.lam, rtol=0, atol=1e-8)
        ends.add(path.endpoint.lam)
    assert ends == {-1.0, 1.0}


def test_the_circle_is_reached_from_the_line():
    homotopy = line_through_circle()
    event = branch_points(trace(homotopy))[0]
    for start in switch_branch(homotopy, event):
        path = trace(homotopy, start=start, target=None, budget=Budget(steps=200))
        assert path.status is Status.CLOSED
        np.testing.assert_allclose(np.hypot(path.y[:, 0], path.lam), 1.0, rtol=0, atol=1e-7)


def test_two_unknowns():
    # y1 (lam + y2) - y1^3 = 0, y2 = lam^2 - y1^2: the branch y1 = 0 meets others at lam = -1 and lam = 0.
    homotopy = from_functions(
        lambda y, lam: np.array([y[0] * (lam + y[1]) - y[0] ** 3, y[1] - lam**2 + y[0] ** 2]),
        start=([0.0, 2.25], -1.5),
        target=1.0,
    )
    path = trace(homotopy)
    found = [event.u for event in branch_points(path)]
    np.testing.assert_allclose(found, [(0.0, 1.0, -1.0), (0.0, 0.0, 0.0)], rtol=0, atol=1e-9)


@pytest.mark.parametrize("width", [1e-1, 1e-2, 1e-3])
def test_a_hairpin_is_no_branch_point(width):
    # A parabola so narrow that a step over its vertex flips the determinant.
    homotopy = scalar(
        lambda y, lam: y * y - width**2 * (1.0 - lam),
        lambda y, lam: (2.0 * y, width**2),
        start=(width, 0.0),
        target=None,
    )
    path = trace(homotopy, direction=1, events=[TargetValue(0.0)], metric=Euclidean())
    assert path.status is Status.STOPPED_AT_EVENT
    assert branch_points(path) == []
    (fold,) = path.turning_points
    np.testing.assert_allclose(fold.u, (0.0, 1.0), rtol=0, atol=1e-10)
    np.testing.assert_allclose(path.endpoint.u, (-width, 0.0), rtol=0, atol=1e-10)


@pytest.mark.parametrize("imperfection", [1e-1, 1e-3, 1e-6, -1e-6, 1e-8])
@every_preset
def test_an_avoided_branch_point_is_not_crossed(imperfection, preset):
    path = trace(Pitchfork(imperfection), preset=preset)
    assert path.status is Status.REACHED_TARGET
    assert branch_points(path) == []
    x = path.endpoint.y[0]
    assert np.sign(x) == np.sign(imperfection)
    assert abs(x) > 0.9


@pytest.mark.parametrize(("first", "second", "bent"), [(0.2, -2.2, 0.0), (0.2, -2.2, 0.3), (-1.8, -2.5, 0.1)])
@by_preset(FAST, DEFAULT, CONSERVATIVE, SERIES)
def test_two_curves_a_millionth_apart_do_not_cross(first, second, bent, preset):
    # (y - f)(y - g) = 1e-12: all that H is made of, but for the constant, vanishes where f and g cross.
    def graphs(lam):
        return first * lam + bent * np.sin(2.0 * lam), second * lam - bent * lam**2

    def upper(lam):
        f, g = graphs(lam)
        return 0.5 * (f + g) + np.hypot(0.5 * (f - g), 1e-6)

    def derivatives(y, lam):
        (f, g), slope = graphs(lam), second - 2.0 * bent * lam
        return 2.0 * y - f - g, -(first + 2.0 * bent * np.cos(2.0 * lam)) * (y - g) - slope * (y - f)

    homotopy = scalar(
        lambda y, lam: (y - graphs(lam)[0]) * (y - graphs(lam)[1]) - 1e-12,
        derivatives,
        start=(upper(-2.0), -2.0),
        target=2.0,
    )
    path = trace(homotopy, preset=preset)
    assert path.status is Status.REACHED_TARGET
    assert not path.events
    np.testing.assert_allclose(path.endpoint.y, [upper(2.0)], rtol=1e-9)
