"""The same model in numpy, JAX, CasADi and SymPy: the same path; and what the adapters refuse."""

import pickle
import sys
from itertools import pairwise

import numpy as np
import pytest

import continuation
from continuation import FAST, SERIES, trace
from continuation.linear import Banded
from problems.bifurcation import Bratu1D

from ...util import benchmark, by_preset, path_of

five = benchmark("five.py")
MODELS = {"brusselator": five.brusselator(6), "network": five.network(3, 8)}
WAYS = ("jax", "jax sparse", "casadi", "sympy", "residual only")

PRESETS = {"brusselator": FAST, "network": SERIES}


@pytest.fixture(scope="module")
def plain():
    return {name: trace(five.ways(model)["numpy"](), preset=PRESETS[name]) for name, model in MODELS.items()}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", MODELS)
def test_the_same_path_whoever_wrote_the_residual(name, way, plain):
    if way != "residual only":
        pytest.importorskip(way.split()[0])
    path, own = trace(five.ways(MODELS[name])[way](), preset=PRESETS[name]), plain[name]
    assert path.status is own.status is continuation.Status.REACHED_TARGET
    np.testing.assert_allclose(path.endpoint.u, own.endpoint.u, rtol=0, atol=1e-7)
    folds, wanted = ([point.lam for point in one.turning_points] for one in (path, own))
    np.testing.assert_allclose(folds, wanted, rtol=0, atol=1e-10)
    assert len(wanted) == (0 if name == "brusselator" else 2)


@pytest.mark.parametrize("way", WAYS[:-1])
def test_derivatives_are_right_and_homotopies_can_be_sent_elsewhere(way):
    pytest.importorskip(way.split()[0])
    homotopy = five.ways(MODELS["brusselator"])[way]()
    if way != "jax sparse":
        assert continuation.check_jacobian(homotopy).correct
    if way.startswith("jax"):
        # JAX's functions are sent by their module and name.
        kind = way.partition(" ")[2] or "dense"
        homotopy = continuation.from_jax(layers, ([0.0, 0.0], 0.0), target=1.0, jacobian=kind)
    other = pickle.loads(pickle.dumps(homotopy))
    y, lam = homotopy.start()
    np.testing.assert_array_equal(homotopy.residual(y, lam), other.residual(y, lam))
    assert homotopy.target == other.target


def layers(y, lam):
    import jax

    return y + 0.5 * jax.numpy.tanh(y[::-1]) - lam


def by_jax(residual, start, **more):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    return continuation.from_jax(residual, start, **more)


def test_the_sparse_derivative_of_jax_is_banded_where_it_is():
    pytest.importorskip("jax")

    def chain(y, lam):
        import jax

        u = jax.numpy.concatenate((jax.numpy.zeros(1), y, jax.numpy.zeros(1)))
        return u[:-2] - 2.0 * y + u[2:] + lam / 6561.0 * jax.numpy.exp(y)

    homotopy = by_jax(chain, (np.zeros(80), 0.0), target=None, jacobian="sparse")
    stop = continuation.TurningPoint(terminal=1)
    path = trace(homotopy, events=[stop])
    bratu = trace(Bratu1D(80), events=[stop])
    assert path.turning_points[0].lam == pytest.approx(bratu.turning_points[0].lam, rel=1e-12)
    assert path.counts.notes == {"H' by differential in 3 groups of columns"}


def test_what_jet_does_not_know_arrives_through_points_of_the_path():
    def unknown(y, lam):
        import jax

        return y + 0.1 * jax.scipy.special.gammaln(2.0 + y) - lam

    homotopy = by_jax(unknown, ([0.0], 0.0), target=1.0)
    assert not hasattr(homotopy, "taylor")
    path = path_of(homotopy, preset=SERIES)
    assert any("points of the path" in note for note in path.counts.notes)


def in_single_precision():
    import jax

    jax.config.update("jax_enable_x64", False)
    try:
        continuation.from_jax(layers, ([0.0], 0.0))
    finally:
        jax.config.update("jax_enable_x64", True)


def by_casadi(rows=2, function=None):
    import casadi as ca

    y, lam = ca.SX.sym("y", 2), ca.SX.sym("lam")
    return continuation.from_casadi(function or ca.Function("H", [y, lam], [y - lam]), (np.zeros(rows), 0.0))


