"""Paths of operators: GMRES goes no farther than an iteration that measures its own residual needs."""

import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, splu

from continuation import DEFAULT, FAST, TurningPoint, from_functions, trace
from continuation.linear import Operator
from problems.bifurcation import Bratu2D

from ...util import by_preset


@by_preset(FAST, DEFAULT)
def test_the_fold_is_that_of_the_matrix_for_half_the_products(preset):
    """By products, preconditioned by the factors of the Laplacian."""
    bratu, products = Bratu2D(14), []
    inverse = splu(sp.csc_array(bratu.jacobian(*bratu.start())[0])).solve

    def jacobian(y, lam):
        H_y, H_lam = bratu.jacobian(y, lam)

        def product(v):
            products.append(v)
            return H_y @ v

        forward, back = (LinearOperator(H_y.shape, matvec=apply, dtype=float) for apply in (product, inverse))
        return Operator(forward, back), H_lam

    homotopy = from_functions(bratu.residual, jacobian, start=bratu.start(), target=None)
    by_matrix, path = (trace(one, preset=preset, events=[TurningPoint(terminal=1)]) for one in (bratu, homotopy))
    assert path.turning_points[0].lam == pytest.approx(by_matrix.turning_points[0].lam, rel=1e-12)
    assert {step.orientation for step in path.steps} == {0}
    # Each solve to round-off took 18 of them.
    assert len(products) <= 10 * path.counts.solves
