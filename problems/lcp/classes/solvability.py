"""Q0 and Q: every feasible, or every, right-hand side is solvable."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from attrs import evolve

from problems.lcp.classes.cones import is_r0, is_s, is_semimonotone
from problems.lcp.classes.exact import ExactMatrix, dot, index_sets, solve
from problems.lcp.classes.membership import CPS, MOST_CASES, Evidence, Membership, matrix_class, shown
from problems.lcp.classes.minors import is_p, is_z
from problems.lcp.classes.simplex import Point, at_most, positive_point
from problems.lcp.classes.sufficiency import is_row_sufficient

LARGEST_COVER = 5
"""Largest order for which complementary cones are subtracted; beyond, `MOST_CASES` programs rarely suffice."""

Normals = list[list[int]]


@matrix_class("Q0", CPS + ", sections 3.2, 3.5 and 3.11")
def is_q0(matrix: ExactMatrix) -> Membership:
    """Q0: LCP(q, A) has a solution whenever it is feasible.

    Z and row sufficient matrices are Q0. Other A of order up to `LARGEST_COVER` are Q0 exactly if the full
    complementary cones cover pos[I, -A]; exact linear programs subtract the cones. A remaining q has a neighbourhood
    that only cones of lower dimension meet: almost no right-hand side in it has a solution.
    """
    for name, test in _SUFFICIENT_FOR_Q0.items():
        if test(matrix).holds:
            return Membership(True, Evidence(f"{name}, hence Q0"))
    return _by_cover(matrix, "every feasible q")


_SUFFICIENT_FOR_Q0: dict[str, Callable[[Any], Membership]] = {"Z": is_z, "row sufficient": is_row_sufficient}


@matrix_class("Q", CPS + ", sections 3.1, 3.2 and 3.9")
def is_q(matrix: ExactMatrix) -> Membership:
    """Q: LCP(q, A) has a solution for every q. Q is Q0 and S; E0 and R0 imply it."""
    s = is_s(matrix)
    if not s.holds:
        return Membership(False, evolve(s.certificate, sentence=f"not S: {s.certificate}"))
    if is_p(matrix).holds:
        return Membership(True, Evidence("P, hence Q with unique solutions"))
    if is_semimonotone(matrix).holds and is_r0(matrix).holds:
        return Membership(True, Evidence("E0 and R0, hence Q"))
    for name, test in _SUFFICIENT_FOR_Q0.items():
        if test(matrix).holds:
            return Membership(True, Evidence(f"S and {name}, hence S and Q0"))
    return _by_cover(matrix, "every q (A is S, so every q is feasible)")


def _by_cover(matrix: ExactMatrix, scope: str) -> Membership:
    if matrix.n > LARGEST_COVER:
        sentence = f"no criterion that we use applies, and the cover of cones is decided up to n = {LARGEST_COVER} only"
        return Membership(None, Evidence(sentence))
    try:
        witness = _leftover(matrix, full_cones(matrix), [], iter(range(MOST_CASES)))
    except StopIteration:
        sentence = f"the complementary cones were not subtracted within {MOST_CASES} linear programs"
        return Membership(None, Evidence(sentence))
    if witness is None:
        return Membership(True, Evidence(f"the full complementary cones cover {scope}"))
    sentence = f"no full complementary cone meets a neighbourhood of the feasible q = {shown(witness)}"
    return Membership(False, Evidence(sentence, vector=witness))


def _leftover(matrix: ExactMatrix, cones: list[Normals], region: Normals, programs: Iterator[int]) -> Point | None:
    """A feasible q of a region that no cone holds, or None if the cones cover the region.

    A region is a list of normals r with r . q > 0. Raises `StopIteration` at the end of `programs`.
    """
    next(programs)
    n, entries = matrix.n, matrix.entries
    through_a = [[sum(r[i] * entries[i][j] for i in range(n)) for j in range(n)] for r in region]
    found = positive_point([at_most([*a, *(-v for v in r)], -1) for a, r in zip(through_a, region)], 2 * n)
    if found is None:
        return None
    q = tuple(b - dot(row, found[:n]) for row, b in zip(entries, found[n:]))
    cone = next((c for c in cones if all(dot(r, q) >= 0 for r in c)), None)
    if cone is None:
        return q
    for i, normal in enumerate(cone):
        rest = _leftover(matrix, cones, [*region, *cone[:i], [-v for v in normal]], programs)
        if rest is not None:
            return rest
    return None


def full_cones(matrix: ExactMatrix) -> list[Normals]:
    """For each full-dimensional complementary cone of A the inner normals of its faces."""
    n = matrix.n
    identity, cones = [[int(i == j) for j in range(n)] for i in range(n)], []
    for mask in (0, *index_sets(n)):
        columns = zip(matrix.transpose.entries, identity)
        chosen = [[-v for v in column] if mask >> j & 1 else unit for j, (column, unit) in enumerate(columns)]
        if (inverse := solve(list(zip(*chosen)), identity)) is not None:
            cones.append(inverse[0])
    return cones
