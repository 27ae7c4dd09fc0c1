"""The frequency at a Hopf point: of the eigenvalues of H_y, the pair nearest to the imaginary axis."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import eigs

from continuation.arrays import Matrix

ALL_OF_SPARSE = 500
"""Up to this order all eigenvalues of a sparse matrix are computed: a second at most."""

NEAREST = 40
"""Of a larger one so many nearest to zero: the frequencies of a Hopf point are low among those of a discretised
problem, whose other eigenvalues are far on the stable side."""

NEAR_AXIS = 0.1
"""The largest real part of a pair, relative to its size, that Newton's method is to bring to the imaginary axis."""


def frequency_at(H_y: Matrix) -> float:
    """The imaginary part of the pair.

    `H_y` of shape (N, N). Raises `ValueError` if no pair is near the axis.
    """
    if sp.issparse(H_y) and H_y.shape[0] <= ALL_OF_SPARSE:
        H_y = H_y.toarray()
    if sp.issparse(H_y):
        # A shift that is no eigenvalue, and of the matrix' own size: at zero it may be singular.
        shift = 1e-6 * float(np.abs(H_y.diagonal()).max())
        values = eigs(sp.csc_array(H_y), k=NEAREST, sigma=shift, return_eigenvectors=False)
    else:
        values = np.linalg.eigvals(H_y)
    pairs = values[values.imag > 0.0]
    off = np.abs(pairs.real) / np.abs(pairs)
    if not pairs.size or off.min() > NEAR_AXIS:
        found = f"{pairs[int(np.argmin(off))]:.3g}" if pairs.size else "none that is not real"
        raise ValueError(f"at: expected a pair of eigenvalues of H_y near the imaginary axis, found {found}")
    return float(pairs[int(np.argmin(off))].imag)
