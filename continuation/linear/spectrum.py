"""Eigenvalues of H_y for stability."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import evolve, frozen
from scipy.linalg import eigvals, eigvalsh
from scipy.linalg.lapack import dpotrf
from scipy.sparse import csc_array, eye_array, issparse

from continuation.arrays import EPS, ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, Matrix, generic_vector
from continuation.linear.banded import Banded
from continuation.linear.dense import factor_lu
from continuation.linear.refine import BACKWARD_ERROR, Factored
from continuation.linear.sparse import factor_square
from continuation.linear.superlu import definite

ALL_OF_DENSE = 100
"""Largest order at which all eigenvalues are computed: 8 ms, and 80 ms at twice the order."""

EIGENVALUES = 6
"""Number of eigenvalues of larger matrices."""

OFF_AXIS = EPS / SIX_DIGITS
"""Least real part of an unstable eigenvalue over the largest modulus: the accuracy of located events."""

SHIFT = 0.517
"""Fraction of the bound on real parts; no round number, which could be an eigenvalue."""

NEARER = 0.1
"""Factor of the next shift that is tried: a tenth takes a third of Arnoldi's steps. A bound of this share of the
diagonal's largest entry is near enough."""

DIMENSIONS, TESTS_IN_ALL = 40, 6
"""Largest Krylov dimension per wanted eigenvalue, and one more; eigenvalues are tested at each growth of it by a sixth:
all tests then cost little more than the last."""


@frozen(eq=False)
class Spectrum:
    """Known eigenvalues of a matrix.

    `values`: the rightmost first. `unstable`: number of positive real parts, complete if `covered`.
    """

    values: np.ndarray[Any, np.dtype[np.complex128]]
    unstable: int
    covered: bool = True
    solves: int = 0

    @property
    def rightmost(self) -> float:
        """Largest real part."""
        return float(self.values[0].real)

    @property
    def size(self) -> float:
        """The largest computed modulus."""
        return float(np.abs(self.values).max())

    @property
    def pairs(self) -> np.ndarray[Any, np.dtype[np.complex128]]:
        """Eigenvalues with positive imaginary part."""
        return self.values[self.values.imag > OFF_AXIS * self.size]

    @property
    def unstable_pairs(self) -> int:
        """Number of unstable complex pairs."""
        return int(np.count_nonzero(self.pairs.real > 0.0))

    @property
    def critical(self) -> bool:
        """Whether an eigenvalue is on the axis to half of the digits."""
        return bool((np.abs(self.values.real) <= np.sqrt(OFF_AXIS) * self.size).any())


def spectrum(matrix: Matrix, side: int = 1, k: int | None = None) -> Spectrum:
    """Eigenvalues of ``side * matrix`` that decide stability.

    Small matrices: all, by QR. Others: the k (default 6) nearest to a shift, by Arnoldi's method on the inverse
    (Govaerts, Numerical Methods for Bifurcations, Section 5.3); the count is complete if their disc covers the right
    part of the rectangle from `bounds`. Raises `TypeError` for an operator, `ArithmeticError` without convergence.
    """
    matrix = plain(matrix)
    if not (isinstance(matrix, np.ndarray) or issparse(matrix)):
        raise TypeError(f"stability: expected H_y as a matrix, found {type(matrix).__name__}")
    if matrix.shape[0] <= ALL_OF_DENSE and k is None:
        return _counted(_all(side * matrix))
    return _nearest(side * matrix, EIGENVALUES if k is None else k)


def nearest_zero(matrix: Matrix, k: int) -> Any:
    """All eigenvalues of a small matrix, or the k nearest to zero to six digits."""
    n = matrix.shape[0]
    if n <= ALL_OF_DENSE:
        return _all(matrix)
    shift = SIX_DIGITS * float(np.abs(matrix.diagonal()).max())

    def known(theta: Any, error: Array) -> bool:
        return bool((error <= SIX_DIGITS * np.abs(theta)).all())

    return shift + 1.0 / dominant(_solver(matrix, shift), generic_vector(n), min(k, n), known)[0]


def _all(matrix: Matrix) -> Any:
    dense = np.asarray(matrix.toarray() if issparse(matrix) else matrix, dtype=float)
    # Without vectors a symmetric matrix of order 100 takes a sixth of the time.
    return eigvalsh(dense) if np.array_equal(dense, dense.T) else eigvals(dense)


def plain(matrix: Matrix) -> Matrix:
    """The matrix, sparse if banded."""
    return matrix.tosparse() if isinstance(matrix, Banded) else matrix


def _counted(values: Any, covered: bool = True) -> Spectrum:
    found = np.asarray(values, dtype=complex)
    found = found[np.lexsort((-found.imag, -found.real))]
    size = float(np.abs(found).max())
    return Spectrum(found, int(np.count_nonzero(found.real > OFF_AXIS * size)), covered)


def bounds(matrix: Matrix) -> tuple[float, float]:
    """Bounds of eigenvalues' real and imaginary parts: those of the symmetric and the skew part (Bendixson's theorem),
    by Gershgorin's discs.
    """
    rows = abs(matrix + _transposed(matrix)).sum(axis=1)
    diagonal = matrix.diagonal()
    real = 0.5 * np.asarray(rows).ravel() - np.abs(diagonal) + diagonal
    imaginary = 0.5 * np.asarray(abs(matrix - _transposed(matrix)).sum(axis=1)).ravel()
    return float(real.max()), float(imaginary.max())


