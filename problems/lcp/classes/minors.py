"""Classes defined by signs of principal minors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from operator import ge, gt, le, lt, ne

from attrs import evolve

from problems.lcp.classes.exact import ExactMatrix, index_sets, indices
from problems.lcp.classes.membership import CPS, MOST_CASES, Evidence, Membership, matrix_class, shown_set, undecided

PAPER = "Dutta, Das and Jana, Bounded Homotopy Path Approach, section 2"
EXACT_ORDER = "Mohan, Parthasarathy and Sridhar, Math. Oper. Res. 19 (1994) 618; " + PAPER

SIGNS: Mapping[str, Callable[[int, int], bool]] = {
    "positive": gt, "nonnegative": ge, "negative": lt, "nonpositive": le, "nonzero": ne,
}  # fmt: skip
"""Whether a minor compares with zero as the sign says."""

Rule = Callable[[int], str]


def two_signs(low: str, last: int, high: str) -> Rule:
    """The rule that minors have the sign `low` up to order `last`, and `high` beyond."""
    return lambda order: low if order <= last else high


def judge(matrix: ExactMatrix, rule: Rule) -> Membership:
    """Membership by the signs that `rule` requires of principal minors."""
    n = matrix.n
    if 2**n > MOST_CASES:
        return undecided(2**n)
    for mask in index_sets(n):
        sign = rule(mask.bit_count())
        if not SIGNS[sign](matrix.minors[mask], 0):
            value, alpha = matrix.minor(mask), indices(mask)
            sentence = f"the principal minor of {shown_set(alpha)} is {value}, not {sign}"
            return Membership(False, Evidence(sentence, alpha, value))
    signs = dict.fromkeys(rule(order) for order in range(1, n + 1))
    return Membership(True, Evidence(f"all {2**n - 1} principal minors are {', then '.join(signs)}"))


@matrix_class("P", CPS + ", section 3.3")
def is_p(matrix: ExactMatrix) -> Membership:
    """P: all principal minors positive."""
    return judge(matrix, lambda _: "positive")


@matrix_class("P0", CPS + ", section 3.4")
def is_p0(matrix: ExactMatrix) -> Membership:
    """P0: all principal minors nonnegative."""
    return judge(matrix, lambda _: "nonnegative")


@matrix_class("N", PAPER)
def is_n(matrix: ExactMatrix) -> Membership:
    """N: all principal minors negative."""
    return judge(matrix, lambda _: "negative")


@matrix_class("N0", PAPER)
def is_n0(matrix: ExactMatrix) -> Membership:
    """N0: all principal minors nonpositive."""
    return judge(matrix, lambda _: "nonpositive")


@matrix_class("almost N", PAPER)
def is_almost_n(matrix: ExactMatrix) -> Membership:
    """Almost N: proper principal minors negative, determinant positive (exact order 1)."""
    return judge(matrix, two_signs("negative", matrix.n - 1, "positive"))


@matrix_class("almost N0", PAPER)
def is_almost_n0(matrix: ExactMatrix) -> Membership:
    """Almost N0: proper principal minors nonpositive, determinant positive (exact order 1)."""
    return judge(matrix, two_signs("nonpositive", matrix.n - 1, "positive"))


@matrix_class("N of exact order k", EXACT_ORDER)
def is_n_of_exact_order(matrix: ExactMatrix) -> Membership:
    """N of exact order k: minors negative up to order n - k, positive beyond, for some 1 <= k < n.

    The certificate's value is k.
    """
    return of_exact_order(matrix, lambda last: judge(matrix, two_signs("negative", last, "positive")))


@matrix_class("N0 of exact order k", EXACT_ORDER)
def is_n0_of_exact_order(matrix: ExactMatrix) -> Membership:
    """N0 of exact order k: minors nonpositive up to order n - k, positive beyond, for some k."""
    return of_exact_order(matrix, lambda last: judge(matrix, two_signs("nonpositive", last, "positive")))


def of_exact_order(matrix: ExactMatrix, test: Callable[[int], Membership]) -> Membership:
    """Test k = 1, ..., n - 1 until one holds; `test` takes n - k."""
    tried = {k: test(matrix.n - k) for k in range(1, matrix.n)}
    for k, found in tried.items():
        if found.holds or found.holds is None:
            return evolve(found, certificate=evolve(found.certificate, value=Fraction(k)))
    reasons = "; ".join(f"k = {k}: {found.certificate}" for k, found in tried.items())
    return Membership(False, Evidence(reasons or "no k with 1 <= k < n"))


@matrix_class("nondegenerate", CPS + ", section 3.6")
def is_nondegenerate(matrix: ExactMatrix) -> Membership:
    """Nondegenerate: all principal minors nonzero."""
    return judge(matrix, lambda _: "nonzero")


@matrix_class("Z", CPS + ", section 3.11")
def is_z(matrix: ExactMatrix) -> Membership:
    """Z: off-diagonal entries nonpositive."""
    pairs = ((i, j) for i, row in enumerate(matrix.entries) for j, entry in enumerate(row) if i != j and entry > 0)
    if (found := next(pairs, None)) is None:
        return Membership(True, Evidence("no off-diagonal entry is positive"))
    value = Fraction(matrix.entries[found[0]][found[1]], matrix.scale)
    return Membership(False, Evidence(f"the off-diagonal entry {found} is {value}, positive", found, value))


@matrix_class("K", CPS + ", section 3.11 (Fiedler and Pták 1962)")
def is_k(matrix: ExactMatrix) -> Membership:
    """K: Z and P (nonsingular M-matrix)."""
    z = is_z(matrix)
    return z if not z.holds else is_p(matrix)
