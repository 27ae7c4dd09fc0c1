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


@pytest.mark.parametrize("guarded", [True, False])
@pytest.mark.parametrize("n", TURNS)
def test_the_guards_keep_even_the_papers_controller_on_the_path_and_the_audit_finds_its_jumps(monkeypatch, n, guarded):
    """The guards of arcs, their middle and their crossings: with either, little jumps here."""
    if not guarded:
        monkeypatch.setattr(acceptance, "arc_on_path", lambda solver, arc, distance: arc)
        monkeypatch.setattr(acceptance, "on_arc", lambda *_: None)
    metric = None if guarded else Euclidean()
    path = path_of(ExponentialCosine(n), predictor=Tangent(), controller=PAPER, metric=metric)
    assert (len(path.turning_points) == TURNS[n]) is guarded
    assert guarded or not audit(ExponentialCosine(n), path).same
