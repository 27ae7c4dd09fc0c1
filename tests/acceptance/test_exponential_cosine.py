"""The exponential-cosine family, on which other tracers jump, with the controller of the paper that published it."""

from math import inf

import pytest

from continuation.auditing import audit
from continuation.controllers import Bounds, Fixed
from continuation.metric import Euclidean
from continuation.predictors import Tangent
from continuation.step import acceptance
from problems.bifurcation import ExponentialCosine

from ..util import path_of

TURNS = {5: 10, 6: 12, 7: 18, 8: 24}
"""By order: the number of turning points."""

PAPER = Fixed(Bounds(minimum=1e-6, initial=1.0), max_angle=inf)
"""The paper's controller: the longest step first, whatever the angle."""


@pytest.fixture
def unguarded(monkeypatch):
    """The engine without the guards of arcs, their middle and their crossings: with either, little jumps here."""
    monkeypatch.setattr(acceptance, "arc_on_path", lambda solver, arc, distance: arc)
    monkeypatch.setattr(acceptance, "on_arc", lambda *_: None)


@pytest.mark.parametrize("n", TURNS)
def test_the_guard_keeps_even_the_papers_controller_on_the_path(n):
    path = path_of(ExponentialCosine(n), predictor=Tangent(), controller=PAPER)
    assert len(path.turning_points) == TURNS[n]


@pytest.mark.parametrize("n", TURNS)
@pytest.mark.usefixtures("unguarded")
def test_the_audit_finds_the_jumps_of_the_papers_controller(n):
    path = path_of(ExponentialCosine(n), predictor=Tangent(), controller=PAPER, metric=Euclidean())
    assert len(path.turning_points) != TURNS[n]
    assert not audit(ExponentialCosine(n), path).same
