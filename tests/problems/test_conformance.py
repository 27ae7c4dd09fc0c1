"""Every plug-in of ours, and every other homotopy of `problems`, passes the whole conformance suite."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation import from_functions
from continuation.arguments.plugins import available, find
from continuation.testing import check_homotopy
from problems import lcp
from problems.bifurcation import Bratu1D, Bratu2D, Cusp, ExponentialCosine, Pitchfork
from problems.nonlinear import brown, newton

SMALL = {
    "aircraft": {}, "bratu-1d": {"n": 8}, "bratu-2d": {"m": 4}, "brown-fixed-point": {"n": 4}, "circle": {}, "cusp": {},
    "exponential-cosine": {"n": 3}, "freudenstein-roth": {}, "kkt": {}, "kmm": {},
    "periodic-orbit": {"intervals": 6, "radius": 0.3}, "pitchfork": {}, "wang": {}, "xu": {}, "yu": {}, "zhao": {},
}  # fmt: skip
"""All that is registered, at a size at which its matrices may be dense."""


def chain(n):
    """A tridiagonal M-matrix."""
    return sp.diags_array([np.full(n - 1, -1.0), np.full(n, 2.5), np.full(n - 1, -1.0)], offsets=[-1, 0, 1])


def scattered(n):
    """A sparse matrix that is not banded, with a dominant diagonal."""
    generator = np.random.default_rng(6)
    A = 0.2 * sp.random_array((n, n), density=0.2, rng=generator) + sp.eye_array(n)
    return sp.csr_array(A)


Q = np.array([-1.0, 2.0, -0.5, 1.0, -2.0, 0.3])

OTHERS = {
    "pitchfork, imperfect": lambda: Pitchfork(0.1),
    "cusp without folds": lambda: Cusp(-1.0),
    "newton": lambda: newton(brown(3), np.full(3, 0.8), brown(3).jacobian),
    "newton without a derivative": lambda: newton(brown(3), np.full(3, 0.8)),
    "kkt, off the feasible set": lambda: lcp.KKTHomotopy(lcp.LCP(chain(6).toarray(), Q), x0=np.full(6, 0.1)),
    "kkt, not refined": lambda: lcp.KKTHomotopy(lcp.LCP(chain(6).toarray(), Q), refine=False),
    "kkt, banded": lambda: lcp.KKTHomotopy(lcp.LCP(chain(6), Q)),
    "kkt, sparse": lambda: lcp.KKTHomotopy(lcp.LCP(scattered(24), np.resize(Q, 24))),
    "kkt, a degenerate end": lambda: find("kkt")(example=7),
    "kkt, two turning points": lambda: find("kkt")(example=10),
    "wang, sparse": lambda: lcp.WangHomotopy(lcp.LCP(chain(6), Q)),
}


def test_every_plugin_of_ours_is_examined():
    ours = {name for name, plugin in available().items() if plugin.origin.startswith("pseudoarclength ")}
    assert ours == set(SMALL)


@pytest.mark.parametrize("name", SMALL)
def test_plugin(name):
    check_homotopy(find(name)(**SMALL[name]))


@pytest.mark.parametrize("name", OTHERS)
def test_other_homotopy(name):
    check_homotopy(OTHERS[name](), steps=25)


@pytest.mark.parametrize("homotopy", [Bratu1D(1), Bratu2D(1), ExponentialCosine(1)], ids=repr)
def test_the_smallest_of_a_family(homotopy):
    check_homotopy(homotopy)


def circle(y, lam):
    return y**2 + lam**2 - 1.0


def test_a_homotopy_from_functions():
    check_homotopy(from_functions(circle, start=([1.0], 0.0), target=None))
    check_homotopy(
        from_functions(
            lambda y, lam: y - lam * np.cos(y),
            lambda y, lam: (np.diag(1.0 + lam * np.sin(y)), -np.cos(y)),
            start=([0.0, 0.0], 0.0),
            target=1.0,
        ),
        expected_failed_checks={"picklable": "a lambda has no name to be imported by"},
    )
