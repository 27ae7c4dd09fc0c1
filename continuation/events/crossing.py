"""Which branches cross an arc, and about where: seen from a factorisation at its beginning, whatever lies on it.

With M_a and M_c the bordered matrices of two points, M_a + t (M_c - M_a) is singular where 1 / t is an eigenvalue of
C = I - M_a^{-1} M_c. So on an arc that no branch crosses C has no real eigenvalue beyond one; a determinant's sign,
which sees parity only, is not asked. Units and the scaling of equations change nothing: M_a^{-1} M_c has those of u
alone. On a straight branch of an H that is affine in the parameter the places are exact.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.linalg.lapack import dgeev

from continuation.arrays import Array, dot
from continuation.evaluation.errors import EvaluationError
from continuation.point.linearization import Linearization

PRODUCTS = 40
"""At most so many dimensions of the Krylov space; on a path that nothing crosses two are usual."""

EIGENVALUE_ACCURACY = 0.05
"""Of an eigenvalue: it tells about where the crossing lies, and Newton's method does the rest."""

OUTSIDE_SPACE = 0.1
"""Of the eigenvalues asked for: where the last dimension leads out of the space by more, what it shows must be so in
the next one too. Without that a tenth of the crossings just behind an arc is overlooked (400 crossings)."""

EXHAUSTED = 1e-10
"""A vector that loses all but this to the ones before it has no direction of its own."""

ROUNDING = float(np.finfo(float).eps) ** 0.5
"""An eigenvalue smaller than so much of its matrix may be round-off, where it is one of a pair that is nearly defective
(Wilkinson, The Algebraic Eigenvalue Problem, Section 2.22): on the way to a pole all are."""

RANKS, SAME, INDEPENDENT = 4, 1e-3, 1e-4
"""At most so many vectors of one eigenvalue are sought; that near is the same one, and less than the last, of unit
length, depends on the others: eigenvectors are known to about the root of what eigenvalues are."""


def changes(
    a: Linearization,
    apply: Callable[[Array], Array],
    border: Array,
    most: float,
    least: float,
    start: Array,
    accuracy: float = EIGENVALUE_ACCURACY,
) -> tuple[list[float], Array]:
    """The real eigenvalues of C = I - M_a^{-1} M above `most` or below `least`, in order, and their eigenvectors.

    Arnoldi's method until these are known. Each dimension takes a product with M and a solve at a.

    Parameters
    ----------
    a : Linearization
    apply : callable
        v -> H' v at the other point.
    border : ndarray, shape (N + 1,)
        The last row there: its tangent in the dual metric, so that a path that merely turns gives complex eigenvalues.
    most, least : float
    start : ndarray, shape (N + 1,)
        The first vector, in the metric: what has no part in it is not found.
    accuracy : float
        Of the eigenvalues, relative.

    Returns
    -------
    values : list of float
    vectors : ndarray, shape (N + 1, number of values)
        Of unit length in the metric, as columns.
    """
    values, vectors = _eigenvalues(a, apply, border, most, least, start, accuracy)
    if not values.size:
        return [], vectors
    order = np.argsort(values)
    return values[order].tolist(), vectors[:, order]


def multiplicity(a: Linearization, apply: Callable[[Array], Array], border: Array, place: float) -> int:
    """How many ranks the matrix loses at a singular place: eigenvectors of one eigenvalue found from several vectors.

    A Krylov space holds one vector of an eigenspace, whatever its dimension.

    Parameters
    ----------
    a, apply, border
        As for `changes`.
    place : float
        One of these.
    """
    found: list[Array] = []
    for k in range(RANKS):
        start = np.cos(1.0 + k + (1.7 + k) * np.arange(float(a.u.size)) ** 2)
        values, vectors = _eigenvalues(a, apply, border, 0.5 / place, -np.inf, start, SAME**2)
        near = [i for i, value in enumerate(values) if abs(value * place - 1.0) < SAME]
        # A vector may have next to no part along an eigenvector: another one has.
        found += [vectors[:, near[0]]] if near else []
        if found and np.linalg.svd(np.array(found), compute_uv=False)[-1] < INDEPENDENT:
            return len(found) - 1
    return len(found)


