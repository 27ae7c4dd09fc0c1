"""Classes defined by signs of principal minors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

from attrs import evolve

from problems.lcp.classes.exact import ExactMatrix, index_sets, indices
from problems.lcp.classes.membership import CPS, MOST_CASES, Evidence, Membership, matrix_class, show_set, undecided

PAPER = "Dutta, Das and Jana, Bounded Homotopy Path Approach, section 2"
EXACT_ORDER = "Mohan, Parthasarathy and Sridhar, Math. Oper. Res. 19 (1994) 618; " + PAPER

SIGNS: Mapping[str, Callable[[int], bool]] = {
    "positive": lambda value: value > 0,
    "nonnegative": lambda value: value >= 0,
    "negative": lambda value: value < 0,
    "nonpositive": lambda value: value <= 0,
    "nonzero": lambda value: value != 0,
}

Rule = Callable[[int], str]


def two_signs(low: str, last: int, high: str) -> Rule:
    """The rule that minors have the sign `low` up to order `last`, and `high` beyond."""
    return lambda order: low if order <= last else high


def judge(matrix: ExactMatrix, name: str, rule: Rule, cited: str = CPS) -> Membership:
    """Membership by the signs that `rule` requires of principal minors."""
    n = matrix.n
    if 2**n > MOST_CASES:
        return undecided(name, 2**n, cited)
    for mask in index_sets(n):
        sign = rule(mask.bit_count())
        if not SIGNS[sign](matrix.minors[mask]):
            value, alpha = matrix.minor(mask), indices(mask)
            sentence = f"the principal minor of {show_set(alpha)} is {value}, not {sign}"
            return Membership(name, False, Evidence(sentence, alpha, value), cited)
    signs = dict.fromkeys(rule(order) for order in range(1, n + 1))
    return Membership(name, True, Evidence(f"all {2**n - 1} principal minors are {', then '.join(signs)}"), cited)


@matrix_class
def is_p(matrix: ExactMatrix) -> Membership:
    """P: all principal minors positive."""
    return judge(matrix, "P", lambda _: "positive", CPS + ", section 3.3")


@matrix_class
def is_p0(matrix: ExactMatrix) -> Membership:
    """P0: all principal minors nonnegative."""
    return judge(matrix, "P0", lambda _: "nonnegative", CPS + ", section 3.4")


@matrix_class
def is_n(matrix: ExactMatrix) -> Membership:
    """N: all principal minors negative."""
    return judge(matrix, "N", lambda _: "negative", PAPER)


@matrix_class
def is_n0(matrix: ExactMatrix) -> Membership:
    """N0: all principal minors nonpositive."""
    return judge(matrix, "N0", lambda _: "nonpositive", PAPER)


@matrix_class
def is_almost_n(matrix: ExactMatrix) -> Membership:
    """Almost N: proper principal minors negative, determinant positive (exact order 1)."""
    return judge(matrix, "almost N", two_signs("negative", matrix.n - 1, "positive"), PAPER)


@matrix_class
def is_almost_n0(matrix: ExactMatrix) -> Membership:
    """Almost N0: proper principal minors nonpositive, determinant positive (exact order 1)."""
    return judge(matrix, "almost N0", two_signs("nonpositive", matrix.n - 1, "positive"), PAPER)


@matrix_class
def is_n_of_exact_order(matrix: ExactMatrix) -> Membership:
    """N of exact order k: minors negative up to order n - k, positive beyond, for some 1 <= k < n.

    The certificate's value is k.
    """
    return of_exact_order(matrix, "N", _up_to(matrix, "negative"))


@matrix_class
def is_n0_of_exact_order(matrix: ExactMatrix) -> Membership:
    """N0 of exact order k: minors nonpositive up to order n - k, positive beyond, for some k."""
    return of_exact_order(matrix, "N0", _up_to(matrix, "nonpositive"))


def _up_to(matrix: ExactMatrix, low: str) -> Callable[[str, int], Membership]:
    return lambda name, last: judge(matrix, name, two_signs(low, last, "positive"), EXACT_ORDER)


def of_exact_order(matrix: ExactMatrix, base: str, test: Callable[[str, int], Membership]) -> Membership:
    """Test k = 1, ..., n - 1 until one holds; `test` takes the name and n - k."""
    name = f"{base} of exact order k"
    tried = {k: test(name, matrix.n - k) for k in range(1, matrix.n)}
    for k, found in tried.items():
        if found.holds or found.holds is None:
            return evolve(found, certificate=evolve(found.certificate, value=Fraction(k)))
    reasons = "; ".join(f"k = {k}: {found.certificate}" for k, found in tried.items())
    return Membership(name, False, Evidence(reasons or "no k with 1 <= k < n"), EXACT_ORDER)


@matrix_class
def is_nondegenerate(matrix: ExactMatrix) -> Membership:
    """Nondegenerate: all principal minors nonzero."""
    return judge(matrix, "nondegenerate", lambda _: "nonzero", CPS + ", section 3.6")


@matrix_class
def is_z(matrix: ExactMatrix) -> Membership:
    """Z: off-diagonal entries nonpositive."""
    cited = CPS + ", section 3.11"
    pairs = ((i, j) for i, row in enumerate(matrix.entries) for j, entry in enumerate(row) if i != j and entry > 0)
    if (found := next(pairs, None)) is None:
        return Membership("Z", True, Evidence("no off-diagonal entry is positive"), cited)
    value = Fraction(matrix.entries[found[0]][found[1]], matrix.scale)
    return Membership("Z", False, Evidence(f"the off-diagonal entry {found} is {value}, positive", found, value), cited)


@matrix_class
def is_k(matrix: ExactMatrix) -> Membership:
    """K: Z and P (nonsingular M-matrix)."""
    z = is_z(matrix)
    return evolve(z if not z.holds else is_p(matrix), name="K", cited=CPS + ", section 3.11 (Fiedler and Pták 1962)")
