"""The problems of the benchmark; each function takes an order and a seed where it is random, and returns an LCP."""

import numpy as np
import scipy.sparse as sp

from problems.lcp import LCP
from problems.scenes.american_put import AmericanPut
from problems.scenes.game import bimatrix as game


def positive_definite(n: int, seed: int) -> LCP:
    """A = MM'/n + skew, not symmetric; q normal."""
    r = np.random.default_rng(seed)
    M, S = r.standard_normal((n, n)), r.standard_normal((n, n))
    return LCP(M @ M.T / n + (S - S.T) / np.sqrt(n), r.standard_normal(n))


def semidefinite(n: int, seed: int) -> LCP:
    """A = MM'/n of rank n/2, symmetric, with a planted solution so that it is solvable."""
    r = np.random.default_rng(seed)
    M = r.standard_normal((n, n // 2))
    return _planted(M @ M.T / n, r)


def murty(n: int) -> LCP:
    """Murty's triangular matrix, on which Lemke and least-index pivoting take about 2^n pivots."""
    return LCP(np.eye(n) + np.tril(np.full((n, n), 2.0), -1).T, -np.ones(n))


def fathi(n: int) -> LCP:
    """Fathi's positive definite matrix: Murty's times its transpose."""
    lower = np.eye(n) + np.tril(np.full((n, n), 2.0), -1)
    return LCP(lower @ lower.T, -np.ones(n))


def random_planted(n: int, seed: int) -> LCP:
    """A = randn / sqrt(n), neither monotone nor P, with a planted strictly complementary solution."""
    r = np.random.default_rng(seed)
    return _planted(r.standard_normal((n, n)) / np.sqrt(n), r)


def _planted(A: np.ndarray, r: np.random.Generator) -> LCP:
    x = np.maximum(r.standard_normal(len(A)), 0.0)
    w = np.where(x == 0.0, np.abs(r.standard_normal(len(A))), 0.0)
    return LCP(A, w - A @ x)


def frictional_contact(n: int, seed: int) -> LCP:
    """Stewart and Trinkle's time step for a plane body on n/4 contacts: singular, copositive, redundant.

    Unknowns (normal, two tangents, slip) a contact; W = B' G' G B with G of three rows (two forces and a moment),
    friction 0.2 .. 0.9.
    """
    r = np.random.default_rng(seed)
    k = n // 4
    angle = np.sort(r.uniform(0.0, np.pi, k))
    place = np.stack([np.cos(angle), np.sin(angle)])
    normal = np.stack([r.normal(0.0, 0.2, k), np.ones(k)])
    normal /= np.linalg.norm(normal, axis=0)
    tangent = np.stack([normal[1], -normal[0]])

    def wrench(direction: np.ndarray) -> np.ndarray:
        return np.vstack([direction, place[0] * direction[1] - place[1] * direction[0]])

    N, D = wrench(normal), np.stack([wrench(tangent), wrench(-tangent)], axis=2).reshape(3, 2 * k)
    mass = np.diag(1.0 / r.uniform(0.5, 2.0, 3))
    force = np.array([r.normal(0.0, 1.0), -1.0, r.normal(0.0, 0.3)])
    mu = r.uniform(0.2, 0.9, k)
    E = np.kron(np.eye(k), np.ones((2, 1)))
    A = np.zeros((n, n))
    A[:k, :k], A[:k, k : 3 * k] = N.T @ mass @ N, N.T @ mass @ D
    A[k : 3 * k, :k], A[k : 3 * k, k : 3 * k], A[k : 3 * k, 3 * k :] = D.T @ mass @ N, D.T @ mass @ D, E
    A[3 * k :, :k], A[3 * k :, k : 3 * k] = np.diag(mu), -E.T
    velocity = r.normal(0.0, 0.5, 3) + mass @ force
    return LCP(A, np.concatenate([N.T @ velocity, D.T @ velocity, np.zeros(k)]))


def bimatrix(n: int, seed: int) -> LCP:
    """The equilibria of a bimatrix game with n/2 strategies a player, costs uniform in [0.1, 1]."""
    return game(*np.random.default_rng(seed).uniform(0.1, 1.0, (2, n // 2, n // 2)))


def american_option(n: int) -> LCP:
    """A put by Black and Scholes in log-price, one implicit step of half a month; tridiagonal."""
    # The first step of the scene is half a year / 24 for these, on a grid from a tenth of the strike to ten times that.
    deviation = 0.3 * np.sqrt(1.0 / 3.0)
    put = AmericanPut(1.0, 1.0, 0.05, 0.3, maturity=1.0 / 3.0, n=n, steps=2, width=np.log(10.0) / deviation)
    return put.problem()


def obstacle_1d(n: int) -> LCP:
    """A string over two bumps; tridiagonal."""
    t = np.arange(1, n + 1) / (n + 1)
    obstacle = np.maximum(0.15 - 16.0 * (t - 0.35) ** 2, 0.1 - 16.0 * (t - 0.7) ** 2)
    A = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n), dtype=float) * (n + 1.0) ** 2
    return LCP(A, A @ obstacle + 0.5)


def obstacle_2d(m: int) -> LCP:
    """A membrane over a bump, five-point differences on m x m points."""
    T = sp.diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(m, m), dtype=float)
    eye = sp.eye_array(m, dtype=float)
    A = (sp.kron(T, eye) + sp.kron(eye, T)) * (m + 1.0) ** 2
    t = np.arange(1, m + 1) / (m + 1)
    X, Y = np.meshgrid(t, t)
    obstacle = 0.3 - 3.0 * ((X - 0.5) ** 2 + (Y - 0.5) ** 2)
    return LCP(sp.csr_array(A), A @ obstacle.ravel() + 5.0)