def _eigenvalues(
    a: Linearization,
    apply: Callable[[Array], Array],
    border: Array,
    right: float,
    left: float,
    start: Array,
    accuracy: float,
) -> tuple[Array, Array]:
    """The real eigenvalues of C beyond right, or below left, and their vectors in the metric, as columns."""
    scale = np.sqrt(a.weights)
    n = min(PRODUCTS, a.u.size)
    Q, H = np.empty((n + 1, a.u.size)), np.zeros((n + 1, n))
    Q[0] = start / math.sqrt(dot(start, start))
    converged, now = False, list[complex]()
    for k in range(n):
        q = Q[k] / scale
        x = Q[k] - scale * a.approximate(apply(q), dot(border, q))
        size = math.sqrt(dot(x, x))
        space = Q[: k + 1]
        first = space.dot(x)
        x = x - first.dot(space)
        second = space.dot(x)
        x = x - second.dot(space)
        H[: k + 1, k] = first + second
        H[k + 1, k] = left_over = math.sqrt(dot(x, x))
        whole = k + 1 == a.u.size or left_over <= EXHAUSTED * size
        if k == 0 and not whole:
            Q[1] = x / left_over
            continue
        if k == 1 and _nothing_told(H, right, left):
            if whole or left_over <= OUTSIDE_SPACE * right:
                return np.empty(0), np.empty((a.u.size, 0))
            converged = True
        else:
            values, errors, vectors = _eig(H[: k + 1, : k + 1], 0.0 if whole else left_over)
            told = [(z, e) for z, e in zip(values, errors) if z.real + e > right or z.real - e < left]
            before, converged = converged, all(e <= accuracy * abs(z) for z, e in told)
            # Where H' is far from normal, as on the way to a pole, a small residual says little: the next dimension
            # has to show the same.
            last, now = now, sorted((z for z, _ in told), key=lambda z: (z.real, z.imag))
            same = len(last) == len(now) and all(abs(p - q) <= accuracy * abs(q) for p, q in zip(last, now))
            if whole or (converged and (same if told else before or left_over <= OUTSIDE_SPACE * right)):
                break
        Q[k + 1] = x / left_over
    rounding = ROUNDING * float(np.linalg.norm(H[: k + 1, : k + 1]))
    wanted = [
        j
        for j, (z, e) in enumerate(zip(values, errors))
        if (z.real > right or z.real < left) and abs(z.imag) <= e + EXHAUSTED * abs(z) and abs(z) > rounding
    ]
    return np.array([values[j].real for j in wanted]), Q[: k + 1].T @ vectors[:, wanted]


def _eig(matrix: Array, left_over: float) -> tuple[list[complex], list[float], Array]:
    """Eigenvalues of a small matrix, what leads out of the space by their vectors, and the real parts of these.

    In a fifth of the time of `numpy.linalg.eig`.
    """
    real, imaginary, _, vectors, info = dgeev(matrix, 0)
    if info:
        raise EvaluationError("eigenvalues of a small matrix were not found")
    values, last = [complex(x, y) for x, y in zip(real.tolist(), imaginary.tolist())], vectors[-1].tolist()
    for j, z in enumerate(values):
        if z.imag > 0.0:
            # A pair: its vector's real and imaginary parts stand side by side.
            last[j] = last[j + 1] = math.hypot(last[j], last[j + 1])
            vectors[:, j + 1] = vectors[:, j]
    return values, [left_over * abs(x) for x in last], vectors


def _nothing_told(H: Array, right: float, left: float) -> bool:
    """Whether two dimensions show no eigenvalue that is asked for: their two in closed form, for the time of a step."""
    a, b, c, d = float(H[0, 0]), float(H[0, 1]), float(H[1, 0]), float(H[1, 1])
    middle, discriminant = 0.5 * (a + d), 0.25 * (a - d) ** 2 + b * c
    root = math.sqrt(abs(discriminant))
    for sign in (-1.0, 1.0):
        real, imaginary = (middle + sign * root, 0.0) if discriminant >= 0.0 else (middle, root)
        # The last component of the eigenvector (value - d, c), of unit length, by what leads out of the space.
        error = float(H[2, 1]) * abs(c) / (math.hypot(real - d, imaginary, c) or 1.0)
        if real + error > right or real - error < left:
            return False
    return True
