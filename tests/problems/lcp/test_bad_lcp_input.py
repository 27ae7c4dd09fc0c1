"""Arguments of `problems.lcp` that cannot be meant: each is refused in one line that names it, before any work."""

from decimal import Decimal

import numpy as np
import pytest
import scipy.sparse as sp

import continuation
from continuation import Budget
from continuation.archive import PathLog
from problems import lcp
from problems.lcp import LCP

A, Q = [[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0]
PROBLEM = LCP(A, Q)
NAN, INF = np.nan, np.inf


def refused(argument, call):
    with pytest.raises((TypeError, ValueError)) as caught:
        call()
    text = str(caught.value)
    assert "\n" not in text
    assert text.startswith(f"{argument}: "), text
    assert len(text) < 400


MATRICES = (
    [[NAN, 1], [1, 2]], [[INF, 1], [1, 2]], np.array(A) + 1j, [["a", "b"], ["c", "d"]], None, [[None, 1], [1, 2]],
    [[1, 2], [3]], [1, 2], 5, np.ones((2, 2, 2)), np.ones((2, 3)), [], np.zeros((0, 0)), {"a": 1}, {1, 2}, len,
    np.ndarray, (row for row in A), np.zeros((2, 2), "M8[s]"), b"abcd", np.zeros((2, 2), [("a", "f8")]), PROBLEM,
    [[10**400, 1], [1, 2]], np.ma.masked_array(A, [[0, 1], [0, 0]]), sp.linalg.aslinearoperator(np.array(A)),
    sp.csr_array(np.array([[NAN, 1], [1, 2]])), sp.csr_array(np.array(A) + 1j), sp.csr_array(np.ones((2, 3))),
    sp.coo_array(np.ones(2)), sp.csr_array((0, 0)), sp.coo_array(([1e308, 1e308], ([0, 0], [0, 0])), shape=(2, 2)),
)  # fmt: skip
VECTORS = (
    [NAN, 1], [INF, 1], [1j, 1], ["a", "b"], None, [None, 1], [1], [1, 2, 3], [[1, 2]], 3.0, [], [True, False],
    {0: 1, 1: 2}, {1, 2}, sp.csr_array([[1.0, 2.0]]), np.ma.masked_array(Q, [0, 1]), [10**400, 1],
    np.zeros(2, "M8[s]"), (value for value in Q), ["-5", "-6"],
)  # fmt: skip


@pytest.mark.parametrize("k", range(len(MATRICES)))
def test_a_matrix(k):
    refused("A", lambda: LCP(MATRICES[k], Q))


@pytest.mark.parametrize("k", range(len(VECTORS)))
def test_a_vector(k):
    refused("q", lambda: LCP(A, VECTORS[k]))


OPTIONS = {
    "homotopy": ("simplex", None, lcp.KKTHomotopy, "KKT", ["kkt"], 3),
    "tolerance": (0, -1e-8, NAN, INF, 1, 2.0, None, "1e-8", np.array([1e-8]), 1e-8j, True, Decimal("1e-8")),
    "restarts": (-1, 2.5, "3", NAN, INF, np.array([3])),
    "seed": (None, "a", -1, 1.5, NAN, np.array([1])),
    "budget": (5, {"steps": 5}, Budget, "5", NAN),
    "x0": ([NAN, 1], [0, 1], [-1, 1], [1], ["a", "b"], [INF, 1], [1j, 1], [[1, 1]], 1.0, [True, True], {}),
    "archive": (5, ["a.h5"], b"a.h5"),
    "finish": ("no", None, 1),
    "executor": (5, "threads"),
    "predictor": (continuation.predictors.Tangent, "tangent"),
    "controller": (continuation.controllers.AllgowerGeorg,),
    "preset": ("fast",),
    "events": (3, [len]),
    "target": (NAN, "zero"),
    "direction": (2, "up"),
}
CASES = [(name, value) for name, values in OPTIONS.items() for value in values]


@pytest.mark.parametrize(("name", "value"), CASES, ids=[f"{name}-{k}" for k, (name, _) in enumerate(CASES)])
@pytest.mark.parametrize("homotopy", ["auto", "kkt"])
def test_an_option_of_solve(name, value, homotopy):
    refused(name, lambda: lcp.solve(PROBLEM, **{"homotopy": homotopy, name: value}))


def test_a_log_is_no_file(tmp_path):
    refused("archive", lambda: lcp.solve(PROBLEM, archive=PathLog(tmp_path / "a.h5")))


OF_A_PROBLEM = {
    "solve": lcp.solve,
    "certify": lambda problem: lcp.certify(problem, [1.0, 1.0]),
    "certify_exactly": lambda problem: lcp.certify_exactly(problem, [1.0, 1.0]),
    "farkas": lcp.farkas,
    "solve_by_enumeration": lcp.solve_by_enumeration,
    "strictly_feasible_start": lcp.strictly_feasible_start,
    **{
        homotopy.__name__: homotopy
        for homotopy in (lcp.KKTHomotopy, lcp.WangHomotopy, lcp.YuHomotopy, lcp.XuHomotopy, lcp.ZhaoHomotopy)
    },
}


@pytest.mark.parametrize("value", [(A, Q), None, LCP, np.array(A), "x"], ids=["pair", "none", "class", "array", "text"])
@pytest.mark.parametrize("function", OF_A_PROBLEM)
def test_no_problem(function, value):
    refused("problem", lambda: OF_A_PROBLEM[function](value))


@pytest.mark.parametrize("x", [[NAN, 1], [INF, 1], [1], [1, 2, 3], [1j, 1], None, "ab", [[1, 1]]], ids=repr)
@pytest.mark.parametrize("certify", [lcp.certify, lcp.certify_exactly], ids=lambda function: function.__name__)
def test_no_point(certify, x):
    refused("x", lambda: certify(PROBLEM, x))


NO_MATRICES = (
    [[NAN]],
    [[1, 2]],
    "x",
    np.zeros((0, 0)),
    [[1j]],
    None,
    [1, 2],
    [[INF]],
    np.ma.masked_array([[1]], [[1]]),
)


@pytest.mark.parametrize("value", NO_MATRICES, ids=repr)
def test_no_matrix_to_classify(value):
    refused("A", lambda: lcp.classify(value))


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
