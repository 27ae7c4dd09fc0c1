"""Memberships: of every form of a matrix, said in words, undecided with the reason, refused by name."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from problems.lcp.classes import classify


@pytest.mark.parametrize(
    "cast", [np.asarray, sp.csr_array, sp.coo_array, lambda a: a.astype(np.int64), lambda a: a.tolist()]
)
def test_every_form_of_the_same_matrix_has_the_same_classes(cast):
    A = np.array([[2.0, -1.0], [0.0, 3.0]])
    assert classify(cast(A)) == classify(A)


def test_beyond_the_limits_the_answer_is_not_decided_with_the_reason():
    result = classify(np.eye(13) + np.triu(np.ones((13, 13)), 1) * 9)
    assert "stops at 4096 cases, found 8192" in str(result["P"])
    decided = {name: result[name].holds for name in ("P", "Z", "PSD", "row sufficient", "Q")}
    assert decided == {"P": None, "Z": False, "PSD": None, "row sufficient": None, "Q": None}
