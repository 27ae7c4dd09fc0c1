"""Problems whose piecewise linear paths are known."""

import numpy as np

from continuation.arrays import Array
from continuation.path import Path
from problems.lcp import LCP
from problems.scenes.lasso import penalised


def murty(n: int) -> LCP:
    """With d = e its path visits all 2^n faces."""
    q = -np.array([sum(2.0 ** (n - j) for j in range(1, i + 1)) for i in range(1, n + 1)])
    return LCP(np.tril(np.full((n, n), 2.0), -1) + np.eye(n), q)


def lasso(X: Array, y: Array) -> Path:
    """The path of min 1/2 |X b - y|^2 + t |b|_1 from the least t with b = 0 on, to 0."""
    return penalised(X.T @ X, X.T @ y)


def mairal_yu(p: int) -> tuple[Array, Array]:
    """Of p unknowns, with (3^p - 1) / 2 kinks."""
    X, y, least = np.eye(1), np.ones(1), 1.0
    for _ in range(p - 1):
        a = least / (2.0 * (2.0 * y @ y + 1.0))
        X = np.block([[X, (2.0 * a * y)[:, None]], [np.zeros((1, X.shape[1])), np.full((1, 1), a)]])
        y = np.append(y, 1.0)
        least = lasso(X, y).kinks[-1].lam
    return X, y


def integer_problem(seed: int) -> tuple[LCP, Array]:
    """Of integers so small that switches often vanish together."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 7))
    A = random.integers(-2, 3, (n, n)).astype(float)
    A = A @ A.T if seed % 3 == 0 else A
    return LCP(A, random.integers(-3, 4, n)), random.integers(1, 3, n).astype(float)


def integer_design(seed: int) -> tuple[Array, Array]:
    """A design of small integers, some columns alike: correlations tie."""
    random = np.random.default_rng([2746, seed])
    n, p = int(random.integers(3, 9)), int(random.integers(2, 7))
    X = random.integers(-2, 3, (n, p)).astype(float)
    if seed % 4 == 0:
        X[:, -1] = X[:, 0] * random.choice([-1.0, 1.0])
    return X, random.integers(-4, 5, n).astype(float)


def frontier(n: int, seed: int = 0) -> tuple[Array, Array]:
    """Means and covariances of n assets: a few factors, and noise."""
    random = np.random.default_rng([300, seed])
    factors = random.normal(size=(n, max(3, n // 20)))
    mean = random.normal(0.1, 0.05, n)
    return mean, factors @ factors.T / factors.shape[1] * 0.04 + np.diag(random.uniform(0.01, 0.1, n))
