"""Events: all of them, in order, once, and exactly where they are."""

from math import pi

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from continuation import Kind, Monitor, Status, TargetValue, TurningPoint, trace
from continuation.controllers import Bounds, Fixed
from continuation.metric import Euclidean
from continuation.point.segment import cubic
from problems.bifurcation import Circle, Cusp, ExponentialCosine, FreudensteinRoth

from ..util import scalar

LINE = scalar(lambda y, lam: y - 2.0 * lam, lambda y, lam: (1.0, -2.0))
FLAT = scalar(lambda y, lam: y, lambda y, lam: (1.0, 0.0))


def giant_steps():
    return Fixed(Bounds(initial=0.75), max_angle=0.8)


def named(path, name):
    return [event for event in path.events if event.name == name]


def test_several_in_one_step_in_order():
    values = (0.7, 0.2, 0.5, 0.21, 0.9)
    path = trace(
        LINE, events=[TargetValue(value, terminal=0) for value in values], controller=Fixed(Bounds(initial=5.0))
    )
    assert len(path) == 2
    assert [event.lam for event in path.events] == sorted(values)
    assert {event.step for event in path.events} == {1}
    lengths = [event.arclength for event in path.events]
    assert lengths == sorted(lengths)
    assert lengths[-1] < path.endpoint.arclength


def test_several_zeros_of_one_monitor_in_one_step():
    # Along the line the monitor has three zeros within the one step that leads to the target.
    wave = Monitor(lambda u, v: (u[-1] - 0.2) * (u[-1] - 0.55) * (u[-1] - 0.8), "wave")
    path = trace(LINE, events=[wave], controller=Fixed(Bounds(initial=5.0)))
    np.testing.assert_allclose([event.lam for event in named(path, "wave")], [0.2, 0.55, 0.8], rtol=0, atol=1e-12)


def test_a_pair_of_zeros_between_ends_of_one_sign():
    dip = Monitor(lambda u, v: (u[-1] - 0.4) * (u[-1] - 0.6), "dip")
    path = trace(LINE, events=[dip], controller=Fixed(Bounds(initial=5.0)))
    np.testing.assert_allclose([event.lam for event in named(path, "dip")], [0.4, 0.6], rtol=0, atol=1e-12)


@pytest.mark.parametrize("terminal", [1, 2, 3, 4])
def test_terminal_after_the_kth(terminal):
    path = trace(Circle(), events=[TargetValue(0.5, terminal=terminal)], target=None)
    expected = [(np.sqrt(0.75), 0.5), (-np.sqrt(0.75), 0.5)][:terminal]
    np.testing.assert_allclose([event.u for event in named(path, "lam = 0.5")], expected, rtol=0, atol=1e-12)
    assert path.status is (Status.STOPPED_AT_EVENT if terminal <= 2 else Status.CLOSED)
    if terminal <= 2:
        assert path.endpoint.kind == Kind.EVENT
        np.testing.assert_array_equal(path.endpoint.u, path.events[-1].u)
        assert "lam = 0.5" in path.message


def test_a_terminal_event_hides_what_lies_behind_it_in_the_same_step():
    events = [TargetValue(0.6, terminal=0), TargetValue(0.4), TargetValue(0.3, terminal=0)]
    path = trace(LINE, events=events, controller=Fixed(Bounds(initial=5.0)))
    assert [event.lam for event in path.events] == [0.3, 0.4]
    assert path.endpoint.lam == 0.4


@pytest.mark.parametrize(("direction", "expected"), [(1, [1.0]), (-1, [-1.0]), (0, [1.0, -1.0])])
def test_directions(direction, expected):
    # sin(2 angle) rises through zero at angle 0 and pi, and falls at pi/2 and 3 pi/2; x = cos(angle) rises at 3 pi/2.
    path = trace(Circle(), events=[TargetValue(0.0, component=0, terminal=0, direction=-direction)])
    found = [event.lam for event in named(path, "component 0 = 0")]
    assert found == pytest.approx(expected, abs=1e-12)


