"""Exclusion of faces: each node of a tree fixes some x_i and some w_i at zero.

A Farkas vector may exclude the root; floats with error bounds, or exact arithmetic, exclude the leaves.
"""

from __future__ import annotations

import numpy as np
from attrs import define, field

from problems.lcp.active_set.iteration import Policy
from problems.lcp.data.problem import LCP, active_state
from problems.lcp.proof.farkas import infeasibility, multiplier
from problems.lcp.proof.pieces import all_faces, doubtful
from problems.lcp.proof.verdict import LARGEST_DECIDED
from problems.lcp.reference.branching import Branching
from problems.lcp.reference.enumeration import Exhaustion, decidable, exhaust
from problems.lcp.search.search import Search

LARGEST_LEAVES = 5
"""Up to this order floats exclude all faces in 0.1 ms, quicker than pivots."""

LARGEST_TREE = 40
"""Largest order of the tree: Gaussian problems take up to 1,200 nodes of 0.2 ms at n = 40; at n = 60 2 to 7 s, where
restarts take 0.6 s."""

LARGEST_PROOF = 30_000_000
"""Largest order times entries of the linear program for a Farkas vector: two seconds for order 300."""

TRIED = "All complementary faces were tried: excluded by floats with error bounds, or decided in exact arithmetic."


def groupable(search: Search) -> bool:
    """Whether the tree applies: a small dense LCP that scaling did not round."""
    problem = search.problem
    if search.finish is None or not isinstance(problem, LCP) or problem.sparse or problem.n > LARGEST_TREE:
        return False
    return search.scaled is None or search.scaled.exact


def few_faces(search: Search) -> bool:
    """Whether all faces are tried together."""
    return search.problem.n <= LARGEST_LEAVES and groupable(search)


@define(eq=False)
class Leaves:
    """All faces of a small problem."""

    search: Search

    def run(self, work: float) -> str:
        """Try up to `work` faces that floats do not exclude."""
        n, plain = self.search.problem.n, self.search.problem
        every = all_faces(n)
        left = np.flatnonzero(doubtful(plain, every.astype(np.int8) - 1))
        if not left.size:
            self.search.exhaustion = Exhaustion(None, len(every))
        found = any(self.search.settle(active_state(face), Policy(steps=0)) for face in every[left[: int(work)]])
        return TRIED if found or not left.size else ""


def decide(search: Search) -> bool:
    """Try all faces exactly; return whether floats hold a solution."""
    return taken(search, exhaust(search.problem, filtered=True))


def taken(search: Search, found: Exhaustion) -> bool:
    """Record an exhaustion; return whether floats hold its solution."""
    search.exhaustion = found
    return found.point is not None and bool(np.isfinite(found.point).all()) and search.accept(found.point)


@define(eq=False)
class Exclusion:
    """One problem's tree."""

    search: Search
    tree: Branching | None = field(default=None, init=False)
    sought: bool = field(default=False, init=False)

    def run(self, work: float) -> str:
        """Branch on groups of faces, up to `work` nodes of the tree, and try the leaves.

        With 0 seek one Farkas vector that excludes all faces.
        """
        search = self.search
        if work and groupable(search) and self._branched(int(work)):
            assert self.tree is not None
            if search.proof is None:
                return f"The complementary faces were enumerated in groups, by {self.tree.nodes} linear programs."
        elif not self.sought and (self.tree is None or not self.tree.open):
            A = search.problem.A
            self.sought = A.shape[0] * (A.nnz if search.problem.sparse else A.size) <= LARGEST_PROOF
            search.proof = infeasibility(search.problem) if self.sought else search.proof
        if search.proof is not None:
            return "A linear program gave the proof."
        if not work or search.finish is None or not decidable(search.problem, LARGEST_DECIDED):
            return ""
        decide(search)
        return TRIED

    def _branched(self, nodes: int) -> bool:
        search, problem = self.search, self.search.problem
        if self.tree is None:
            assert isinstance(problem, LCP)
            self.tree = Branching(problem, lambda active: search.settle(active_state(active)))
        found = self.tree.run(nodes)
        if found is None:
            return self.tree.accepted
        root = None if found.groups is None else found.groups.root
        search.proof = None if root is None else multiplier(problem, root)
        if search.proof is None:
            taken(search, found)
        return True
