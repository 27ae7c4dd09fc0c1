"""Matrices in every form, and functions that several tests of problems use."""

import numpy as np
import scipy.sparse as sp

from problems.lcp.homotopies.registry import HOMOTOPIES

from ..util import tridiagonal

BOUNDED = [name for name, one in HOMOTOPIES.items() if one.bounds]
"""The homotopies for LCPs with bounds."""


def chain(n):
    """A tridiagonal M-matrix."""
    return sp.diags_array([np.full(n - 1, -1.0), np.full(n, 2.5), np.full(n - 1, -1.0)], offsets=[-1, 0, 1])


FORMS = {"dense": lambda A: A.toarray(), "csr": sp.csr_array, "csc": sp.csc_array, "banded": tridiagonal}
"""Of the same tridiagonal matrix."""


def cubic(x):
    """A chain of cubic springs."""
    return chain(x.size) @ x + x**3 - 1.0


def cubic_slope(form, x):
    """Its derivative."""
    return FORMS[form](chain(x.size) + sp.diags_array(3.0 * x**2))


def exponential(x):
    return np.exp(x) - np.array([2.0, 0.5, 3.0, 1.5, 9.0])


BOX = {"lower": [0, 0, -np.inf, -5, 0], "upper": [1, 9, np.inf, np.inf, 1]}
"""Bounds of five unknowns."""


def kojima_shindo(x):
    """The problem of Kojima and Shindo (1986), with two solutions, of which one is degenerate."""
    a, b, c, d = x
    return np.stack([
        3 * a * a + 2 * a * b + 2 * b * b + c + 3 * d - 6, 2 * a * a + a + b * b + 10 * c + 2 * d - 2,
        3 * a * a + a * b + 2 * b * b + 2 * c + 9 * d - 9, a * a + 3 * b * b + 2 * c + 3 * d - 3,
    ])  # fmt: skip
