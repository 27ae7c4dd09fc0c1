"""Exact matrix classes: known members, certificates checked from the definitions, implications between classes."""

from __future__ import annotations

import itertools
import operator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog

from problems.lcp import classes
from problems.lcp.classes import classify
from problems.lcp.classes.simplex import at_least, feasible_point
from problems.lcp.data.problem import LCP
from problems.lcp.reference.enumeration import solve_by_enumeration
from problems.lcp.strategies import CLASSES, matrices
from problems.paper import EXAMPLES

from ....exact import determinant, fractions

ORDERS = st.integers(1, 3)
ANY = st.sampled_from(CLASSES).flatmap(lambda cls: matrices(cls, ORDERS))

HORN = [[1, -1, 1, 1, -1], [-1, 1, -1, 1, 1], [1, -1, 1, -1, 1], [1, 1, -1, 1, -1], [-1, 1, 1, -1, 1]]


KNOWN = [
    ("identity", np.eye(3), {"P", "PSD", "K", "strictly copositive", "E", "Q", "P_*", "nondegenerate", "R0"}, {"N"}),
    ("P, not PSD", [[1, 3], [0, 1]], {"P", "sufficient", "Q"}, {"PSD", "Z"}),
    ("skew", [[0, 1], [-1, 0]], {"PSD", "P0", "sufficient", "Q0"}, {"P", "Q", "R0", "nondegenerate"}),
    ("P0, not row sufficient", [[0, 1], [0, 0]], {"P0", "E0", "copositive"}, {"row sufficient", "P_*", "R0", "S"}),
    ("row, not column sufficient", [[1, 1], [0, 0]], {"row sufficient", "Q0"}, {"column sufficient", "P_*", "Q"}),
    ("column, not row sufficient", [[1, 0], [1, 0]], {"column sufficient"}, {"row sufficient", "sufficient"}),
    ("nondegenerate, not row sufficient", [[1, 1], [1, -1]], {"nondegenerate", "S"}, {"row sufficient", "Q0", "Q"}),
    ("I - 2J", np.eye(4) - 2, {"N", "N0", "N-bar"}, {"almost N", "P0", "Q", "S"}),
    ("N of the first kind", [[-1, 2], [3, -1]], {"N", "Q"}, {"E0", "N of exact order k"}),
    ("almost N", [[-2, 1], [1, -2]], {"almost N", "N of exact order k", "almost N-bar"}, {"N", "N0", "N-bar"}),
    ("N-bar, not N", -np.ones((3, 3)), {"N0", "N-bar"}, {"N", "nondegenerate"}),
    ("N0, not N", -np.ones((3, 3)), {"N0"}, {"N", "nondegenerate"}),
    ("almost N0", [[0, 1, 1], [1, 0, 1], [1, 1, 0]], {"almost N0"}, {"almost N", "N0", "N-bar"}),
    ("almost P", [[1, 2], [2, 1]], {"nondegenerate", "strictly copositive", "Q"}, {"P0"}),
    ("Horn", HORN, {"copositive", "E0"}, {"PSD", "strictly copositive", "P0", "almost copositive"}),
    ("zero", np.zeros((2, 2)), {"PSD", "N0", "copositive", "E0", "Q0", "E0^s"}, {"P", "E", "R0", "Q", "K"}),
    ("Lyusternik", [[2, -1], [-1, 2]], {"K", "P", "PSD", "Z", "E"}, {"N0"}),
]


PAPER = {
    1: ({"N", "nondegenerate", "Q"}, {"P0", "row sufficient"}),
    2: ({"PSD", "P0", "P_*"}, {"nondegenerate", "Q"}),
    3: ({"Q0", "P0", "row sufficient"}, {"nondegenerate", "column sufficient", "Q"}),
    4: ({"E0^s", "E0", "Q0"}, {"P0", "nondegenerate", "Q"}),
    5: ({"nondegenerate"}, {"N", "P0", "Q0"}),
    6: ({"almost copositive", "Z", "nondegenerate", "Q0"}, {"P0", "Q"}),
    7: ({"almost N-bar", "almost N0", "Q"}, {"P0", "nondegenerate", "almost N", "R0"}),
    8: ({"almost N0", "almost N-bar", "S"}, {"P0", "nondegenerate", "Q", "Q0"}),
    9: ({"N0 of exact order k", "S"}, {"P0", "nondegenerate", "N-bar of exact order k", "Q0"}),
    10: ({"N-bar of exact order k", "N0 of exact order k"}, {"P0", "nondegenerate", "S", "Q0"}),
}
"""Of the examples' matrices."""


