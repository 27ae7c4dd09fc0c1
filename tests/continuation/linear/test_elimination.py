"""A matrix with k columns and rows more is regular if it has lost no more than k ranks."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation.linear import SingularError
from continuation.linear.nullspace import Bordered

N = 9


def bordered(k, seed, dtype=float, lost=0, decades=1):
    """A, P, [R, S], the whole and a vector, in units of so many decades either way; `lost` ranks of A are lost."""
    rng = np.random.default_rng(seed)
    A, P, rows = (rng.standard_normal(shape).astype(dtype) for shape in ((N, N), (N, k), (k, N + k)))
    if dtype is complex:
        A = A + 1j * rng.standard_normal((N, N))
    left, sizes, right = np.linalg.svd(A)
    A = left * np.append(sizes[: N - lost], np.zeros(lost)) @ right
    units = 10.0 ** rng.uniform(-decades, decades, k)
    P, rows = P * units, rows / units[:, None]
    return A, P, rows, np.block([[A, P], [rows]]), np.append(rng.standard_normal(N), 1.0 / units)


@pytest.mark.parametrize("make", [np.asarray, sp.csc_array])
@pytest.mark.parametrize("dtype", [float, complex])
@pytest.mark.parametrize("k", [1, 2, 4])
def test_a_matrix_that_lost_as_many_ranks_is_regular_with_its_borders(k, dtype, make):
    A, P, rows, whole, x = bordered(k, 5, dtype, lost=k)
    factors = Bordered.of(make(A), P, rows)
    found = factors.solve(np.column_stack([whole @ x, 2.0 * whole @ x]))
    np.testing.assert_allclose(found, np.column_stack([x, 2.0 * x]), rtol=1e-6)
    size = np.abs(whole).sum(axis=1) * np.abs(y := factors.solve(np.ones(N + k), adjoint=True))
    assert np.abs(whole.conj().T @ y - 1.0).max() <= 1e-12 * max(size.max(), 1.0)
    if dtype is float:
        assert factors.sign == np.linalg.slogdet(whole)[0]


@pytest.mark.parametrize("make", [np.asarray, sp.csc_array])
def test_a_matrix_that_lost_more_ranks_than_it_has_borders_is_singular(make):
    A, P, rows, *_ = bordered(1, 3)
    A[:3] = 0.0
    with pytest.raises(SingularError):
        Bordered.of(make(A), P, rows).solve(np.ones(N + 1))