def nearer(matrix: Matrix, bound: float, least: float) -> float:
    """The smallest bound of real parts above `least`, up to a factor of two, that Cholesky's method shows for the
    symmetric part, by bisection of the exponent.

    Gershgorin's, of differences of fourth order, is a million times too large.
    """
    symmetric = 0.5 * (matrix + _transposed(matrix))
    # The diagonal, and `least` with it, may be zero.
    shown, power = 0, math.ceil(math.log2(bound) - math.log2(max(least, np.finfo(float).tiny)))
    while power - shown > 1:
        middle = (shown + power) // 2
        if _is_above(bound * 0.5**middle, symmetric):
            shown = middle
        else:
            power = middle
    return bound * 0.5**shown


def _transposed(matrix: Matrix) -> Matrix:
    return csc_array(matrix.T) if issparse(matrix) else matrix.T


def _is_above(bound: float, symmetric: Matrix) -> bool:
    """Whether all eigenvalues of a symmetric matrix are less."""
    n = symmetric.shape[0]
    if isinstance(symmetric, np.ndarray):
        return int(dpotrf(bound * np.eye(n) - symmetric)[1]) == 0
    return definite(csc_array(bound * eye_array(n, format="csc") - symmetric))


def _nearest(matrix: Matrix, k: int) -> Spectrum:
    n = matrix.shape[0]
    real, imaginary = bounds(matrix)
    largest = float(np.abs(matrix.diagonal()).max())
    # A singular matrix needs a shift above round-off; if all eigenvalues are stable, one comparable to frequencies.
    least = SHIFT * ROOT_OF_ROUND_OFF * largest
    if real > NEARER * largest:
        real = nearer(matrix, real, least)
    shift = max(SHIFT * max(real, 0.1 * imaginary), least)
    inverse, wanted, solves = _solver(matrix, shift), min(k, n), 0

    def known(theta: Any, error: Array) -> bool:
        real_parts = (shift + 1.0 / theta).real
        off = error / np.abs(theta) ** 2 / np.maximum(np.abs(real_parts), np.finfo(float).tiny)
        # Enough for an eigenvalue on the axis, as events are located to OFF_AXIS.
        return bool(((off <= SIX_DIGITS) | (error <= SIX_DIGITS**2 * np.abs(theta))).all())

    while True:
        try:
            theta, more = dominant(inverse, generic_vector(n), wanted, known)
        except ArithmeticError:
            # The eigenvalues are far left of the bound, and Arnoldi's steps grow like the root of the shift (Saad,
            # Numerical Methods for Large Eigenvalue Problems, Section 6.6).
            if shift <= least:
                raise
            solves += min(n, DIMENSIONS * (wanted + 1))
            shift = max(NEARER * shift, least)
            inverse = _solver(matrix, shift)
            continue
        solves += more
        found = shift + 1.0 / theta
        corner = float(np.hypot(max(shift, real - shift), imaginary))
        covered = wanted == n or real <= 0.0 or bool(np.abs(found - shift).max() >= corner)
        if covered or not (found.real > 0.0).all():
            return evolve(_counted(found, covered), solves=solves)
        wanted = min(2 * wanted, n)


def dominant(
    apply: Callable[[Array], Array], start: Array, k: int, known: Callable[[Any, Array], bool]
) -> tuple[Any, int]:
    """The k eigenvalues of largest modulus, by Arnoldi's method, and the number of applications.

    `ArithmeticError` if `known(theta, error)` is never true.
    """
    n = start.size
    most = min(n, DIMENSIONS * (k + 1))
    Q, H, look = np.zeros((most + 1, n)), np.zeros((most + 1, most)), 3 * k
    Q[0] = start / np.linalg.norm(start)
    for j in range(1, most + 1):
        x = apply(Q[j - 1])
        size = float(np.linalg.norm(x))
        # One pass leaves spurious copies of eigenvalues.
        for _ in range(2):
            part = Q[:j] @ x
            H[:j, j - 1] += part
            x = x - part @ Q[:j]
        H[j, j - 1] = float(np.linalg.norm(x))
        exhausted = j == n or H[j, j - 1] <= BACKWARD_ERROR * size
        if exhausted or j == most or j >= look:
            look = j + max(j // TESTS_IN_ALL, 1)
            theta, vectors = np.linalg.eig(H[:j, :j])
            largest = np.argsort(-np.abs(theta))[:k]
            error = H[j, j - 1] * np.abs(vectors[-1, largest])
            if exhausted or known(theta[largest], error):
                return theta[largest], j
        Q[j] = x / H[j, j - 1]
    raise ArithmeticError(f"the {k} eigenvalues on the right are not found in {most} steps of Arnoldi's method")


def _solver(matrix: Matrix, shift: float) -> Callable[[Array], Array]:
    n = matrix.shape[0]
    if isinstance(matrix, np.ndarray):
        factor: Factored | None = factor_lu(matrix - shift * np.eye(n))
    else:
        factor = factor_square(csc_array(matrix - shift * eye_array(n, format="csc")))
    if factor is None:
        raise ArithmeticError("eigenvalues of H_y: the shifted matrix is singular")
    return factor.solve
