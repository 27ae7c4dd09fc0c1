"""Where a turning point is listed, the parameter turns."""

from __future__ import annotations

import numpy as np
import pytest
from attrs import evolve

import continuation
from continuation import Path, Step, certify, from_functions
from continuation.certificate.certifying import recheck
from continuation.status import Status
from problems.bifurcation import ExponentialCosine, FreudensteinRoth

from .util import proved


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


@pytest.mark.parametrize("e", [3e-2, 1e-2, 3e-3, 1e-3, 3e-4])
def test_two_turning_points_next_to_each_other_are_told_apart(e):
    # Of lam = y^3 - 3 e^2 y: within 4 e^3 of the parameter, 1e-1 to 1e-10, and in one step.
    homotopy = from_functions(
        lambda y, lam: np.stack([y[0] ** 3 - 3.0 * e * e * y[0] - lam]), start=([-1.0], 3.0 * e * e - 1.0), target=1.0
    )
    path, proof = proved(homotopy)
    first, second = path.turning_points
    assert first.step == second.step
    assert len(proof.turning_points) == 2
    assert recheck(proof.cells, path, homotopy).turning_points == proof.turning_points


def test_a_pair_as_near_as_round_off_allows_is_proved_whole_or_not_at_all():
    # Within 3e-8 of the parameter, where cells of 1/256 of the step are the shortest: under two of four kernels of
    # OpenBLAS no tube holds the step, under the others both turning points are proved.
    homotopy = ExponentialCosine(10)
    whole = continuation.trace(homotopy)
    k = next(a.step for a, b in zip(whole.turning_points, whole.turning_points[1:]) if abs(a.lam - b.lam) < 1e-7)
    steps = [evolve(step, index=j) for j, step in enumerate(whole.steps[k - 1 : k + 1])]
    events = [evolve(event, step=1) for event in whole.events if event.step == k]
    path = evolve(whole, steps=steps, events=events, status=Status.STOPPED_AT_EVENT)
    proof = certify(path, homotopy)
    assert len(proof.turning_points) == 2 if proof.complete else proof.gaps


PARABOLA = from_functions(lambda y, lam: lam + y * y - 2.0, start=([-1.0], 1.0), target=None)


@pytest.mark.parametrize("ys", [(-0.1, 0.1), (-0.1, 0.5), (-0.1, -0.025, 0.05), (-0.1, 0.2, 0.5), (-0.5, -0.3, 0.1)])
def test_a_turning_point_next_to_an_end_has_to_be_listed_too(ys):
    # Where a tube had no sign of the tangent up to an end of the path, the turning point in it did not count.
    steps = [Step(k, np.array([y, 2.0 - y * y]), np.array([1.0, -2.0 * y]), arclength=y) for k, y in enumerate(ys)]
    path = Path(steps=[evolve(s, corrector_iterations=1) for s in steps], status=Status.STOPPED_AT_EVENT)
    proof = certify(path, PARABOLA)
    assert "a turning point that the path does not list" in str(proof)
    assert len(proof.turning_points) == 1
    up_to_it = Path(steps=[*path.steps[:1], Step(1, np.array([0.0, 2.0]), np.array([1.0, 0.0]), 0.0)])
    assert certify(up_to_it, PARABOLA).complete
