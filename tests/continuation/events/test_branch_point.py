"""Simple branch points: located, told from hairpins, and left on the other branch."""

import numpy as np
import pytest
from attrs import evolve

from continuation import (
    CONSERVATIVE,
    DEFAULT,
    FAST,
    SERIES,
    Budget,
    Kind,
    Status,
    TargetValue,
    branch_directions,
    from_functions,
    switch_branch,
    trace,
)
from continuation.archive import open_archive
from continuation.controllers import Bounds, Fixed
from continuation.metric import Euclidean

from ...util import every_preset, path_of
from ..util import scalar
from .util import branch_points, pitchfork, two_graphs


def transcritical(start):
    return scalar(lambda y, lam: lam * y - y**2, lambda y, lam: (lam - 2.0 * y, y), start=(start, -1.0))


# (y - lam/2)(y^2 + lam^2 - 1) = 0: two branch points, at +-(1, 2) / sqrt 5.
LINE_THROUGH_CIRCLE = from_functions(
    lambda y, lam: (y - 0.5 * lam) * (y * y + lam * lam - 1.0), start=([-1.0], -2.0), target=2.0
)
# y1 (lam + y2) - y1^3 = 0, y2 = lam^2 - y1^2: the branch y1 = 0 meets others at lam = -1 and lam = 0.
TWO_UNKNOWNS = from_functions(
    lambda y, lam: np.array([y[0] * (lam + y[1]) - y[0] ** 3, y[1] - lam**2 + y[0] ** 2]), start=([0.0, 2.25], -1.5)
)


def steps(h):
    return {"controller": Fixed(Bounds(initial=h)), "metric": Euclidean()}


@every_preset
@pytest.mark.parametrize(
    ("homotopy", "options", "expected", "end"),
    [
        *((pitchfork(at), {}, [(0.0, at)], (0.0, 1.0)) for at in (0.0, 0.123, -0.77, 0.999)),
        # A knot may lie in the branch point.
        *((pitchfork(), steps(h), [(0.0, 0.0)], (0.0, 1.0)) for h in (0.5, 0.4, 0.25, 1.0 / 3.0)),
        # The target is in reach of the step that passes the branch point, or before it.
        (pitchfork(0.95), steps(0.5), [(0.0, 0.95)], (0.0, 1.0)),
        (pitchfork(1.05), steps(0.7), [], (0.0, 1.0)),
        *((transcritical(start), {}, [(0.0, 0.0)], (-start, 1.0)) for start in (0.0, -1.0)),
        (LINE_THROUGH_CIRCLE, {}, np.array([[-1.0, -2.0], [1.0, 2.0]]) / np.sqrt(5.0), (1.0, 2.0)),
        (TWO_UNKNOWNS, {"target": 1.0}, [(0.0, 1.0, -1.0), (0.0, 0.0, 0.0)], (0.0, 1.0, 1.0)),
    ],
)
def test_branch_points_are_located_and_the_path_goes_straight_on(homotopy, options, expected, end, preset):
    path = path_of(homotopy, preset=preset, **options)
    assert [event.kind for event in path.events] == [Kind.BRANCH_POINT] * len(expected)
    for event, at in zip(path.events, expected):
        np.testing.assert_allclose(event.u, at, rtol=0, atol=1e-10)
    np.testing.assert_allclose(path.endpoint.u, end, rtol=0, atol=1e-10)
    # The determinant changes its sign in each; at the end it may be left unknown.
    signs = [step.orientation for step in path.steps if step.orientation]
    assert np.count_nonzero(np.diff(signs)) in (len(expected), len(expected) - 1)


def test_steps_that_would_creep_up_to_the_branch_point_pass_it():
    controller = evolve(DEFAULT.controller, bounds=Bounds(maximum=0.25, initial=0.25))
    path = trace(pitchfork(), controller=controller)
    assert (path.status, len(branch_points(path))) == (Status.REACHED_TARGET, 1)
    assert path.counts.rejected < 10


@pytest.mark.parametrize("beside", [0.0, 1e-2, -1e-2, 1e-6, -1e-11])
def test_no_step_ends_beside_a_branch_point(beside):
    """There the next factors are nearly singular."""
    path = trace(pitchfork(beside), **steps(0.5))
    (event,) = branch_points(path)
    assert np.abs(path.arclength - event.arclength).min() > 0.05


LEVELS = [TargetValue(1.0), TargetValue(-1.0)]


@pytest.mark.parametrize(
    ("homotopy", "curve", "options", "line", "ends"),
    [
        (pitchfork(), lambda y, lam: y**2 - lam, {"events": LEVELS}, (1.0, 0.0), {(-1.0, 1.0), (1.0, 1.0)}),
        (transcritical(0.0), lambda y, lam: y - lam, {"events": LEVELS}, (1.0, 1.0), {(-1.0, -1.0), (1.0, 1.0)}),
        (LINE_THROUGH_CIRCLE, lambda y, lam: np.hypot(y, lam) - 1.0, {"budget": Budget(steps=200)}, (2.0, -1.0), None),
    ],
    ids=["pitchfork", "transcritical", "circle from the line"],
)
def test_the_other_branch_is_followed_both_ways(homotopy, curve, options, line, ends):
    path = trace(homotopy)
    event, found = branch_points(path)[0], set()
    known, other = branch_directions(homotopy, event)
    for found_line, wanted in ((known, path.endpoint.u - path.steps[0].u), (other, np.array(line))):
        assert abs(found_line @ wanted) == pytest.approx(np.linalg.norm(wanted) * np.linalg.norm(found_line), abs=1e-9)
    for start in switch_branch(homotopy, event):
        branch = trace(homotopy, start=start, target=None, **options)
        np.testing.assert_allclose(curve(branch.y[:, 0], branch.lam), 0.0, rtol=0, atol=1e-8 if ends else 1e-7)
        assert branch.status is (Status.CLOSED if ends is None else Status.STOPPED_AT_EVENT)
        found.add(tuple(np.round(branch.endpoint.u, 8)))
    assert ends in (None, found)


