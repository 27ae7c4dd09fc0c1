"""Derivatives of solutions, against differences and by hand."""

from __future__ import annotations

import numpy as np
import pytest

from problems.lcp import LCP, MixedLCP, NotDifferentiableError, solve

from ..util import drawn

H = 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_both_products_agree_with_differences(seed):
    random, n = np.random.default_rng(seed), 7
    problem = drawn(random, n)
    found = solve(problem).sensitivity()
    assert found.differentiable
    dq, dA, g = random.normal(size=n), random.normal(size=(n, n)), random.normal(size=n)
    ends = [solve(MixedLCP(problem.A + h * dA, problem.q + h * dq, problem.lower, problem.upper)).x for h in (H, -H)]
    dx = found.jvp(dq, dA)
    assert dx == pytest.approx((ends[0] - ends[1]) / (2.0 * H), abs=1e-7)
    gradient = found.vjp(g)
    assert not gradient.one_sided
    assert g @ dx == pytest.approx(gradient.q @ dq + (gradient.A * dA).sum(), rel=1e-12)


def test_at_biactive_indices_it_is_one_sided():
    # x = max(-q, 0) at q = 0, in each component for itself.
    found = solve(LCP(np.eye(3), [0.0, -1.0, 2.0])).sensitivity()
    assert found.biactive.tolist() == [0]
    assert found.jvp([1.0, 1.0, 1.0]).tolist() == [0.0, -1.0, 0.0]
    assert found.jvp([-1.0, 1.0, 1.0]) == pytest.approx([1.0, -1.0, 0.0], rel=1e-15)
    assert found.vjp([1.0, 1.0, 1.0]).one_sided


@pytest.mark.parametrize("seed", range(10))
def test_one_sided_derivatives_are_those_of_differences(seed):
    random, place = np.random.default_rng(seed), np.arange(6)
    A = random.normal(size=(6, 6))
    A = A @ A.T + np.eye(6)
    x, w = np.where(place < 2, random.random(6), 0.0), np.where(place < 4, 0.0, random.random(6))
    found = solve(LCP(A, w - A @ x)).sensitivity()
    assert found.biactive.tolist() == [2, 3]
    dq = random.normal(size=6)
    assert found.jvp(dq) == pytest.approx((solve(LCP(A, w - A @ x + H * dq)).x - x) / H, abs=1e-8)


JAMMED = LCP([[-1.0]], [0.0])


@pytest.mark.parametrize(
    ("problem", "message", "dq"),
    [
        (LCP([[1.0, 1.0], [1.0, 1.0]], [-1.0, -1.0]), "A singular where x is off its bounds", None),
        (LCP([[0.0]], [-1.0]), "expected one, found none", None),
        (JAMMED, "found 2 ways", [1.0]),
        (JAMMED, "found no ways", [-1.0]),
    ],
)
def test_what_has_no_derivative_says_so(problem, message, dq):
    found = solve(problem, x0=np.full(problem.n, 0.5))
    with pytest.raises(NotDifferentiableError, match=message):
        found.sensitivity().jvp(dq)
