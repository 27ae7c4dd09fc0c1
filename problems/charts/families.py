"""Seeded random LCPs of a given matrix class and size."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import scipy.sparse as sp

from continuation.arrays import Array, Matrix
from problems.lcp import LCP

Draw = Callable[[np.random.Generator, int], Matrix]


def semidefinite(random: np.random.Generator, n: int) -> Array:
    """Positive semidefinite of rank n/2 plus skew: monotone, so row sufficient."""
    factor, skew = random.standard_normal((n, max(1, n // 2))), random.standard_normal((n, n))
    return np.asarray(factor @ factor.T / n + (skew - skew.T) / np.sqrt(n))


def scaled_p(random: np.random.Generator, n: int) -> Array:
    """D (positive definite plus skew) E, positive diagonals over two decades: a P-matrix."""
    factor, skew = random.standard_normal((n, n)), random.standard_normal((n, n))
    core = factor @ factor.T / n + 0.1 * np.eye(n) + (skew - skew.T) / np.sqrt(n)
    left, right = (10.0 ** random.uniform(-1.0, 1.0, n) for _ in range(2))
    return np.asarray(left[:, None] * core * right)


def n_matrix(random: np.random.Generator, n: int) -> Array:
    """K - u v', u_i v_i > K_ii, K an M-matrix."""
    K = -random.uniform(0.0, 1.0, (n, n)) / n
    np.fill_diagonal(K, 0.0)
    np.fill_diagonal(K, 0.5 - K.sum(axis=1))
    u = random.uniform(1.0, 2.0, n)
    v = (np.diag(K) + random.uniform(0.1, 1.0, n)) / u
    return np.asarray(K - np.outer(u, v))


def copositive(random: np.random.Generator, n: int) -> Array:
    """Low-rank positive semidefinite plus nonnegative plus skew: strictly copositive."""
    factor, skew = random.standard_normal((n, max(1, n // 4))), random.standard_normal((n, n))
    return np.asarray(factor @ factor.T / n + random.uniform(0.0, 1.0, (n, n)) / np.sqrt(n) + (skew - skew.T) / n)


def indefinite(random: np.random.Generator, n: int) -> Array:
    """Independent normal entries: no class."""
    return np.asarray(random.standard_normal((n, n)) / np.sqrt(n))


def obstacle(random: np.random.Generator, n: int) -> Matrix:
    """Sparse second differences, an M-matrix: string over an obstacle."""
    one = -np.ones(n - 1)
    return sp.csr_array(sp.diags_array([one, np.full(n, 2.0), one], offsets=[-1, 0, 1]))


FAMILIES: Mapping[str, Draw] = {
    "semidefinite": semidefinite, "scaled P": scaled_p, "N": n_matrix, "copositive": copositive,
    "indefinite": indefinite, "obstacle": obstacle,
}  # fmt: skip


def planted(family: str, n: int, seed: int) -> LCP:
    """Draw a problem of `FAMILIES` with a strictly complementary solution."""
    if family not in FAMILIES:
        raise ValueError(f"family: expected one of {', '.join(FAMILIES)}, found {family!r}")
    random = np.random.default_rng([seed, n, list(FAMILIES).index(family)])
    A = FAMILIES[family](random, n)
    values = random.uniform(0.1, 1.0, n)
    basic = random.random(n) < 0.5
    x, w = np.where(basic, values, 0.0), np.where(basic, 0.0, values)
    return LCP(A, w - A @ x)