def test_an_event_of_a_file_is_switched_at_with_its_own_homotopy_alone(tmp_path):
    """With a line that nothing crosses, only that is found; and where H' vanishes altogether, nothing."""
    homotopy = pitchfork(start=(-1.0, 1.0), target=None)
    trace(homotopy, direction=-1, events=[TargetValue(0.5, component=0)], archive=tmp_path / "path.h5")
    with open_archive(tmp_path / "path.h5") as archive:
        (event,) = branch_points(archive[0])
    for u, _ in switch_branch(homotopy, event, 0.1):
        assert abs(u[0]) < 1e-12
        assert abs(u[1]) > 0.01
    flat = evolve(event, u=np.zeros(3), tangent=np.eye(3)[2], weights=np.ones(3), rays=None)
    for function, at in ((lambda y, lam: y - lam, event), (lambda y, lam: y**2 * lam, flat)):
        with pytest.raises(ArithmeticError):
            switch_branch(from_functions(function, start=(at.u[:-1], 0.0)), at, 0.1)


def hairpin(width):
    """A parabola so narrow that a step over its vertex flips the determinant."""
    return scalar(
        lambda y, lam: y * y - width**2 * (1.0 - lam),
        lambda y, lam: (2.0 * y, width**2),
        start=(width, 0.0),
        target=None,
    )


def imperfect(e):
    return scalar(lambda y, lam: lam * y - y**3 + e, start=(0.0, -1.0))


def apart(first, second, bent, distance=1e-6):
    """(y - f)(y - g) = distance^2, from the upper branch: all of H but the constant vanishes where f and g cross."""

    def f(lam):
        return first * lam + bent * np.sin(2.0 * lam)

    def g(lam):
        return second * lam - bent * lam**2

    upper = [0.5 * (f(lam) + g(lam)) + np.hypot(0.5 * (f(lam) - g(lam)), distance) for lam in (-2.0, 2.0)]
    homotopy = two_graphs(f, g, -2.0, apart=distance**2)
    return homotopy, {"start": ([upper[0]], -2.0)}, 0, upper[1]


def ring(a):
    """sin((r - 1) / a) = 0 holds on all circles r = 1 + k pi a."""
    return scalar(lambda y, lam: np.sin((np.sqrt(y**2 + lam**2) - 1.0) / a), start=(1.0, 0.0), target=None)


BACK = {"direction": 1, "events": [TargetValue(0.0)], "metric": Euclidean()}
# The homotopy, options, how many turning points there are, and the end.
NEAR = {
    **{f"a hairpin of {w}": (hairpin(w), BACK, 1, -w) for w in (1e-1, 1e-2, 1e-3)},
    **{
        f"a pitchfork less {e}": (imperfect(e), {}, 0, np.sign(e) * np.roots([-1.0, 0.0, 1.0, abs(e)]).real.max())
        for e in (1e-1, 1e-3, 1e-6, -1e-6, 1e-8)
    },
    **{f"a millionth apart, {c}": apart(*c) for c in ((0.2, -2.2, 0.0), (0.2, -2.2, 0.3), (-1.8, -2.5, 0.1))},
    **{f"circles of {a}": (ring(a), {"budget": Budget(steps=400)}, 2, 1.0) for a in (0.1, 0.02, 0.005)},
    **{
        f"nearly touching by {gap}": (
            two_graphs(lambda t: 0.0 * t, lambda t, gap=gap: t**2 + gap, -1.0, 1.0),
            {},
            0,
            0.0,
        )
        for gap in (1e-2, 1e-4, 1e-6)
    },
}


@pytest.mark.parametrize(
    ("name", "preset"),
    [
        *((name, preset) for name in NEAR for preset in (FAST, DEFAULT, CONSERVATIVE)),
        *((name, SERIES) for name in NEAR if "millionth" in name),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_curves_that_come_near_each_other_do_not_cross(name, preset):
    homotopy, options, turns, end = NEAR[name]
    path = trace(homotopy, preset=preset, **options)
    assert path.success
    assert [event.kind for event in path.events if event.kind != Kind.EVENT] == turns * [Kind.TURNING_POINT]
    np.testing.assert_allclose(path.endpoint.y, [end], rtol=1e-9, atol=1e-10)


@every_preset
def test_every_jacobian_is_counted_in_branch_points_too(preset):
    calls = []

    def jacobian(y, lam):
        calls.append(lam)
        return np.diag(lam - 3.0 * y * y), y

    trunk = from_functions(lambda y, lam: lam * y - y**3, jacobian, start=(np.zeros(1), -1.0), target=1.0)
    path = trace(trunk, preset=preset)
    assert len(branch_points(path)) == 1
    assert path.counts.jacobians == len(calls)
