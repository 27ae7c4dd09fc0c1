"""Problems of several benchmarks: an order, and a seed where one is random, to an LCP."""

import numpy as np
import scipy.sparse as sp

from problems.lcp import LCP


def random_planted(n: int, seed: int) -> LCP:
    """A = randn / sqrt(n), neither monotone nor P, with a planted strictly complementary solution."""
    r = np.random.default_rng(seed)
    return _planted(r.standard_normal((n, n)) / np.sqrt(n), r)


def _planted(A: np.ndarray, r: np.random.Generator) -> LCP:
    x = np.maximum(r.standard_normal(len(A)), 0.0)
    w = np.where(x == 0.0, np.abs(r.standard_normal(len(A))), 0.0)
    return LCP(A, w - A @ x)


def obstacle_2d(m: int) -> LCP:
    """A membrane over a bump, five-point differences on m x m points."""
    T = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(m, m), dtype=float)
    eye = sp.eye_array(m, dtype=float)
    A = (sp.kron(T, eye) + sp.kron(eye, T)) * (m + 1.0) ** 2
    t = np.arange(1, m + 1) / (m + 1)
    X, Y = np.meshgrid(t, t)
    obstacle = 0.3 - 3.0 * ((X - 0.5) ** 2 + (Y - 0.5) ** 2)
    return LCP(sp.csr_array(A), A @ obstacle.ravel() + 5.0)
