"""Paths of operators: GMRES goes no farther than an iteration that measures its own residual needs."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.fft import dstn, idstn
from scipy.sparse.linalg import LinearOperator

from continuation import DEFAULT, FAST, TurningPoint, trace
from continuation.linear import Operator
from problems.bifurcation.bratu_2d import five_point

from ...util import by_preset


class Cube:
    """Bratu's problem on m^3 points, by a sparse matrix or by products, preconditioned by a fast sine transform."""

    target = None

    def __init__(self, m, sparse):
        plane = sp.kron(sp.eye_array(m), five_point(m))
        line = sp.diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(m, m))
        self.laplacian = sp.csr_array(plane + sp.kron(line, sp.eye_array(m**2)))
        self.sparse, self.n, self.h2, self.products = sparse, m**3, (m + 1.0) ** -2, 0
        one = 2.0 * np.cos(np.pi * np.arange(1, m + 1) / (m + 1)) - 2.0
        values = one[:, None, None] + one[:, None] + one

        def inverse(v):
            return idstn(dstn(v.reshape(m, m, m), type=1) / values, type=1).ravel()

        self.inverse = LinearOperator((self.n, self.n), matvec=inverse, dtype=float)

    def start(self):
        return np.zeros(self.n), 0.0

    def residual(self, y, lam):
        return self.laplacian @ y + self.h2 * lam * np.exp(y)

    def jacobian(self, y, lam):
        slope = self.h2 * np.exp(y)
        if self.sparse:
            return sp.csc_array(self.laplacian + sp.diags_array(lam * slope)), slope

        def product(v):
            self.products += 1
            return self.laplacian @ np.ravel(v) + lam * slope * np.ravel(v)

        return Operator(LinearOperator((self.n, self.n), matvec=product, dtype=float), self.inverse), slope


@by_preset(FAST, DEFAULT)
def test_the_fold_is_that_of_the_matrix_for_half_the_products(preset):
    fold = TurningPoint(terminal=1)
    by_matrix = trace(Cube(6, True), preset=preset, events=[fold])
    cube = Cube(6, False)
    path = trace(cube, preset=preset, events=[fold])
    assert path.turning_points[0].lam == pytest.approx(by_matrix.turning_points[0].lam, rel=1e-12)
    # Each solve to round-off took 18 of them.
    assert cube.products <= 10 * path.counts.solves
