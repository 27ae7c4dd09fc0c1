"""Positive semidefinite, column and row sufficient, sufficient, P_*."""

from __future__ import annotations

import itertools

from attrs import evolve

from problems.lcp.classes.cones import columns, embed
from problems.lcp.classes.exact import ExactMatrix, Indices, index_sets, indices
from problems.lcp.classes.membership import CPS, MOST_CASES, Evidence, Membership, matrix_class, shown, undecided
from problems.lcp.classes.minors import is_p, is_p0
from problems.lcp.classes.simplex import Point, at_most, positive_point

SUFFICIENT = "Cottle, Pang and Venkateswaran, Linear Algebra Appl. 114/115 (1989) 231-249; " + CPS + ", section 3.5"
VALIAHO = "Väliaho, P_*-matrices are just sufficient, Linear Algebra Appl. 239 (1996) 103-108"


@matrix_class("PSD", CPS + ", section 3.1")
def is_psd(matrix: ExactMatrix) -> Membership:
    """PSD: x'Ax >= 0 for all x: the symmetric part (A + A') / 2 is P0. A may be unsymmetric."""
    found = is_p0(matrix.symmetric_part)
    return evolve(found, certificate=evolve(found.certificate, sentence=f"of (A + A') / 2: {found.certificate}"))


@matrix_class("column sufficient", SUFFICIENT)
def is_column_sufficient(matrix: ExactMatrix) -> Membership:
    """Column sufficient: x_i (Ax)_i <= 0 for all i implies x_i (Ax)_i = 0 for all i."""
    return _sufficient(matrix, "A")


@matrix_class("row sufficient", SUFFICIENT)
def is_row_sufficient(matrix: ExactMatrix) -> Membership:
    """Row sufficient: the transpose is column sufficient.

    Exactly then every KKT point solves LCP(q, A), for all q.
    """
    return _sufficient(matrix.transpose, "A'")


def _sufficient(matrix: ExactMatrix, symbol: str) -> Membership:
    for smaller, test in (("PSD", is_psd), ("P", is_p)):
        if test(matrix).holds:
            return Membership(True, Evidence(f"{smaller}, hence sufficient"))
    if (cases := 3**matrix.n // 2) > MOST_CASES:
        return undecided(cases)
    violation = _reversed_vector(matrix)
    if violation is None:
        sentence = f"no sign pattern of x allows x_i ({symbol}x)_i <= 0 for all i and < 0 for some i"
        return Membership(True, Evidence(sentence))
    support, x = violation
    products = shown([v * y for v, y in zip(x, matrix.image(x), strict=True)])
    sentence = f"x = {shown(x)} has x_i ({symbol}x)_i = {products}"
    return Membership(False, Evidence(sentence, support, vector=x))


def _reversed_vector(matrix: ExactMatrix) -> tuple[Indices, Point] | None:
    """An x with x_i (Ax)_i <= 0 for all i, < 0 for some i."""
    for mask in index_sets(matrix.n):
        support = indices(mask)
        block = columns(matrix, support)
        for signs in ((1, *rest) for rest in itertools.product((1, -1), repeat=len(support) - 1)):
            rows = [[s * t * v for t, v in zip(signs, block[i])] for s, i in zip(signs, support)]
            total = [sum(column) for column in zip(*rows)]
            found = positive_point([*(at_most(row) for row in rows), at_most(total, -1)], len(support))
            if found is not None:
                return support, embed(matrix.n, support, [s * v for s, v in zip(signs, found)])
    return None


@matrix_class("sufficient", SUFFICIENT)
def is_sufficient(matrix: ExactMatrix) -> Membership:
    """Sufficient: row and column sufficient."""
    row, column = is_row_sufficient(matrix), is_column_sufficient(matrix)
    failed = next((part for part in (row, column) if part.holds is False), None)
    if failed is not None:
        return Membership(False, evolve(failed.certificate, sentence=f"not {failed.name}: {failed.certificate}"))
    if row.holds and column.holds:
        return Membership(True, Evidence("row sufficient and column sufficient"))
    return undecided(3**matrix.n // 2)


@matrix_class("P_*", VALIAHO)
def is_p_star(matrix: ExactMatrix) -> Membership:
    """P_*: (1 + 4 kappa) sum_{I+} x_i (Ax)_i + sum_{I-} x_i (Ax)_i >= 0 for all x and some kappa >= 0.

    It equals sufficient (Väliaho 1996), which is tested; the paper's tau is 4 kappa.
    """
    return is_sufficient(matrix)