def test_the_direction_counts_for_a_zero_exactly_on_a_knot():
    # Steps of 0.25 in lam: 0.5 is a knot to the last bit, where lam - 0.5 rises.
    for direction, count in ((1, 1), (0, 1), (-1, 0)):
        path = trace(
            FLAT,
            events=[TargetValue(0.5, terminal=0, direction=direction)],
            controller=Fixed(Bounds(initial=0.25)),
            metric=Euclidean(),
        )
        assert 0.5 in path.lam
        assert len(named(path, "lam = 0.5")) == count


def test_never_twice_when_the_zero_is_a_knot():
    events = [TargetValue(0.5, terminal=0), Monitor(lambda u, v: u[-1] - 0.75, "at 0.75")]
    path = trace(FLAT, events=events, controller=Fixed(Bounds(initial=0.25)), metric=Euclidean())
    assert [event.name for event in path.events] == ["lam = 0.5", "at 0.75"]


def test_a_zero_behind_a_knot_that_was_one_too():
    # Zeros at 0.25, a knot, and at 0.4, within the next step.
    pair = Monitor(lambda u, v: (u[-1] - 0.25) * (u[-1] - 0.4), "pair")
    path = trace(FLAT, events=[pair], controller=Fixed(Bounds(initial=0.25)), metric=Euclidean())
    np.testing.assert_allclose([event.lam for event in path.events], [0.25, 0.4], rtol=0, atol=1e-12)


def test_the_start_is_no_event():
    path = trace(Circle(), events=[TargetValue(0.0, terminal=0)])
    found = [event.u for event in named(path, "lam = 0")]
    np.testing.assert_allclose(found[:1], [(-1.0, 0.0)], rtol=0, atol=1e-12)


@pytest.mark.parametrize("component", [0, 1, 2, -1, -2])
def test_any_component_is_landed_on_exactly(component):
    value = {0: 40.0, 1: 1.25, 2: 0.125, -1: 0.125, -2: 1.25}[component]
    path = trace(FreudensteinRoth(), events=[TargetValue(value, component=component)])
    assert path.status is Status.STOPPED_AT_EVENT
    assert path.endpoint.u[component] == value
    assert np.abs(FreudensteinRoth().residual(path.endpoint.y, path.endpoint.lam)).max() <= 1e-11


def test_a_value_between_knots_of_long_steps():
    path = trace(
        Circle(),
        controller=giant_steps(),
        metric=Euclidean(),
        events=[TargetValue(x, component=0, terminal=0) for x in (0.9, 0.1, -0.99)],
    )
    assert path.status is Status.CLOSED
    assert len(path) < 20
    for x in (0.9, 0.1, -0.99):
        found = [event.u for event in path.events if event.name == f"component 0 = {x:g}"]
        y = np.sqrt(1.0 - x * x)
        np.testing.assert_allclose(found, [(x, y), (x, -y)], rtol=0, atol=1e-13)


def test_a_monitor_of_the_callers():
    angle = Monitor(lambda u, v: u[0] - u[1], "diagonal", direction=-1)
    path = trace(Circle(), events=[angle], controller=giant_steps(), metric=Euclidean())
    (event,) = named(path, "diagonal")
    np.testing.assert_allclose(event.u, (np.sqrt(0.5), np.sqrt(0.5)), rtol=0, atol=1e-14)
    assert event.arclength == pytest.approx(0.25 * pi, rel=1e-6)
    assert abs(event.monitor) <= 1e-14
    assert event.residual_norm <= 1e-14


def test_a_monitor_of_the_tangent():
    slope = Monitor(lambda u, v: v[0] + v[1], "slope")
    path = trace(Circle(), events=[slope], controller=giant_steps(), metric=Euclidean())
    angles = [np.arctan2(event.u[1], event.u[0]) for event in named(path, "slope")]
    np.testing.assert_allclose(angles, [0.25 * pi, -0.75 * pi], rtol=0, atol=1e-12)


