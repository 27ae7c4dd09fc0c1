"""Proofs up to next to a singular end: few nodes, and none that a step was taken for."""

from __future__ import annotations

import numpy as np
import pytest
from attrs import evolve

from continuation import CONSERVATIVE, certify, trace
from problems.lcp import LCP
from problems.lcp.homotopies import KKTHomotopy

from .util import proved


def degenerate(n, seed):
    """In a third of the indices x and w are both zero at the solution; data of few digits, so that it is exact."""
    rng = np.random.default_rng([seed, n])
    B, K = (rng.integers(-4, 5, size=(n, n)).astype(float) for _ in range(2))
    A = B @ B.T + K - K.T
    kind = np.arange(n) % 3
    x, w = (np.where(kind == k, rng.integers(1, 5, size=n), 0.0) for k in (0, 1))
    return LCP(A, w - A @ x)


@pytest.mark.parametrize(("n", "seed"), [(3, 0), (3, 1), (6, 0), (6, 1), (9, 0), (9, 1), (15, 0), (15, 1)])
def test_a_singular_end_takes_few_boxes(n, seed):
    homotopy = KKTHomotopy(degenerate(n, seed))
    path, proof = proved(homotopy)
    tail = proof.cells.take(proof.cells.place[:, 0] >= path.arclength[-2])
    assert len(tail) <= 10  # of 16 seeds, n = 10 and 15, 4 to 10 under either of two rules for steps
    assert 0.0 < tail.end[-1, -1] <= 1e-6
    assert "rational" in proof.end


def test_nodes_that_tubes_tell_too_wide_are_tested_on_their_own():
    # Bounds of a whole tube tell its curve's end to within more than the next one, which is shorter, has room for.
    rng = np.random.default_rng([3, 8, 7])
    B, x, w = rng.normal(size=(8, 8)), rng.random(8) + 0.3, rng.random(8) + 0.3
    kind = rng.integers(0, 3, size=8)
    A = B @ B.T / 8
    homotopy = KKTHomotopy(LCP(A, np.where(kind == 1, w, 0.0) - A @ np.where(kind == 0, x, 0.0)))
    proved(homotopy)


@pytest.mark.parametrize(("n", "seed"), [(4, 46), (6, 45), (8, 35)])
def test_a_regular_end_to_which_a_series_leads_is_reached(n, seed):
    # No tube reaches it from the last step; it solves no LCP, so that nothing else is proved of it either.
    rng = np.random.default_rng([seed, n])
    homotopy = KKTHomotopy(LCP(rng.normal(size=(n, n)), rng.normal(size=n)))
    path = trace(homotopy)
    assert path.steps[-1].segment is None
    assert not homotopy.certify_end(path.endpoint.y)
    proof = certify(path, homotopy)
    assert proof.complete, str(proof)
    assert "exactly at lam = 0" in proof.end


def test_an_end_on_another_branch_is_a_gap():
    # Next to the target two branches nearly meet, and a series leads across. Tubes join nodes next to that end to it;
    # but between those and the last step there is none.
    rng = np.random.default_rng([44, 4])
    homotopy = KKTHomotopy(LCP(rng.normal(size=(4, 4)), rng.normal(size=4)))
    path = trace(homotopy, preset=CONSERVATIVE)
    assert certify(path, homotopy).complete
    y = np.array([0.0, 0.058, 1.23, 0.0, 0.82, 0.0, 0.0, 1.2, 0.0, 0.0, 1.17, 0.0])
    for _ in range(8):
        y -= np.linalg.solve(homotopy.jacobian(y, 0.0)[0], homotopy.residual(y, 0.0))
    assert np.abs(homotopy.residual(y, 0.0)).max() < 1e-14
    steps = [step for step in path.steps[:-1] if step.lam > 0.006]
    end = evolve(path.steps[-1], index=len(steps), u=np.append(y, 0.0), segment=None, corrector_iterations=0)
    proof = certify(evolve(path, steps=[*steps, end]), homotopy)
    assert any(steps[-1].arclength <= gap.begin < gap.end for gap in proof.gaps)
