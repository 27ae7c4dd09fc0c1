"""Events: all of them, in order, once, and exactly where they are."""

from math import pi

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from continuation import (
    CONSERVATIVE,
    EvaluationError,
    Kind,
    KinkPoint,
    Monitor,
    Status,
    TargetValue,
    TurningPoint,
    from_functions,
    trace,
)
from continuation.controllers import Bounds, Fixed
from continuation.metric import Euclidean
from problems.bifurcation import Circle, Cusp, FreudensteinRoth

from ...util import path_of
from ..util import scalar

LINE = scalar(lambda y, lam: y - 2.0 * lam, lambda y, lam: (1.0, -2.0))
FLAT = scalar(lambda y, lam: y, lambda y, lam: (1.0, 0.0))
GIANT = {"controller": Fixed(Bounds(initial=0.75), max_angle=0.8), "metric": Euclidean()}
ONE = {"controller": Fixed(Bounds(initial=5.0))}
# Steps of 0.25 in lam: these are knots to the last bit.
QUARTERS = {"controller": Fixed(Bounds(initial=0.25)), "metric": Euclidean()}


def named(path, name):
    return [event for event in path.events if event.name == name]


def values(*places, **options):
    return [TargetValue(place, **{"terminal": 0, **options}) for place in places]


def hidden(u, v):
    """A monitor that vanishes at 0.5, and has no values near there."""
    if 0.1 < u[-1] < 0.9:
        raise EvaluationError("it has no value")
    return u[-1] - 0.5


def monitor(*places):
    """One that vanishes at these parameter values."""
    return [Monitor(lambda u, v: float(np.prod(u[-1] - np.array(places))), "monitor")]


@pytest.mark.parametrize(
    ("homotopy", "events", "options", "expected"),
    [
        (LINE, values(0.7, 0.2, 0.5, 0.21, 0.9), ONE, [0.2, 0.21, 0.5, 0.7, 0.9]),
        (LINE, monitor(0.2, 0.55, 0.8), ONE, [0.2, 0.55, 0.8]),
        (LINE, monitor(0.4, 0.6), ONE, [0.4, 0.6]),
        (LINE, monitor(0.5, 0.5001), ONE, [0.5, 0.5001]),
        (LINE, monitor(0.92, 0.955), ONE, [0.92, 0.955]),
        (LINE, values(1.0), ONE, [1.0]),
        (LINE, [TargetValue(0.6, terminal=0), TargetValue(0.4), TargetValue(0.3, terminal=0)], ONE, [0.3, 0.4]),
        (FLAT, [*values(0.5), *monitor(0.75)], QUARTERS, [0.5, 0.75]),
        (FLAT, monitor(0.25, 0.4), QUARTERS, [0.25, 0.4]),
        (FLAT, monitor(0.08, 0.15, 0.25), QUARTERS, [0.08, 0.15, 0.25]),
        (FLAT, values(0.5, direction=1), QUARTERS, [0.5]),
        (FLAT, values(0.5, direction=-1), QUARTERS, []),
        # The end stands for a crossing that cannot be looked at.
        (LINE, [Monitor(hidden)], ONE, [1.0]),
        (LINE, [Monitor(hidden, direction=1)], ONE, [1.0]),
        (LINE, [Monitor(hidden, direction=-1)], ONE, []),
        (LINE, [Monitor(lambda u, v: 0.3 - u[-1], direction=1)], ONE, []),
        (LINE, [Monitor(lambda u, v: 0.3 - u[-1], direction=-1)], ONE, [0.3]),
    ],
    ids=[
        "several in order", "three zeros of one", "a pair", "a narrow pair", "a pair near the end", "the target",
        "behind a terminal one", "knots", "behind a knot", "a pair before a knot",
        "rising in a knot", "falling in a knot", "hidden", "hidden, rising", "hidden, falling",
        "rising only", "falling only",
    ],
)  # fmt: skip
def test_all_zeros_are_found_once_in_order_and_none_behind_a_terminal_one(homotopy, events, options, expected):
    path = trace(homotopy, events=events, **options)
    np.testing.assert_allclose([event.lam for event in path.events], expected, rtol=0, atol=1e-12)
    assert path.endpoint.lam == (0.4 if path.status is Status.STOPPED_AT_EVENT else 1.0)
    for event in path.events:
        before, after = path.steps[event.step - 1], path.steps[event.step]
        assert before.arclength < event.arclength <= after.arclength
        assert event.ends_step == (event.lam == after.lam)
        share = (event.lam - before.lam) / (after.lam - before.lam)
        assert event.arclength - before.arclength == pytest.approx(share * (after.arclength - before.arclength))


FIFTH = Monitor(lambda u, v: (u[0] - u[1]) ** 5, "of fifth order")


@pytest.mark.parametrize("events", [values(0.5), values(0.3, component=0), monitor(0.4), [FIFTH]])
def test_two_events_on_long_arcs_cost_few_residuals(events):
    """23 to 38; an arc that is divided though its ends tell one zero, or a search that does not end, costs 130."""
    alone, path = (trace(Circle(), events=watched) for watched in ([], events))
    assert len(path.events) == 4
    assert path.counts.residuals - alone.counts.residuals <= 42


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


def test_the_start_is_no_event():
    path = trace(Circle(), events=values(0.0))
    np.testing.assert_allclose(named(path, "lam = 0")[0].u, (-1.0, 0.0), rtol=0, atol=1e-12)


@pytest.mark.parametrize(("component", "value"), [(0, 40.0), (1, 1.25), (2, 0.125), (-1, 0.125), (-2, 1.25)])
def test_any_component_is_landed_on_exactly(component, value):
    path = path_of(FreudensteinRoth(), events=[TargetValue(value, component=component)], status=Status.STOPPED_AT_EVENT)
    assert path.endpoint.u[component] == value
    assert np.abs(FreudensteinRoth().residual(path.endpoint.y, path.endpoint.lam)).max() <= 1e-11


