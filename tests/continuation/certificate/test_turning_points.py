"""Where a turning point is listed, the parameter turns."""

from __future__ import annotations

from attrs import evolve

import continuation
from continuation import certify
from problems.bifurcation import FreudensteinRoth


def test_a_turning_point_that_is_listed_elsewhere_on_the_curve_is_a_gap():
    # A range of two cells holds it: at any point of the path in there it was taken for the one that is listed.
    path = continuation.trace(FreudensteinRoth())
    assert all(end - begin < 0.01 for begin, end in certify(path, FreudensteinRoth()).turning_points)
    first, *others = path.events
    for step in path.steps[first.step - 2 : first.step + 3]:
        like = evolve(first, u=step.u, arclength=step.arclength, step=step.index)
        proof = certify(evolve(path, events=[like, *others]), FreudensteinRoth())
        assert "a turning point that the path does not list" in str(proof)
        assert "a turning point is listed where there is none" in str(proof)
