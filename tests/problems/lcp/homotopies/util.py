"""Homotopies in general position, for the tests of this folder."""

import numpy as np
import pytest
import scipy.sparse as sp

from problems.lcp.data.problem import LCP
from problems.lcp.homotopies import KKTHomotopy
from problems.lcp.homotopies.registry import HOMOTOPIES

ALL = tuple(homotopy.make for homotopy in HOMOTOPIES.values())
every = pytest.mark.parametrize("make", ALL, ids=lambda make: make.__name__)


def made(make, problem, rng):
    """A homotopy with a start in general position, not feasible."""
    x0, other = rng.uniform(0.5, 2.0, (2, problem.n))
    return make(problem, x0, w0=other) if make is KKTHomotopy else make(problem, x0, other)


def interior(rng, homotopy, span):
    """Positive unknowns between 10^-span and 10^span, and a parameter between 10^-span and 1."""
    size = homotopy.start()[0].size
    return 10.0 ** rng.uniform(-span, span, size), float(10.0 ** rng.uniform(-span, 0.0))


def bordered_at(homotopy, y, lam, rng):
    """The bordered system at a point, its matrix, and a right-hand side."""
    border, rhs = rng.standard_normal((2, y.size + 1))
    return homotopy.bordered(y, lam, border), full_matrix(homotopy, y, lam, border), rhs


def full_matrix(homotopy, y, lam, border):
    H_y, H_lam = homotopy.jacobian(y, lam)
    H_y = H_y.toarray() if sp.issparse(H_y) else H_y
    return np.block([[H_y, H_lam[:, None]], [border[None, :]]])


def random_lcp(rng, n, kind="any"):
    B = rng.standard_normal((n, n))
    A = {"any": B, "symmetric psd": B @ B.T, "psd": B @ B.T + B - B.T}[kind]
    return LCP(A, rng.standard_normal(n))
