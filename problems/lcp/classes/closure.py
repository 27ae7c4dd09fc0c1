"""N-bar and its relatives: limits of matrices whose principal minors have strict signs.

A sign pattern may refute a limit, a perturbation may prove it.
"""

from __future__ import annotations

import itertools
import math
import random

from problems.lcp.classes.exact import ExactMatrix, index_sets, principal_minors
from problems.lcp.classes.membership import Evidence, Membership, matrix_class
from problems.lcp.classes.minors import SIGNS, judge, of_exact_order, two_signs

N_BAR = "Mohan, Parthasarathy and Sridhar, N-bar matrices and the class Q, 1992"
ALMOST_N_BAR = "Neogy and Das, On almost type classes of matrices with Q-property, 2005: the limit of almost N-matrices"
N_BAR_EXACT = "by analogy with Neogy and Das 2005: the limit of N-matrices of exact order k"


Signature = tuple[int, ...]
Rows = tuple[tuple[int, ...], ...]

PERTURBATIONS = 400
"""Perturbations tried before the answer "not decided"."""


@matrix_class("N-bar", N_BAR)
def is_n_bar(matrix: ExactMatrix) -> Membership:
    """N-bar: the limit of N-matrices."""
    return _limit(matrix, matrix.n)


@matrix_class("almost N-bar", ALMOST_N_BAR)
def is_almost_n_bar(matrix: ExactMatrix) -> Membership:
    """Almost N-bar: the limit of almost N-matrices."""
    return _limit(matrix, matrix.n - 1)


@matrix_class("N-bar of exact order k", N_BAR_EXACT)
def is_n_bar_of_exact_order(matrix: ExactMatrix) -> Membership:
    """N-bar of exact order k: the limit of N-matrices of exact order k."""
    return of_exact_order(matrix, lambda last: _limit(matrix, last))


def _limit(matrix: ExactMatrix, last: int) -> Membership:
    weak = judge(matrix, two_signs("nonpositive", last, "nonnegative"))
    if not weak.holds:
        return weak
    if judge(matrix, two_signs("negative", last, "positive")).holds:
        return Membership(True, Evidence("its minors have the strict signs: a constant sequence"))
    signature = _signature(matrix)
    if signature is None and (last >= 3 or last == matrix.n):
        sentence = (
            "no diagonal S of signs makes S A S nonpositive, as one does for every N-matrix (the cycle products of its "
            "submatrices of order 3 are negative), hence for every limit"
        )
        return Membership(False, Evidence(sentence))
    found = _perturbation(matrix, last, signature)
    if found is None:
        sentence = (
            "the minors have the weak signs that a limit needs, "
            f"but none of {PERTURBATIONS} perturbations shows a sequence"
        )
        return Membership(None, Evidence(sentence))
    first, second = found
    sentence = (
        f"A + t B + t^2 C has the strict signs for every small t > 0, "
        f"B = {[list(row) for row in first]}, C = {[list(row) for row in second]}"
    )
    return Membership(True, Evidence(sentence))


def _signature(matrix: ExactMatrix) -> Signature | None:
    """A signature S with S A S <= 0, if any."""
    n, entries = matrix.n, matrix.entries
    pairs = list(itertools.product(range(n), repeat=2))
    signatures = ((1, *signs) for signs in itertools.product((1, -1), repeat=n - 1))
    return next((s for s in signatures if all(s[i] * s[j] * entries[i][j] <= 0 for i, j in pairs)), None)


def _perturbation(matrix: ExactMatrix, last: int, signature: Signature | None) -> tuple[Rows, Rows] | None:
    """Integer B and C for which A + t B + t^2 C has strict signs for small t > 0."""
    rng = random.Random(0)
    n = matrix.n

    def entry(i: int, j: int) -> int:
        if matrix.entries[i][j] or (signature is None and i != j):
            return rng.randint(-3, 3)
        sign = 1 if signature is None else signature[i] * signature[j]
        return -sign * rng.choice((0, 1, 1, 2, 3))

    def direction() -> Rows:
        return tuple(tuple(entry(i, j) for j in range(n)) for i in range(n))

    pairs = ((direction(), direction()) for _ in range(PERTURBATIONS))
    return next((pair for pair in pairs if _strict_nearby(matrix, *pair, last)), None)


def _strict_nearby(matrix: ExactMatrix, first: Rows, second: Rows, last: int) -> bool:
    """Decide the signs of the minors of T^2 A + T B + C for all large T from one T.

    Their integer coefficients are at most n! (a+b+c)^n, for largest entries a, b, c; no root exceeds that plus one
    (Cauchy).
    """
    sizes = (max(abs(v) for row in part for v in row) for part in (matrix.entries, first, second))
    large = 2 + math.factorial(matrix.n) * sum(sizes) ** matrix.n
    rows = [
        [large * (large * a + b) + c for a, b, c in zip(*parts, strict=True)]
        for parts in zip(matrix.entries, first, second, strict=True)
    ]
    minors = principal_minors(rows)
    rule = two_signs("negative", last, "positive")
    return all(SIGNS[rule(mask.bit_count())](minors[mask], 0) for mask in index_sets(matrix.n))