@pytest.mark.parametrize("n", [3, 5])
def test_long_steps_lose_no_turning_point(n):
    few = trace(ExponentialCosine(n))
    many = trace(ExponentialCosine(n), controller=Fixed(Bounds(initial=0.01)))
    assert [event.step for event in few.turning_points] != [event.step for event in many.turning_points]
    np.testing.assert_allclose(
        [event.u for event in few.turning_points], [event.u for event in many.turning_points], rtol=0, atol=1e-10
    )


def test_turning_points_are_watched_for_unasked_and_named_once():
    assert len(trace(Cusp()).turning_points) == 2
    assert len(trace(Cusp(), events=[TurningPoint()]).turning_points) == 2


def test_the_events_of_the_homotopy_come_too():
    class Own(Cusp):
        events = (TargetValue(0.0, component=0, terminal=0),)

    path = trace(Own(), events=[TargetValue(1.0, component=0, terminal=0)])
    assert [event.name for event in path.events if event.kind == Kind.EVENT] == ["component 0 = 0", "component 0 = 1"]


def test_a_target_that_is_also_an_event():
    path = trace(LINE, events=[TargetValue(1.0, terminal=0)])
    assert path.status is Status.REACHED_TARGET
    assert [event.lam for event in path.events] == [1.0]


def test_a_turning_point_as_the_end():
    path = trace(Cusp(), events=[TurningPoint(terminal=1)])
    assert path.status is Status.STOPPED_AT_EVENT
    assert path.endpoint.kind == Kind.TURNING_POINT
    assert path.endpoint.lam == pytest.approx(2.0 / (3.0 * np.sqrt(3.0)), abs=1e-13)
    assert abs(path.endpoint.tangent[-1]) <= 1e-12


def test_no_false_turning_point_where_the_parameter_dies_out():
    # y = -log lam: the parameter falls for ever, ever more slowly.
    homotopy = scalar(
        lambda y, lam: np.exp(-y) - lam, lambda y, lam: (-np.exp(-y), -1.0), start=(0.0, 1.0), target=None
    )
    path = trace(homotopy, events=[TargetValue(600.0, component=0)], direction=-1)
    assert path.turning_points == []


def test_no_false_turning_point_on_a_path_of_constant_parameter_rate():
    flat = scalar(lambda y, lam: y - 1.0, lambda y, lam: (1.0, 0.0), start=(1.0, 0.0))
    assert trace(flat, events=[TurningPoint(0)]).events == []


def test_a_pair_that_the_cubic_between_two_points_does_not_show():
    """lam' = (y - 0.65) (y - 0.7) (1 + y^2) / 5: a quintic, which the looks between the points tell."""
    slope = 0.2 * Polynomial.fromroots([0.65, 0.7]) * Polynomial([1.0, 0.0, 1.0])
    lam = slope.integ()
    homotopy = scalar(lambda y, at: lam(y) - at, lambda y, at: (slope(y), -1.0), target=None)
    path = trace(homotopy, metric=Euclidean(), controller=giant_steps(), events=[TargetValue(1.4, component=0)])
    assert path.u[1, 0] == pytest.approx(0.75, abs=2e-3)
    np.testing.assert_allclose([event.y[0] for event in path.turning_points], [0.65, 0.7], rtol=1e-12)


@pytest.mark.parametrize("degree", [3, 5])
def test_a_segment_has_the_derivative_of_its_points(degree):
    parts = np.random.default_rng(7).standard_normal((6, 3))
    segment = cubic(*parts[:4])
    if degree == 5:
        segment = segment.bent(*parts[4:])
    points, slopes = segment.sampled()
    for t, point, slope in zip(segment.inside, points, slopes):
        np.testing.assert_allclose(point, segment.at(t), rtol=1e-13, atol=1e-14)
        np.testing.assert_allclose(slope, segment.derivative(t), rtol=1e-13, atol=1e-14)
        np.testing.assert_allclose((segment.at(t + 1e-6) - segment.at(t - 1e-6)) / 2e-6, slope, rtol=1e-8, atol=1e-9)
    ends = [segment.at(0.0), segment.at(1.0), segment.derivative(0.0), segment.derivative(1.0)]
    np.testing.assert_allclose(ends, parts[:4], rtol=1e-13, atol=1e-14)
