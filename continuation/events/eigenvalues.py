"""Branches that cross an arc, by one factorisation at its beginning.

With bordered matrices M_a and M_c of two points, M_a + t (M_c - M_a) is singular where 1 / t is an eigenvalue of C = I
- M_a^{-1} M_c: a real eigenvalue above one means a crossing; the determinant shows parity only. Parameters t are exact
on a straight branch if H is affine in the parameter.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.linalg.lapack import dgeev

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, dot, largest
from continuation.evaluation.errors import EvaluationError
from continuation.point.linearization import Linearization

PRODUCTS = 40
"""Largest Krylov dimension; two usually suffice."""

EIGENVALUE_ACCURACY = 0.05
"""Relative, of real and imaginary parts; Newton's method refines the crossing."""

OUTSIDE_SPACE = 0.1
"""If the last dimension leads out of the space by more, relative to the least eigenvalue wanted, the next must confirm;
otherwise a tenth of 400 crossings just behind an arc is missed."""

ROUNDING = ROOT_OF_ROUND_OFF
"""Smaller eigenvalues, relative to the matrix, may be round-off of a nearly defective pair (Wilkinson, The Algebraic
Eigenvalue Problem, Section 2.22), as near a pole."""

SAME = math.sqrt(SIX_DIGITS)
"""Relative distance of equal eigenvalues, and singular value of dependent unit vectors, which have half the
eigenvalues' digits."""


def changes(
    a: Linearization,
    apply: Callable[[Array], Array],
    border: Array,
    most: float,
    least: float,
    start: Array,
    accuracy: float = EIGENVALUE_ACCURACY,
) -> tuple[list[float], Array]:
    """Return the real eigenvalues of C above `most` or below `least`, ascending, and unit eigenvectors, as columns.

    `apply`: v -> H' v at the other point. `border`, shape (N + 1,): M's last row, the tangent there in the dual metric,
    so that turns give complex eigenvalues. `start`, shape (N + 1,): Arnoldi's first vector; eigenvectors orthogonal to
    it are not found. `accuracy`: relative.
    """
    values, vectors, _ = _eigenvalues(a, apply, border, most, least, start, accuracy, passed=True)
    return values.tolist(), _unit(vectors, np.sqrt(a.weights)) if values.size else vectors


def multiplicity(a: Linearization, apply: Callable[[Array], Array], border: Array, place: float) -> int:
    """Ranks that H' loses at a parameter `place` of `changes`.

    A Krylov space holds one vector of each eigenspace, so several starts serve.
    """
    found, lost = np.empty((a.u.size, 0)), 0
    for k in range(a.u.size):
        start = np.cos(1.0 + k + (1.7 + k) * np.arange(float(a.u.size)) ** 2)
        values, vectors, scale = _eigenvalues(a, apply, border, 0.5 / place, -np.inf, start, SAME**2)
        near = np.abs(values * place - 1.0) < SAME
        # Beside the point, eigenvalues that vanish at different rates are apart: one start has all their vectors.
        found, before = np.column_stack((found, vectors[:, near])), lost
        lost = int(np.count_nonzero(np.linalg.svd(_unit(found, scale), compute_uv=False) >= SAME))
        # One of two starts has a part along the eigenvector.
        if (near.any() and lost == before) or k > lost:
            break
    return lost


def _unit(vectors: Array, scale: Array) -> Array:
    scaled = scale[:, None] * vectors
    unit: Array = scaled / np.sqrt(np.sum(scaled * scaled, axis=0))
    return unit