@pytest.mark.parametrize(
    ("function", "direction", "angles", "within"),
    [
        (lambda u, v: u[0] - u[1], -1, [0.25 * pi], 1e-14),
        (lambda u, v: v[0] + v[1], 0, [0.25 * pi, -0.75 * pi], 1e-12),
    ],
    ids=["of the point", "of the tangent"],
)
def test_a_monitor_of_the_callers(function, direction, angles, within):
    path = trace(Circle(), events=[Monitor(function, "own", direction=direction)], **GIANT)
    found = named(path, "own")
    np.testing.assert_allclose([np.arctan2(e.u[1], e.u[0]) for e in found], angles, rtol=0, atol=within)
    assert [event.arclength for event in found] == pytest.approx(np.mod(angles, 2.0 * pi), rel=1e-6)
    assert max(abs(event.monitor) for event in found) <= within
    assert max(event.residual_norm for event in found) <= 1e-14


@pytest.mark.parametrize("radius", [1e-2, 1e2])
def test_a_monitor_that_is_zero_at_the_start_sees_a_unit_tangent_behind_it(radius):
    circle = scalar(lambda y, lam: y * y + lam * lam - radius**2, start=(radius, 0.0), target=0.9 * radius)
    upright = [Monitor(lambda u, v: v[-1] - 1.0, "upright")]
    assert trace(circle, events=upright, metric=Euclidean(), direction=1).events == []


def test_the_events_of_the_homotopy_come_too():
    class Own(Cusp):
        events = (TargetValue(0.0, component=0, terminal=0),)

    path = trace(Own(), events=values(1.0, component=0))
    assert [event.name for event in path.events if event.kind == Kind.EVENT] == ["component 0 = 0", "component 0 = 1"]


@pytest.mark.parametrize(
    ("homotopy", "options"),
    [
        # y = -log lam: the parameter falls for ever, ever more slowly.
        (
            scalar(lambda y, lam: np.exp(-y) - lam, lambda y, lam: (-np.exp(-y), -1.0), start=(0.0, 1.0)),
            {"target": None, "events": [TargetValue(600.0, component=0)], "direction": -1},
        ),
        (scalar(lambda y, lam: y - 1.0, lambda y, lam: (1.0, 0.0), start=(1.0, 0.0)), {"events": [TurningPoint(0)]}),
        # lam = 1/2 around a circle, from equations that are mixed by a matrix of condition 1e4.
        (
            from_functions(
                lambda y, lam: (
                    np.array([[1.0, 2.0], [1.0, 2.001]])
                    @ np.stack([y[0] ** 2 + y[1] ** 2 - 1.0, (lam - 0.5) * (2.0 + y[0])])
                ),
                start=([1.0, 0.0], 0.5),
                target=None,
            ),
            {"preset": CONSERVATIVE},
        ),
    ],
    ids=["the parameter dies out", "a component stands still", "the parameter stands still in mixed equations"],
)
def test_no_false_turning_point(homotopy, options):
    assert trace(homotopy, **options).turning_points == []


def test_a_pair_that_the_cubic_between_two_points_does_not_show():
    """lam' = (y - 0.65) (y - 0.7) (1 + y^2) / 5: a quintic, which the looks between the points tell."""
    slope = 0.2 * Polynomial.fromroots([0.65, 0.7]) * Polynomial([1.0, 0.0, 1.0])
    homotopy = scalar(lambda y, at: slope.integ()(y) - at, lambda y, at: (slope(y), -1.0), target=None)
    path = trace(homotopy, events=[TargetValue(1.4, component=0)], **GIANT)
    assert path.u[1, 0] == pytest.approx(0.75, abs=2e-3)
    np.testing.assert_allclose([event.y[0] for event in path.turning_points], [0.65, 0.7], rtol=1e-12)


def test_a_function_that_cubics_know_badly_is_asked_for_a_few_times():
    """It is 1 along the path, and falls to -1e6 beside it, where cubics between points of the path lie."""
    asked = []

    def function(u, v):
        asked.append(u)
        return 1.0 - 1e12 * abs(u[0] ** 2 + u[1] ** 2 - 1.0)

    path = path_of(Circle(), events=[Monitor(function)], target=None, status=Status.CLOSED)
    assert not named(path, "event")
    # 7,300; 169,000 while every arc was divided into 256 parts.
    assert len(asked) <= 15000


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: TargetValue(np.inf), "value: "),
        (lambda: TargetValue(1.0, terminal=-1), "terminal: "),
        (lambda: TargetValue(1.0, direction=2), "direction: "),
        (lambda: TurningPoint(component=0.5), "component: "),
        (lambda: KinkPoint(terminal=-1), "terminal: "),
        (lambda: Monitor(3), "function: "),
        (lambda: Monitor(len, 3), "name: "),
        (lambda: trace(LINE, events=[Monitor(lambda u, v: u)]), "function: expected a real number"),
        (lambda: trace(LINE, events=[Monitor(lambda u, v: 1j)]), "function: expected a real number"),
    ],
)
def test_what_is_no_event_is_named(make, words):
    with pytest.raises((TypeError, ValueError), match=words):
        make()


def test_an_unknown_that_stands_still_but_for_round_off_does_not_turn():
    A, speed = np.random.default_rng(0).normal(size=(3, 3)), np.array([1.0, 0.0, -2.0])
    homotopy = from_functions(
        lambda y, lam: A @ (y - 1.0 - speed * np.sin(3.0 * lam)), start=(np.ones(3), 0.0), target=2.0
    )
    assert trace(homotopy, events=[TurningPoint(1)]).events == []
