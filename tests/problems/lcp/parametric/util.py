"""Problems whose piecewise linear paths are known, and all rays of a kink by brute force."""

from itertools import combinations

import numpy as np

from problems.lcp import LCP
from problems.scenes.lasso import penalised


def murty(n):
    """With d = e its path visits all 2^n faces."""
    q = -np.array([sum(2.0 ** (n - j) for j in range(1, i + 1)) for i in range(1, n + 1)])
    return LCP(np.tril(np.full((n, n), 2.0), -1) + np.eye(n), q)


def lasso(X, y):
    """The path of min 1/2 |X b - y|^2 + t |b|_1 from the least t with b = 0 on, to 0."""
    return penalised(X.T @ X, X.T @ y)


def mairal_yu(p):
    """Of p unknowns, with (3^p - 1) / 2 kinks."""
    X, y, least = np.eye(1), np.ones(1), 1.0
    for _ in range(p - 1):
        a = least / (2.0 * (2.0 * y @ y + 1.0))
        X = np.block([[X, (2.0 * a * y)[:, None]], [np.zeros((1, X.shape[1])), np.full((1, 1), a)]])
        y = np.append(y, 1.0)
        least = lasso(X, y).kinks[-1].lam
    return X, y


def integer_problem(seed):
    """Of integers so small that switches often vanish together."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 7))
    A = random.integers(-2, 3, (n, n)).astype(float)
    A = A @ A.T if seed % 3 == 0 else A
    return LCP(A, random.integers(-3, 4, n)), random.integers(1, 3, n).astype(float)


def all_rays(problem, d, u):
    """The unit vectors along which solutions leave u = (x, t); None where they fill more than lines.

    On each face that holds u, x moves on the face's support S with w = 0 there: one equation each in x_S and t.
    """
    n, A, x = problem.n, np.column_stack([problem.A, d]), u[:-1]
    w, found = problem.w(x) + u[-1] * d, []
    near = 1e-9 * (1.0 + np.abs(u).max())
    undecided = np.flatnonzero((x <= near) & (w <= near))
    for size in range(undecided.size + 1):
        for more in combinations(undecided, size):
            support = np.union1d(np.flatnonzero(x > near), more).astype(int)
            moving = np.append(support, n)
            _, lengths, directions = np.linalg.svd(A[np.ix_(support, moving)])
            kernel = directions[np.count_nonzero(lengths > 1e-9) :]
            for sign in (1.0, -1.0):
                ray = np.zeros(n + 1)
                ray[moving] = sign * kernel[0]
                if min(ray[undecided].min(initial=0.0), (A @ ray)[undecided].min(initial=0.0)) >= -1e-9:
                    if len(kernel) > 1:
                        return None
                    found += [ray] * all(np.abs(ray - one).max() > 1e-8 for one in found)
    return found
