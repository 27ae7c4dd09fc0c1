"""The reference methods do what is known of them: the table of the ten examples, P matrices, rays."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings

from problems.lcp import LCP
from problems.lcp.reference import lemke, min_newton, modulus
from problems.lcp.strategies import lcps
from problems.paper import EXAMPLES


def solved_by(method):
    return [example.number for example in EXAMPLES if method(example.problem).solved]


def test_the_table_of_the_ten_examples():
    assert solved_by(lemke) == [2, 3, 4, 6]
    assert solved_by(min_newton) == [2, 3, 4, 5, 6, 7, 8]
    assert solved_by(modulus) == [1, 2]


@given(lcps("P"))
@settings(deadline=None)
def test_lemke_solves_every_p_matrix(problem):
    result = lemke(problem)
    assert result.solved
    assert result.residual == problem.natural_residual(result.x) <= 1e-8 * (1 + np.abs(problem.q).max())
    np.testing.assert_array_equal(result.w, problem.w(result.x))


@pytest.mark.parametrize(
    ("problem", "said"),
    [
        (LCP([[0, 1], [0, 0]], [-1, 1]), "ray"),
        (LCP(np.tril(np.full((10, 10), 2.0), -1) + np.eye(10), -np.ones(10)), "within 600 pivots"),
    ],
)
def test_lemke_says_how_it_failed(problem, said):
    result = lemke(problem)
    assert not result.solved
    assert said in result.message


@pytest.mark.parametrize("make", [np.zeros, sp.csr_array])
@pytest.mark.parametrize("method", [min_newton, modulus, lemke])
def test_singular_systems_are_survived(make, method):
    assert not method(LCP(make((2, 2)), [-1.0, 1.0])).solved


def test_modulus_says_how_it_failed():
    assert "singular" in modulus(EXAMPLES[5].problem).message
    assert "Diverged" in modulus(EXAMPLES[4].problem).message
    assert "No convergence" in modulus(EXAMPLES[2].problem).message
    assert "singular" in modulus(LCP(sp.csr_array([[-1.0]]), [1.0])).message


def test_a_diverging_iterate_is_not_called_solved():
    """On example 4 the modulus iterates grow until the residual, 10, is tiny beside them."""
    result = modulus(EXAMPLES[3].problem)
    assert EXAMPLES[3].problem.relative_residual(result.x) < 1e-8
    assert not result.solved
