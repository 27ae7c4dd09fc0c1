"""The exponential-cosine family, on which other tracers jump: the right end and turns, whatever the steps."""

from math import inf

import numpy as np
import pytest
from attrs import evolve

from continuation import CONSERVATIVE, DEFAULT, FAST, Status, trace
from continuation.auditing import audit
from continuation.controllers import Bounds, Fixed
from continuation.metric import Euclidean
from continuation.predictors import Tangent
from continuation.step import acceptance
from problems.bifurcation import ExponentialCosine
from tests.truth import exponential_cosine

# n: x1 at the end, turning points of lam.
TABLE = {
    2: (1.1003509626909, 0), 3: (0.37472756109156, 4), 4: (0.42145547339476, 4), 5: (1.5875828159969, 10),
    6: (1.9949909313114, 12), 7: (2.3730945655736, 18), 8: (0.39859096762391, 24),
}  # fmt: skip


PAPER = Fixed(Bounds(minimum=1e-6, initial=1.0), max_angle=inf)
"""The paper's controller: the longest step first, whatever the angle."""


@pytest.mark.parametrize("n", TABLE)
@pytest.mark.parametrize(
    ("preset", "longest"),
    [(FAST, inf), (FAST, 1.0), (DEFAULT, inf), (DEFAULT, 0.1), (CONSERVATIVE, inf)],
    ids=lambda value: getattr(value, "name", str(value)),
)
def test_the_right_end_and_every_turning_point(n, preset, longest):
    """Steps of a tenth are those of the ceiling, whatever the preset."""
    path = trace(
        ExponentialCosine(n), preset=preset, controller=evolve(preset.controller, bounds=Bounds(maximum=longest))
    )
    x1, turns = TABLE[n]
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.lam == 1.0
    assert path.endpoint.y[0] == pytest.approx(x1, abs=1e-10)
    assert len(path.turning_points) == turns
    expected = exponential_cosine.turning_points(n)
    found = np.array([event.u for event in path.turning_points]).reshape(expected.shape)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)


@pytest.fixture
def unguarded(monkeypatch):
    """The engine without the guards of arcs, their middle and their crossings: with either, little jumps here."""
    monkeypatch.setattr(acceptance, "arc_on_path", lambda solver, arc, distance: arc)
    monkeypatch.setattr(acceptance, "on_arc", lambda *_: None)


@pytest.mark.parametrize("n", [5, 6, 7, 8])
def test_the_guard_keeps_even_the_papers_controller_on_the_path(n):
    path = trace(ExponentialCosine(n), predictor=Tangent(), controller=PAPER)
    assert path.status is Status.REACHED_TARGET
    assert len(path.turning_points) == TABLE[n][1]


@pytest.mark.parametrize("n", [5, 6, 7, 8])
@pytest.mark.usefixtures("unguarded")
def test_the_audit_finds_the_jumps_of_the_papers_controller(n):
    path = trace(ExponentialCosine(n), predictor=Tangent(), controller=PAPER, metric=Euclidean())
    assert path.status is Status.REACHED_TARGET
    assert len(path.turning_points) != TABLE[n][1]
    assert not audit(ExponentialCosine(n), path).same
