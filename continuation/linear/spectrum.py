"""Eigenvalues of H_y for questions of stability: all of them, the ones on the right, or no more than their signs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import evolve, frozen
from scipy.linalg import eigvals
from scipy.sparse import csc_array, eye_array, issparse
from scipy.sparse.linalg import ArpackError, LinearOperator, eigs

from continuation.arrays import Array, Matrix, generic_vector
from continuation.linear.banded import Banded
from continuation.linear.dense import factor_lu
from continuation.linear.refine import Factored
from continuation.linear.sparse import factor_square
from continuation.linear.symmetric import Symmetric, factor_ldl

ALL_OF_DENSE = 100
"""Up to this order all eigenvalues of a dense matrix are computed: 8 ms there, and 80 ms at twice the order."""

WANTED = 6
"""Eigenvalues on the right that are computed beyond that, where nothing is said."""

OFF_AXIS = 1e-10
"""The real part, relative to the largest of the eigenvalues known, from which an eigenvalue counts as unstable: events
are located to that."""

SHIFT = 0.517
"""Of the bound on real parts: in the middle of where unstable eigenvalues may be, and not on a round number."""

LEAST_SHIFT = 1e-6
"""At least so far is the shift from zero, relative to the diagonal: a singular matrix has eigenvalues all the same."""

KNOWN_TO = 1e-12
"""Errors of eigenvalues, relative to their distance from the shift: their real parts locate an event to 1e-10."""


@frozen(eq=False)
class Spectrum:
    """What is known of the eigenvalues of a matrix.

    `values`: Those computed, the rightmost first; none where only signs were asked for. `unstable`: How many lie to the
    right of the imaginary axis. `covered`: Whether no other eigenvalue can lie there. `solves`: With the one
    factorisation of Arnoldi's method.
    """

    values: np.ndarray[Any, np.dtype[np.complex128]]
    unstable: int
    covered: bool = True
    solves: int = 0

    @property
    def rightmost(self) -> float:
        """The largest real part; nan where only signs are known."""
        return float(self.values[0].real) if self.values.size else np.nan

    @property
    def size(self) -> float:
        """The largest modulus of those computed; 1 where there are none."""
        return float(np.abs(self.values).max()) if self.values.size else 1.0

    @property
    def pairs(self) -> np.ndarray[Any, np.dtype[np.complex128]]:
        """The upper one of each complex pair, the rightmost first."""
        return self.values[self.values.imag > OFF_AXIS * self.size]

    @property
    def unstable_pairs(self) -> int:
        """How many complex pairs lie to the right."""
        return int(np.count_nonzero(self.pairs.real > 0.0))

    @property
    def critical(self) -> bool:
        """Whether an eigenvalue lies on the axis, to half of the digits: then the count is as round-off wants it."""
        return bool((np.abs(self.values.real) <= np.sqrt(OFF_AXIS) * self.size).any())


def spectrum(matrix: Matrix, side: int = 1, k: int | None = None) -> Spectrum:
    """The eigenvalues of ``side * matrix`` that decide on stability.

    Of a `Symmetric` matrix the inertia of its LDL' factorisation (Sylvester's law); of a small one all, by the QR
    method; of others the k nearest to a shift in the middle of where unstable ones may be, by Arnoldi's method on the
    inverse (Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, Section 5.3). Bendixson's theorem
    bounds real and imaginary parts by the eigenvalues of the symmetric and of the skew part, which Gershgorin's discs
    bound: where the disc that Arnoldi's method has emptied covers what is left on the right, the count is complete.

    Parameters
    ----------
    matrix : ndarray, sparse array, Banded or Symmetric, shape (N, N)
    side : {1, -1}
    k : int, optional
        6 by default.

    Raises
    ------
    TypeError
        If the matrix is an operator, which has no entries.
    ArithmeticError
        If Arnoldi's method does not converge.
    """
    if isinstance(matrix, Symmetric):
        return Spectrum(np.empty(0, dtype=complex), factor_ldl(matrix.matrix)[0].count(side))
    matrix = plain(matrix)
    if not (isinstance(matrix, np.ndarray) or issparse(matrix)):
        raise TypeError(f"stability: expected H_y as a matrix, found {type(matrix).__name__}")
    if matrix.shape[0] <= ALL_OF_DENSE and k is None:
        return _counted(_all(side * matrix))
    return _nearest(side * matrix, WANTED if k is None else k)


def nearest_zero(matrix: Matrix, k: int) -> Any:
    """The eigenvalues of a small matrix, or the k nearest to zero of a large one, to four digits.

    `matrix`: ndarray or sparse array, shape (N, N). Raises `ArithmeticError` as `spectrum`.
    """
    n = matrix.shape[0]
    if n <= ALL_OF_DENSE:
        return _all(matrix)
    shift = LEAST_SHIFT * float(np.abs(matrix.diagonal()).max())
    return _arnoldi(_solver(matrix, shift), n, shift, k)


def _all(matrix: Matrix) -> Any:
    return eigvals(np.asarray(matrix.toarray() if issparse(matrix) else matrix, dtype=float))


def plain(matrix: Matrix) -> Matrix:
    """The same matrix, sparse if it is banded."""
    return matrix.tosparse() if isinstance(matrix, Banded) else matrix


def _counted(values: Any, covered: bool = True) -> Spectrum:
    found = np.asarray(values, dtype=complex)
    found = found[np.lexsort((-found.imag, -found.real))]
    size = float(np.abs(found).max())
    return Spectrum(found, int(np.count_nonzero(found.real > OFF_AXIS * size)), covered)


def bounds(matrix: Matrix) -> tuple[float, float]:
    """The largest real part and the largest imaginary part that an eigenvalue may have (Bendixson, Gershgorin).

    Parameters
    ----------
    matrix : ndarray or sparse array, shape (N, N)
    """
    turned = csc_array(matrix.T) if issparse(matrix) else matrix.T
    rows = abs(matrix + turned).sum(axis=1)
    diagonal = matrix.diagonal()
    real = 0.5 * np.asarray(rows).ravel() - np.abs(diagonal) + diagonal
    imaginary = 0.5 * np.asarray(abs(matrix - turned).sum(axis=1)).ravel()
    return float(real.max()), float(imaginary.max())


def _nearest(matrix: Matrix, k: int) -> Spectrum:
    """The k eigenvalues nearest to a shift in the middle of where unstable ones can be."""
    n = matrix.shape[0]
    real, imaginary = bounds(matrix)
    # Where all are stable the shift is not much farther away than what oscillates, and no eigenvalue itself.
    shift = SHIFT * max(real, 0.1 * imaginary, LEAST_SHIFT * float(np.abs(matrix.diagonal()).max()))
    corner = float(np.hypot(max(shift, real - shift), imaginary))
    solve, solves = _solver(matrix, shift), 0

    def counted(rhs: Array) -> Array:
        nonlocal solves
        solves += 1
        return solve(rhs)

    # Where all that were asked for are unstable there may be more.
    while k < n - 1:
        found = _arnoldi(counted, n, shift, k)
        covered = real <= 0.0 or bool(np.abs(found - shift).max() >= corner)
        if covered or not (found.real > 0.0).all():
            return evolve(_counted(found, covered), solves=solves)
        k *= 2
    return _counted(_all(matrix))


def _arnoldi(solve: Callable[[Array], Array], n: int, shift: float, k: int) -> Any:
    """The k eigenvalues nearest to the shift, by ARPACK; three to five vectors for each, and seldom a restart."""
    inverse = LinearOperator((n, n), matvec=solve, dtype=float)
    start, vectors = generic_vector(n).copy(), min(n, max(30, 3 * k))
    try:
        turned = eigs(inverse, k, v0=start, ncv=vectors, tol=KNOWN_TO, return_eigenvectors=False)
    except ArpackError as error:
        raise ArithmeticError(f"the {k} eigenvalues nearest to {shift:.3g} are not found: {error}") from error
    return shift + 1.0 / turned


def _solver(matrix: Matrix, shift: float) -> Callable[[Array], Array]:
    n = matrix.shape[0]
    if isinstance(matrix, np.ndarray):
        factor: Factored | None = factor_lu(matrix - shift * np.eye(n))
    else:
        factor = factor_square(csc_array(matrix - shift * eye_array(n, format="csc")))
    if factor is None:
        raise ArithmeticError("eigenvalues of H_y: the shifted matrix is singular")
    return factor.solve
