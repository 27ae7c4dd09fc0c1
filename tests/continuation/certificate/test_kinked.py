"""Proofs of paths with kinks: each switch keeps its sign on each piece, and the kinks are those that are listed."""

import numpy as np
import pytest
from attrs import evolve

from continuation import Budget, Path, certify, trace
from continuation.certificate.certifying import recheck
from continuation.status import Status
from problems.nonlinear import bratu_under_obstacle

from ...util import benchmark
from ..kinks.util import Joined
from .util import proved

corrupted = benchmark("corrupted.py")
drawn = benchmark("subjects.py")


def bent(y, lam, a, b):
    """Two equations with a = |x - 1/2| and b = |lam - 7/10|, or one of their pieces."""
    x, z = y
    return np.stack([x - np.sin(z) - 0.3 * a - lam + 0.15, z - 0.5 * x * x - 0.4 * b - 0.2 * lam + 0.28])


BENT = Joined(
    lambda p, q: lambda y, lam: bent(y, lam, p * (y[0] - 0.5), q * (lam - 0.7)),
    lambda y, lam: np.stack([y[0] - 0.5, lam - 0.7]),
    at=(np.zeros(2), 0.0),
    target=1.5,
)
"""Its path has two kinks, and two turning points between them."""


@pytest.fixture(scope="module")
def path():
    return trace(BENT)


def test_the_kinks_are_isolated(path):
    proof = certify(path, BENT)
    assert proof.complete, str(proof)
    assert [kink.arclength for kink in path.kinks] == [
        pytest.approx(0.5 * (lo + hi), abs=0.5 * (hi - lo)) for lo, hi in proof.kinks
    ]
    assert len(proof.kinks) == len(proof.turning_points) == 2


def test_a_kink_that_is_not_listed_or_none_or_listed_twice_is_a_gap(path):
    first, second = path.kinks
    step = next(s for s in path.steps if s.arclength > path.turning_points[0].arclength)
    none = evolve(first, arclength=step.arclength, u=step.u, step=step.index)
    for events, said in (
        ([event for event in path.events if event is not first], "a kink that the path does not list"),
        ([event for event in path.events if event is not second], "a kink that the path does not list"),
        ([*path.events, none], "a kink is listed where there is none"),
        ([*path.events, first], "more kinks are listed"),
    ):
        assert said in str(certify(evolve(path, events=sorted(events, key=lambda e: e.arclength)), BENT))


@pytest.fixture(scope="module")
def subjects():
    """Homotopies of the library in pieces, with their paths and proofs."""
    return [one for one in corrupted.subjects() if hasattr(one[0], "switches")]


def test_normal_maps_are_proved_through_kinks_in_which_the_parameter_turns(subjects):
    counted = []
    for _, path, proof in subjects:
        assert proof.complete, str(proof)
        assert len(proof.turning_points) == len(path.turning_points)
        counted.append([len(proof.kinks), sum(kink.name == "turning kink" for kink in path.kinks)])
        assert all(lo <= kink.arclength <= hi for (lo, hi), kink in zip(proof.kinks, path.kinks))
    assert counted == [[1, 1], [6, 4], [8, 3]]


@pytest.mark.parametrize(
    "fault", [corrupted.swapped, corrupted.moved, *corrupted.AT_KINKS], ids=lambda fault: fault.__name__
)
def test_what_is_wrong_with_kinks_is_refused(subjects, fault):
    rng = np.random.default_rng(1)
    for homotopy, path, proof in subjects[:2]:
        wrong = fault(homotopy, path, proof, rng)
        assert wrong is None or not certify(wrong, homotopy).complete


def test_several_switches_in_one_kink_are_a_gap_there_alone():
    homotopy = bratu_under_obstacle(9, 2.0, target=6.0)
    path = trace(homotopy)
    proof = certify(path, homotopy)
    tied = [kink.arclength for kink in path.kinks if len(kink.switches) > 1]
    assert [(gap.begin, gap.end, gap.reason) for gap in proof.gaps] == [
        (s, s, "several switches vanish in one kink") for s in tied
    ]
    assert len(tied) == 2


def test_a_proof_of_pieces_is_checked_again(subjects):
    homotopy, path, proof = subjects[1]
    assert recheck(proof.cells, path, homotopy).complete
    thin = proof.cells.with_tubes(1e-9 * proof.cells.radius, proof.cells.slabs)
    assert not recheck(thin, path, homotopy).complete


@pytest.mark.parametrize("seed", [9, 18, 20, 21, 29, 30])
def test_random_paths_with_kinks_are_proved(seed):
    # In 20 a switch vanishes at both ends of a step; in 29 one is 8.5e-4, with tubes as wide, where an arc ends; in 30
    # the cubic behind a kink leads astray, so that the step is halved; in the others the parameter turns within the
    # first step behind a kink, and moves by next to nothing in all.
    homotopy = drawn.cubic(seed)
    path, proof = proved(homotopy, budget=Budget(steps=60))
    assert len(proof.kinks) == len(path.kinks)


def test_a_kink_in_which_a_path_ends_is_a_gap(subjects):
    # The arc that comes does not tell whether the parameter turns there.
    for homotopy, path, _ in subjects:
        for kink in path.kinks:
            events = [event for event in path.events if event.step <= kink.step]
            part = Path(steps=path.steps[: kink.step + 1], events=events, status=Status.STOPPED_AT_EVENT)
            assert [(gap.begin, gap.end) for gap in certify(part, homotopy).gaps] == [(kink.arclength, kink.arclength)]


def test_a_kink_in_which_a_path_begins_is_a_gap(subjects):
    # It would say from where the path came.
    homotopy, path, _ = subjects[1]
    kink = path.kinks[0]
    steps = [evolve(step, index=k) for k, step in enumerate(path.steps[kink.step :])]
    events = [evolve(event, step=event.step - kink.step) for event in path.events if event.step >= kink.step]
    proof = certify(Path(steps=steps, events=events, status=path.status), homotopy)
    assert "a kink is listed where there is none" in str(proof)
