"""Data of `problems.lcp` on the edge of what can be meant; all else is in the table `tests/reliability/hostile.py`."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation.archive import PathLog
from problems import lcp
from problems.lcp import LCP

from ...util import refused


def test_a_log_is_no_file(tmp_path):
    refused(
        "archive", lambda: lcp.solve(LCP([[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0]), archive=PathLog(tmp_path / "a.h5"))
    )


@pytest.mark.parametrize(
    ("array", "place", "value"),
    [("indices", 0, 2**31 - 1), ("indices", 0, -1), ("indices", 0, 7), ("indptr", 1, 10**8), ("indptr", 1, -5)],
)
def test_a_sparse_matrix_to_classify_whose_indices_lie_outside(array, place, value):
    matrix = sp.csr_array(np.eye(4))
    getattr(matrix, array)[place] = value
    refused("A", lambda: lcp.classify(matrix))


@pytest.mark.parametrize("options", [{}, {"seed": 7486, "restarts": 2}], ids=["alone", "restarts"])
def test_finite_data_always_has_an_answer(options):
    """A solution of one of its faces is beyond what certifies it, and is no point to complain about."""
    small = 1e-13
    A = [[1.0 - small, 0.0, -1.0 - small], [-2.0 + small, 0.0, 2.0], [-2.0 + small, small, 2.0]]
    found = lcp.solve(LCP(A, [1.0 - small, -small, 1.0 - small]), **options)
    assert not found.success
    assert not lcp.solve_by_enumeration(found.problem).solutions


def test_small_integers_are_classified_as_numbers():
    given = sp.csr_array((np.array([100, 100], np.int8), np.array([0, 0]), np.array([0, 2])), shape=(1, 1))
    assert lcp.classify(given)["P"].holds
