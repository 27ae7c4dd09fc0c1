"""Guards: a user's own checks of an arc, beside the tracer's."""

import re

import numpy as np
import pytest

from continuation import Budget, Euclidean, Status, TargetValue, from_functions, trace
from continuation.archive import PathLog, resume
from problems.bifurcation import Cusp

from ...util import path_of

circle = from_functions(
    lambda y, lam: np.stack([y[0] ** 2 + lam**2 - 1.0]),
    lambda y, lam: (np.array([[2.0 * y[0]]]), np.array([2.0 * lam])),
    start=([0.6], -0.8),
)


def test_a_step_that_is_refused_is_tried_again_shorter():
    """Here: no arc may turn by more than a given angle, as for a picture of chords."""

    def bent(arc):
        turn = np.degrees(np.arccos(np.clip(arc.a.tangent @ arc.b.tangent, -1.0, 1.0)))
        return f"it turns by {turn:.0f} degrees" if turn > 10.0 else None

    path = path_of(circle, target=0.8, metric=Euclidean(), guards=[bent])
    angles = np.arctan2(path.y[:, 0], path.lam)
    assert np.abs(np.diff(angles)).max() <= np.radians(10.0) * (1.0 + 1e-9)
    refused = [str(r) for step in path.steps for r in step.rejected]
    assert refused
    assert all(re.fullmatch("a guard refuses the arc: it turns by [0-9]+ degrees", said) for said in refused)


def test_the_tracer_stops_where_a_guard_always_refuses():
    path = path_of(
        Cusp(), guards=[lambda arc: "y is above 1" if arc.b.y[0] > 1.0 else ""], status=Status.STEP_TOO_SMALL
    )
    assert "a guard refuses the arc: y is above 1" in path.message
    assert 0.9 < path.endpoint.y[0] <= 1.0


@pytest.mark.parametrize(
    ("homotopy", "options"),
    [(Cusp(), {"target": None, "direction": 1, "events": [TargetValue(0.5)]}), (circle, {"target": 0.3})],
    ids=["terminal event", "target"],
)
def test_it_is_asked_of_what_counts_only_and_points_inside_cost_nothing(homotopy, options):
    """What lies behind the target, or behind a terminal event, is not part of the path."""
    ends, inside = [], []

    def look(arc):
        ends.append(arc.b.lam)
        inside.extend(u for u, _ in arc.samples)

    path = trace(homotopy, guards=[look], **options)
    assert path.success
    assert ends[-1] == path.endpoint.lam
    assert path.counts == trace(homotopy, **options).counts
    assert max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in inside) < 1e-2


@pytest.mark.parametrize(
    ("guards", "words"),
    [
        (lambda arc: "", "guards: expected a list of guards"),
        ([1], "guards: expected guards: functions of an arc"),
        ([lambda arc: True], "guards: expected None, or a string that says why"),
        ([lambda arc: 1.0], "guards: expected None, or a string that says why"),
        ([lambda arc: [].index(arc)], "is not in list"),
    ],
    ids=["no list", "no function", "a bool", "a number", "one that raises"],
)
def test_what_is_no_guard(guards, words):
    with pytest.raises((TypeError, ValueError), match=re.escape(words)):
        trace(circle, target=0.8, guards=guards)


def test_a_resumed_path_needs_them_again(tmp_path):
    def narrow(arc):
        return "long" if np.linalg.norm(arc.b.u - arc.a.u) > 0.3 else ""

    whole = trace(Cusp(), guards=[narrow])
    trace(Cusp(), guards=[narrow], budget=Budget(steps=5), observers=[PathLog(tmp_path / "half.h5")])
    with pytest.raises(Exception, match=r"guards cannot be made from the file .*; pass guards="):
        resume(tmp_path / "half.h5", budget=Budget())
    path = resume(tmp_path / "half.h5", budget=Budget(), guards=[narrow])
    np.testing.assert_array_equal(path.u, whole.u)