def _eigenvalues(
    a: Linearization,
    apply: Callable[[Array], Array],
    border: Array,
    right: float,
    left: float,
    start: Array,
    accuracy: float,
    passed: bool = False,
) -> tuple[Array, Array, Array]:
    """Eigenvalues; vectors, in units of the unknowns; the scale of Arnoldi's method.

    `passed`: add the real parts, beyond one, of complex pairs.

    An unknown with too small a unit would dominate every eigenvector: the first product gives a scale in which it does
    not (Chen and Demmel, Linear Algebra Appl. 309, 2000, Section 3).
    """
    scale = np.sqrt(a.weights)
    n = min(PRODUCTS, a.u.size)
    Q, H = np.empty((n + 1, a.u.size)), np.zeros((n + 1, n))
    Q[0] = start / math.sqrt(dot(start, start))
    converged, now = False, list[complex]()
    for k in range(n):
        q = Q[k] / scale
        x = Q[k] - scale * a.approximate(apply(q), dot(border, q))
        if k == 0 and math.sqrt(x.size) * largest(x) > 1.0:
            balance = 1.0 / np.maximum(1.0, math.sqrt(x.size) * np.abs(x))
            first = balance * Q[0]
            balance /= math.sqrt(dot(first, first))
            scale, Q[0], x = balance * scale, balance * Q[0], balance * x
        size = math.sqrt(dot(x, x))
        space = Q[: k + 1]
        first = space.dot(x)
        x = x - first.dot(space)
        second = space.dot(x)
        x = x - second.dot(space)
        H[: k + 1, k] = first + second
        H[k + 1, k] = left_over = math.sqrt(dot(x, x))
        whole = k + 1 == a.u.size or left_over <= ROOT_OF_ROUND_OFF * size
        if k == 0 and not whole:
            Q[1] = x / left_over
            continue
        small = H[: k + 1, : k + 1]
        if 0.5 * _size(small + small.T) + left_over <= min(right, -left):
            # No real part exceeds the norm of the symmetric part.
            values, errors, vectors = list[complex](), list[float](), small
        else:
            values, errors, vectors = _eig(small, 0.0 if whole else left_over)
        told = [(z, e) for z, e in zip(values, errors) if z.real + e > right or z.real - e < left]
        before, converged = converged, all(e <= accuracy * abs(z) for z, e in told)
        # If H' is far from normal, as near a pole, residuals are small too early: the next dimension must confirm.
        last, now = now, sorted((z for z, _ in told), key=lambda z: (z.real, z.imag))
        same = len(last) == len(now) and all(abs(p - q) <= accuracy * abs(q) for p, q in zip(last, now))
        if whole or (converged and (same if told else before or _closed(small, left_over, right))):
            break
        Q[k + 1] = x / left_over
    rounding = ROUNDING * _size(small)
    real, pairs = list[int](), list[int]()
    for j, (z, e) in enumerate(zip(values, errors)):
        if (z.real > right or z.real < left) and abs(z) > rounding:
            # Off the path the equal eigenvalues of a multiple point may be a complex pair.
            (real if abs(z.imag) <= max(e, EIGENVALUE_ACCURACY * abs(z)) else pairs).append(j)
    # If one has crossed, two others may have crossed and become a pair.
    crossed = passed and any(values[j].real > 1.0 for j in real)
    wanted = real + [j for j in pairs if crossed and values[j].real > 1.0]
    if not wanted:
        return np.zeros(0), np.zeros((a.u.size, 0)), scale
    wanted.sort(key=lambda j: values[j].real)
    return np.array([values[j].real for j in wanted]), Q[: k + 1].T @ vectors[:, wanted] / scale[:, None], scale


def _closed(H: Array, left_over: float, right: float) -> bool:
    """Whether the Krylov space of C misses no eigenvalue above `right`.

    `H`: C projected on the space; `left_over`: size of what C adds to it, which comes back multiplied by entries of C.
    """
    return left_over * max(right, float(np.abs(H).max())) <= OUTSIDE_SPACE * right * right


def _size(matrix: Array) -> float:
    """Frobenius' norm."""
    entries = matrix.ravel()
    return math.sqrt(dot(entries, entries))


def _eig(matrix: Array, left_over: float) -> tuple[list[complex], list[float], Array]:
    """Eigenvalues, residuals, real parts of eigenvectors, five times as fast as `numpy.linalg.eig`."""
    real, imaginary, _, vectors, info = dgeev(matrix, 0)
    if info:
        raise EvaluationError("eigenvalues of a small matrix were not found")
    values, last = [complex(x, y) for x, y in zip(real.tolist(), imaginary.tolist())], vectors[-1].tolist()
    for j, z in enumerate(values):
        if z.imag > 0.0:
            # Real and imaginary part of a pair's vector.
            last[j] = last[j + 1] = math.hypot(last[j], last[j + 1])
            vectors[:, j + 1] = vectors[:, j]
    return values, [left_over * abs(x) for x in last], vectors
