"""The bounds of Krawczyk's test for quadratic homotopies beside what they bound, evaluated at random places."""

import numpy as np
import pytest

from continuation import certify, trace
from continuation.certificate.cells import evaluated, slabs_of
from continuation.certificate.certifying import engine_of
from continuation.certificate.engine import inverses
from continuation.numbers.ends import thin
from problems.lcp import LCP
from problems.lcp.homotopies import KKTHomotopy, YuHomotopy

from .util import proved


def preconditioners(engine, slabs, radius):
    """Y_0 and E of Y(s) = (I - x E) Y_0, as the engine takes them."""
    form, chart = engine.form, slabs.cells.chart[:, None, :]
    G = form.derivatives(*(part.along(slabs.cubic).middle() for part in (form.first, form.second)))
    whole, units = np.concatenate([G[:, 0], chart], axis=1), np.exp2(np.round(np.log2(radius)))[:, None, :]
    rows = np.abs(whole * units).max(axis=2, keepdims=True)
    Y = inverses(whole * units / rows) * units.transpose(0, 2, 1) / rows.transpose(0, 2, 1)
    return Y, np.matmul(Y[:, :, :-1], G[:, 1])


@pytest.mark.parametrize("Homotopy", [KKTHomotopy, YuHomotopy])
@pytest.mark.parametrize("n", [4, 25])
def test_what_is_bounded_is_smaller(Homotopy, n):
    rng = np.random.default_rng(n)
    half = rng.normal(size=(n, n))
    homotopy = Homotopy(LCP(half @ half.T / n, rng.normal(size=n)))
    path = trace(homotopy)
    slabs = slabs_of(certify(path, homotopy).cells)
    radius, engine = slabs.cells.radius, engine_of(homotopy)
    judged, (Y_0, E) = engine.judge(slabs, radius), preconditioners(engine, slabs, radius)
    bounds = judged.misfit, judged.spread(radius, radius), judged._along(1), judged._turned(radius)
    shares = []
    for _ in range(20):
        x = slabs.offset * rng.uniform(-1.0, 1.0, len(slabs))
        p, slope, _ = (part.middle() for part in evaluated(slabs.cubic, thin(x[:, None])))
        for k, (at, d) in enumerate(zip(p, rng.choice([-1.0, 1.0], p.shape) * radius)):
            Y, v = (np.eye(p.shape[1]) - x[k] * E[k]) @ Y_0[k], rng.choice([-1.0, 1.0], p.shape[1]) * radius[k]
            near, here, far = (np.column_stack(homotopy.jacobian(u[:-1], u[-1])) for u in (at - d, at, at + d))
            values = (
                Y[:, :-1] @ homotopy.residual(at[:-1], at[-1]),
                v - Y @ (np.vstack([far, slabs.cells.chart[k]]) @ v),
                Y[:, :-1] @ (here @ slope[k]),
                Y[:, :-1] @ ((far - near) @ slope[k] / 2.0),
            )
            shares.append([(np.abs(value) / bound[k]).max() for value, bound in zip(values, bounds)])
    # Bounds that are far too large would prove nothing.
    assert (np.max(shares, axis=0) <= 1.0 + 1e-6).all()
    assert (np.max(shares, axis=0) > 0.5).all()


@pytest.mark.parametrize("A", [np.eye(2), [[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 1.0]]])
def test_an_end_at_which_all_of_a_row_is_zero_is_proved_in_rationals(A):
    q = np.append([-1.0, 1.0][: len(A) - 1], 0.0)
    homotopy = KKTHomotopy(LCP(A, q))
    _, proof = proved(homotopy)
    assert "rational arithmetic" in proof.end
