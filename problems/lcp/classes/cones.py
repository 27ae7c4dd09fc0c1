"""Classes defined by signs on vectors.

Each index set needs one exact linear program with x >= 1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from attrs import evolve

from problems.lcp.classes.exact import ExactMatrix, Indices, dot, index_sets, indices
from problems.lcp.classes.membership import (
    CPS,
    MOST_CASES,
    Evidence,
    Membership,
    matrix_class,
    shown,
    shown_set,
    undecided,
)
from problems.lcp.classes.simplex import Constraint, Point, at_least, at_most, exactly, feasible_point, positive_point

Build = Callable[[ExactMatrix, Indices], list[Constraint]]


def columns(matrix: ExactMatrix, support: Indices) -> list[list[int]]:
    """Columns of the index set, row by row."""
    return [[row[j] for j in support] for row in matrix.entries]


def embed(n: int, support: Indices, values: Sequence[Fraction]) -> Point:
    """`values` on the support, else zeros."""
    known = dict(zip(support, values, strict=True))
    return tuple(known.get(i, Fraction(0)) for i in range(n))


def _by_supports(matrix: ExactMatrix, build: Build, words: tuple[str, str]) -> Membership:
    if 2**matrix.n > MOST_CASES:
        return undecided(2**matrix.n)
    for support in map(indices, index_sets(matrix.n)):
        found = positive_point(build(matrix, support), len(support))
        if found is not None:
            x = embed(matrix.n, support, found)
            sentence = f"x = {shown(x)} with support {shown_set(support)} has {words[0]}"
            return Membership(False, Evidence(sentence, support, vector=x))
    return Membership(True, Evidence(words[1]))


def _all_at_most(bound: int) -> Build:
    """(Ax)_i <= bound where x_i > 0."""

    def build(matrix: ExactMatrix, support: Indices) -> list[Constraint]:
        block = columns(matrix, support)
        return [at_most(block[i], bound) for i in support]

    return build


def _homogeneous_solution(matrix: ExactMatrix, support: Indices) -> list[Constraint]:
    block = columns(matrix, support)
    on, off = [at_least(block[i]) for i in support], [at_least(row) for i, row in enumerate(block) if i not in support]
    return [*exactly(on), *off]


@matrix_class("E0", CPS + ", section 3.9")
def is_semimonotone(matrix: ExactMatrix) -> Membership:
    """E0: every nonzero x >= 0 has an i with x_i > 0 and (Ax)_i >= 0."""
    return _by_supports(
        matrix,
        _all_at_most(-1),
        ("(Ax)_i < 0 wherever x_i > 0", "no x has (Ax)_i < 0 wherever x_i > 0"),
    )


@matrix_class("E", CPS + ", section 3.9")
def is_strictly_semimonotone(matrix: ExactMatrix) -> Membership:
    """E: every nonzero x >= 0 has an i with x_i > 0 and (Ax)_i > 0."""
    return _by_supports(
        matrix,
        _all_at_most(0),
        ("(Ax)_i <= 0 wherever x_i > 0", "no x has (Ax)_i <= 0 wherever x_i > 0"),
    )


@matrix_class("R0", CPS + ", section 3.8")
def is_r0(matrix: ExactMatrix) -> Membership:
    """R0: LCP(0, A) has only the zero solution."""
    return _by_supports(
        matrix,
        _homogeneous_solution,
        ("Ax >= 0 and x'Ax = 0: it solves LCP(0, A)", "LCP(0, A) has no nonzero solution"),
    )


@matrix_class("copositive", CPS + ", section 3.8")
def is_copositive(matrix: ExactMatrix) -> Membership:
    """Copositive (C0): x'Ax >= 0 for x >= 0; E0 of the symmetric part (CPS, section 3.9)."""
    return _copositive(matrix, _all_at_most(-1), "nonnegative")


@matrix_class("strictly copositive", CPS + ", section 3.8")
def is_strictly_copositive(matrix: ExactMatrix) -> Membership:
    """Strictly copositive (C): x'Ax > 0 for nonzero x >= 0; E of the symmetric part (CPS, section 3.9)."""
    return _copositive(matrix, _all_at_most(0), "positive")


def _copositive(matrix: ExactMatrix, build: Build, wanted: str) -> Membership:
    words = ("x'Ax of the wrong sign", f"x'Ax is {wanted} for every nonzero x >= 0")
    found = _by_supports(matrix.symmetric_part, build, words)
    x = found.certificate.vector
    if x is None:
        return found
    value = dot(x, matrix.image(x))
    sentence = f"x = {shown(x)} has x'Ax = {value}, not {wanted}"
    return evolve(found, certificate=evolve(found.certificate, sentence=sentence, value=value))


@matrix_class("almost copositive", "Dutta, Das and Jana, Bounded Homotopy Path Approach, section 2")
def is_almost_copositive(matrix: ExactMatrix) -> Membership:
    """Almost C0: not copositive, but all principal submatrices of order n - 1 are."""
    plain = is_copositive(matrix)
    # The support found is one of the smallest.
    almost = plain.holds if plain.holds is None else len(plain.certificate.indices or ()) == matrix.n
    return evolve(plain, holds=almost)


@matrix_class(
    "E0^s", "Dutta, Das and Jana, section 2; Jana, Das and Sinha, On semimonotone star matrices, 2018, ask for E0 too"
)
def is_semimonotone_star(matrix: ExactMatrix) -> Membership:
    """E0^s as the paper prints it: x'Ax = 0, Ax >= 0, x >= 0 imply A'x <= 0.

    Jana, Das and Sinha also require E0.
    """
    if (cases := matrix.n * 2**matrix.n) > MOST_CASES:
        return undecided(cases)
    for mask in index_sets(matrix.n):
        support = indices(mask)
        base = _homogeneous_solution(matrix, support)
        for i, row in enumerate(columns(matrix.transpose, support)):
            found = positive_point([*base, at_least(row, 1)], len(support))
            if found is not None:
                x = embed(matrix.n, support, found)
                value = matrix.transpose.image(x)[i]
                sentence = f"x = {shown(x)} has x'Ax = 0 and Ax >= 0, but (A'x)_{i} = {value}"
                return Membership(False, Evidence(sentence, support, vector=x))
    return Membership(True, Evidence("every solution x of LCP(0, A) has A'x <= 0"))


@matrix_class("S", CPS + ", section 3.1; Ville's theorem")
def is_s(matrix: ExactMatrix) -> Membership:
    """S: Ax > 0 for some x > 0, so every LCP(q, A) is strictly feasible."""
    x = positive_point([at_least(row, 1) for row in matrix.entries], matrix.n)
    if x is not None:
        return Membership(True, Evidence(f"x = {shown(x)} > 0 has Ax > 0", vector=x))
    rows = [at_most(row) for row in matrix.transpose.entries]
    y = feasible_point([*rows, at_least([1] * matrix.n, 1)], matrix.n)
    assert y is not None, "Ville's theorem of the alternative"
    sentence = f"y = {shown(y)} >= 0 is nonzero and A'y <= 0, so no x >= 0 has Ax > 0"
    return Membership(False, Evidence(sentence, vector=y))
