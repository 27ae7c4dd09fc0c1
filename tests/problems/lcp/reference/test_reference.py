"""The reference methods do what is known of them: the table of the ten examples, P matrices, rays."""

from contextlib import nullcontext

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings

from problems.lcp import LCP
from problems.lcp.reference import lemke, min_newton, modulus
from problems.lcp.strategies import lcps
from problems.paper import EXAMPLES

SOLVED = [(lemke, (2, 3, 4, 6)), (min_newton, (2, 3, 4, 5, 6, 7, 8)), (modulus, (1, 2))]
"""The table of the ten examples."""


@pytest.mark.parametrize(("method", "solved"), SOLVED)
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: str(example.number))
def test_which_examples_a_method_solves(method, solved, example):
    with nullcontext() if example.number in solved else pytest.raises(ArithmeticError):
        method(example.problem)


@given(lcps("P"))
@settings(deadline=None)
def test_lemke_solves_every_p_matrix(problem):
    x, _ = lemke(problem)
    assert problem.natural_residual(x) <= 1e-8 * (1 + np.abs(problem.q).max())


@pytest.mark.parametrize(
    ("method", "problem", "message"),
    [
        (lemke, LCP([[0, 1], [0, 0]], [-1, 1]), "ray"),
        (lemke, LCP(np.tril(np.full((10, 10), 2.0), -1) + np.eye(10), -np.ones(10)), "within 600 pivots"),
        (modulus, EXAMPLES[5].problem, "singular"),
        (modulus, EXAMPLES[4].problem, "Diverged"),
        (modulus, EXAMPLES[2].problem, "No convergence"),
        # The iterates grow until the residual, 10, is tiny beside them.
        (modulus, EXAMPLES[3].problem, "Diverged"),
        *((method, LCP(make((2, 2)), [-1.0, 1.0]), r"\.") for method in (min_newton, modulus, lemke)
          for make in (np.zeros, sp.csr_array)),
    ],
)  # fmt: skip
def test_a_method_says_how_it_failed(method, problem, message):
    with pytest.raises(ArithmeticError, match=message):
        method(problem)