def by_sympy(equation, *unknowns, start=([0.0], 0.0)):
    import sympy

    return continuation.from_sympy([sympy.sympify(equation)], sympy.symbols(unknowns), sympy.Symbol("lam"), start)


ROUNDED = "residual: expected a function.*float64"
REFUSED = {
    "jax in single precision": (in_single_precision, r"jax: expected double precision.*jax_enable_x64"),
    "jax, rounded": (lambda: by_jax(lambda y, lam: (y - lam).astype("float32"), ([0.0], 0.0)), ROUNDED),
    "jax, one number": (lambda: by_jax(lambda y, lam: lam, ([0.0, 1.0], 0.0)), ROUNDED),
    "jax, no kind": (
        lambda: by_jax(layers, ([0.0], 0.0), jacobian="full"),
        "jacobian: expected one of dense, sparse, found 'full'",
    ),
    "jax, no function": (lambda: by_jax(None, ([0.0], 0.0)), "residual: expected a function"),
    "casadi, no function": (lambda: by_casadi(function=len), r"function: expected a casadi.Function"),
    "casadi, a shape": (lambda: by_casadi(3), r"function: expected \(\(3, 1\), \(1, 1\)\) -> \(3, 1\), found"),
    "sympy, one row": (lambda: by_sympy("x - lam", "x", "other"), "expressions: expected as many as unknowns"),
    "sympy, a symbol": (
        lambda: by_sympy("x - lam + other", "x"), r"expressions: expected no symbols but.*\['other'\]"
    ),
    "sympy, no pair": (lambda: by_sympy("x - lam", "x", start=[0.0]), "start: expected a pair"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_does_not_fit_is_refused(case):
    make, words = REFUSED[case]
    pytest.importorskip(case.split(",")[0].split()[0])
    with pytest.raises((TypeError, ValueError), match=words):
        make()


def test_sympy_is_banded_where_it_is_and_takes_constant_equations():
    sympy = pytest.importorskip("sympy")
    y, lam = sympy.symbols("y:70"), sympy.Symbol("lam")
    rows = [y[0] - 1, *(b - a * sympy.Rational(1, 2) - lam for a, b in pairwise(y))]
    homotopy = continuation.from_sympy(rows, y, lam, ([1.0 * 0.5**k for k in range(70)], 0.0), target=1.0)
    assert isinstance(homotopy.jacobian(*homotopy.start())[0], Banded)
    for preset in (FAST, SERIES):
        path = trace(homotopy, preset=preset)
        assert path.endpoint.y[-1] == pytest.approx(2.0, abs=1e-9)
        assert not path.counts.notes
    constant = continuation.from_sympy([y[0] - 2, y[1] - lam * y[0]], y[:2], lam, ([2.0, 0.0], 0.0), target=1.0)
    assert trace(constant, preset=SERIES).endpoint.y == pytest.approx([2.0, 2.0])


@by_preset(FAST, SERIES)
@pytest.mark.parametrize("text", [
    "erf(y) + y", "besselj(1, y) + 2*y", "Abs(y - 5) + 2*y - 5", "sign(y + 3) + y - 1", "Heaviside(y + 3) + y - 1",
])  # fmt: skip
def test_special_functions_sizes_and_jumps_of_sympy_are_followed(text, preset):
    sympy = pytest.importorskip("sympy")
    y, lam = sympy.symbols("y lam")
    homotopy = continuation.from_sympy([sympy.sympify(text) - lam], [y], lam, ([0.0], 0.0), target=1.0)
    path = path_of(homotopy, preset=preset)
    assert homotopy.residual(path.endpoint.y, 1.0) == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize("name", ["jax", "casadi", "sympy"])
def test_what_is_not_installed_is_named(name, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ImportError, match=rf"pip install 'pseudoarclength\[{name}\]'"):
        {
            "jax": lambda: continuation.from_jax(layers, ([0.0], 0.0)),
            "casadi": lambda: continuation.from_casadi(None, ([0.0], 0.0)),
            "sympy": lambda: continuation.from_sympy([], [], None, ([0.0], 0.0)),
        }[name]()
