"""Time steps of many bodies in contact: two of each family and size of the benchmark, by work that no clock counts."""

import pytest

from problems import lcp

from ....util import benchmark


@pytest.mark.parametrize("family", ["stacks", "arches", "piles"])
def test_bodies_in_contact_are_solved_without_a_path(family, monkeypatch):
    bodies = benchmark("lcp/bodies.py")
    monkeypatch.setattr(bodies, "EACH", (2, 2, 2))
    for A, q in getattr(bodies, family)(46):
        found = lcp.solve(lcp.LCP(A, q))
        assert found.solved
        assert found.relative_residual < 1e-11
        assert not found.paths
        assert found.counts.factorizations < 60
