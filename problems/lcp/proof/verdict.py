"""What may be said of a point: whether it is a solution, and whether it is stationary."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array
from problems.lcp.data.problem import MixedLCP
from problems.lcp.homotopies.starts import natural_units
from problems.lcp.proof.certificate import Certificate, certify_exactly

LARGEST_DECIDED = 12
"""Up to this order all faces are tried in exact arithmetic, within about a second, before the first restart; and what
solves a problem to the tolerance but not to round-off is called a solution only if exact arithmetic agrees."""

ENTRIES = 2 * float(np.finfo(float).eps)
"""A relative residual below this is within rounding: half an eps for x, and half for each factor that gave the entries
their units, of a row and of a column; the last half is for their products."""

STATIONARY = 1e-6
"""Relative to their terms: how well the optimality conditions hold at what is called stationary.

A degenerate end is a series in the root of lambda, so that half of the digits of a good end can be asked of it.
"""

NEARLY = 1e-5
"""An end that solves the problem to this but not to the tolerance is an inaccurate solution, not a stationary point."""


def confirmed(problem: MixedLCP, certificate: Certificate, tolerance: float) -> bool:
    """Whether the point may be called a solution.

    One that passes `Certificate.solves`; but of a small problem, where that is cheap, exact arithmetic has to agree
    unless its rows are off by no more than the rounding of the entries.

    Parameters
    ----------
    problem : MixedLCP
    certificate : Certificate
        Of the point.
    tolerance : float
        Of its relative residual.
    """
    if not certificate.solves(tolerance):
        return False
    if certificate.relative_residual <= ENTRIES or problem.n > LARGEST_DECIDED:
        return True
    return certify_exactly(problem, certificate.x).solves


def stationary(problem: MixedLCP, y: Array) -> bool:
    """Whether y = (x, z1, z2) satisfies the optimality conditions of min x'(A x + q) over x >= 0, A x + q >= 0.

    That is (A + A') x + q = z1 + A' z2, x, w, z1, z2 >= 0, x_i z1_i = 0 and w_i z2_i = 0: relative to the sizes of x,
    w, z1 and z2, so that a common factor of A and q, and one of q alone, makes no difference.
    """
    if y.size != 3 * problem.n or not problem.standard:
        return False
    x, z1, z2 = np.split(y, 3)
    w = problem.w(x)
    unit_x, unit_w = natural_units(problem)
    size_x = unit_x + max(float(np.abs(x).max()), float(np.abs(z2).max()))
    size_w = unit_w + max(float(np.abs(w).max()), float(np.abs(z1).max()), unit_w / unit_x * size_x)
    gradient = w + problem.A.T @ x - z1 - problem.A.T @ z2
    lowest = min(float(min(x.min(), z2.min())) / size_x, float(min(w.min(), z1.min())) / size_w)
    products = max(float(np.abs(x * z1).max()), float(np.abs(w * z2).max())) / (size_x * size_w)
    return max(float(np.abs(gradient).max()) / size_w, products, -lowest) <= STATIONARY