@pytest.mark.parametrize(
    ("A", "yes", "no"),
    [*(row[1:] for row in KNOWN), *((EXAMPLES[k - 1].A, *expected) for k, expected in PAPER.items())],
    ids=[*(row[0] for row in KNOWN), *PAPER],
)
def test_known_matrices(A, yes, no):
    """Those of the paper too: each class that it prints; only examples 2 and 3 are P0, 1, 5 and 6 nondegenerate."""
    result = classify(A)
    assert {name for name in yes if result[name].holds is not True} == set()
    assert {name for name in no if result[name].holds is not False} == set()


SIGNS = {"P": operator.gt, "P0": operator.ge, "N": operator.lt, "N0": operator.le}
"""How the principal minors of a class compare with zero."""


@given(ANY)
def test_a_violating_minor_is_the_minor_that_it_says(A):
    subsets = [c for order in range(1, len(A) + 1) for c in itertools.combinations(range(len(A)), order)]
    minors = {chosen: determinant(A[np.ix_(chosen, chosen)]) for chosen in subsets}
    result = classify(A)
    for name, compare in SIGNS.items():
        assert result[name].holds == all(compare(value, 0) for value in minors.values())
        if not result[name].holds:
            certificate = result[name].certificate
            assert minors[tuple(certificate.indices)] == certificate.value
            assert not compare(certificate.value, 0)


def reversed_signs(x, p, image):
    return max(p) <= 0 > min(p)


def nonnegative(x, p, image):
    return min(x) >= 0 < max(x)


REFUTES = {
    "copositive": lambda x, p, image: min(x) >= 0 > sum(p),
    "strictly copositive": lambda x, p, image: nonnegative(x, p, image) and sum(p) <= 0,
    "column sufficient": reversed_signs,
    "row sufficient": reversed_signs,
    "E0": lambda x, p, image: nonnegative(x, p, image) and all(v < 0 for u, v in zip(x, p) if u),
    "E": lambda x, p, image: nonnegative(x, p, image) and all(v <= 0 for u, v in zip(x, p) if u),
    "R0": lambda x, p, image: nonnegative(x, p, image) and sum(p) == 0 <= min(image),
    "E0^s": lambda x, p, image: nonnegative(x, p, image) and sum(p) == 0 <= min(image),
}
"""What the definition says of a vector x that shows a matrix not to be of a class, of A x and of x_i (A x)_i."""


@given(ANY)
def test_a_vector_that_refutes_a_class_does_so_by_the_definition(A):
    result = classify(A)
    for name, refutes in REFUTES.items():
        if result[name].holds is False:
            x = result[name].certificate.vector
            image = fractions(A.T if name == "row sufficient" else A) @ x
            assert refutes(x, [v * y for v, y in zip(x, image, strict=True)], image), name
            assert name != "E0^s" or max(fractions(A.T) @ x) > 0
    y, member = result["S"].certificate.vector, result["S"].holds
    image = fractions(A if member else A.T) @ y
    assert min(y) >= 0 < max(y)
    assert min(image) > 0 if member else max(image) <= 0


@given(matrices("any", ORDERS), st.data())
def test_q_and_q0_agree_with_enumeration(A, data):
    """A yes survives random right-hand sides; a no comes with a feasible q next to which there is no solution."""
    n = len(A)
    q0, q = classes.is_q0(A), classes.is_q(A)
    right = np.array([data.draw(st.integers(-5, 5)) for _ in range(n)], dtype=float)
    rows = [at_least(row, -int(v)) for row, v in zip(A.astype(int).tolist(), right, strict=True)]
    solvable = solve_by_enumeration(LCP(A, right)).solvable
    if q.holds:
        assert solvable
    if q0.holds and feasible_point(rows, n) is not None:
        assert solvable
    if not q0.holds:
        witness = q0.certificate.vector
        nearby = np.array([float(v) * (1.0 + share) for v, share in zip(witness, (1e-9, -3e-9, 7e-9))])
        assert linprog(np.zeros(n), A_ub=-A, b_ub=nearby + 1e-12).success
        assert not solve_by_enumeration(LCP(A, nearby)).solvable
