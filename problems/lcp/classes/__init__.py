"""Exact matrix classes of the LCP, each answer with its evidence.

Floats are rational numbers, so a test in integers is a proof. Beyond a test's order the answer is None.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from problems.lcp.classes.closure import is_almost_n_bar, is_n_bar, is_n_bar_of_exact_order
from problems.lcp.classes.cones import (
    is_almost_copositive,
    is_copositive,
    is_r0,
    is_s,
    is_semimonotone,
    is_semimonotone_star,
    is_strictly_copositive,
    is_strictly_semimonotone,
)
from problems.lcp.classes.exact import ExactMatrix
from problems.lcp.classes.membership import Classification, Evidence, Membership, table
from problems.lcp.classes.minors import (
    is_almost_n,
    is_almost_n0,
    is_k,
    is_n,
    is_n0,
    is_n0_of_exact_order,
    is_n_of_exact_order,
    is_nondegenerate,
    is_p,
    is_p0,
    is_z,
)
from problems.lcp.classes.solvability import is_q, is_q0
from problems.lcp.classes.sufficiency import is_column_sufficient, is_p_star, is_psd, is_row_sufficient, is_sufficient

_TESTS: tuple[Callable[[Any], Membership], ...] = (
    is_psd, is_p, is_p0, is_row_sufficient, is_column_sufficient, is_sufficient, is_p_star, is_z, is_k,
    is_nondegenerate, is_n, is_n0, is_n_bar, is_almost_n, is_almost_n0, is_almost_n_bar,
    is_n_of_exact_order, is_n0_of_exact_order, is_n_bar_of_exact_order,
    is_copositive, is_strictly_copositive, is_almost_copositive, is_semimonotone, is_strictly_semimonotone,
    is_semimonotone_star, is_r0, is_s, is_q0, is_q,
)  # fmt: skip


def classify(A: Any) -> Classification:
    """Test one matrix for every class in exact arithmetic.

    Parameters
    ----------
    A : array_like or scipy sparse, shape (n, n)

    Returns
    -------
    dict of str to Membership
        Beyond the limits of exponential tests (order 12 for minors and index sets, 8 for sign vectors and E0^s, 5 for
        cones) the answer is None.
    """
    matrix = ExactMatrix.of(A)
    return {membership.name: membership for membership in (test(matrix) for test in _TESTS)}


__all__ = [
    "Classification", "Evidence", "ExactMatrix", "Membership", "classify", "is_almost_copositive", "is_almost_n",
    "is_almost_n0", "is_almost_n_bar", "is_column_sufficient", "is_copositive", "is_k", "is_n", "is_n0",
    "is_n0_of_exact_order", "is_n_bar", "is_n_bar_of_exact_order",
    "is_n_of_exact_order", "is_nondegenerate", "is_p", "is_p0", "is_p_star", "is_psd", "is_q", "is_q0", "is_r0",
    "is_row_sufficient", "is_s", "is_semimonotone", "is_semimonotone_star", "is_strictly_copositive",
    "is_strictly_semimonotone", "is_sufficient", "is_z", "table",
]  # fmt: skip
