"""Curves of folds: known ones, in dense, banded and sparse families, in any units."""

import numpy as np
import pytest
from attrs import evolve
from numpy.polynomial.legendre import leggauss

import continuation
from continuation import Budget, Curve, Family, TargetValue, jets
from problems.bifurcation import Aircraft, Cusp

from .util import CuspForm, Gelfand, GelfandBanded, Imperfect, Rescaled, TakensBogdanov, first_fold, named

FOLDS = {
    "jets": (CuspForm(1.0), "mu", lambda u: (u[:, 1], u[:, 2])),
    "differences, since a validator wants floats": (Cusp(1.0), "splitting", lambda u: (u[:, 1], u[:, 2])),
    "through a pitchfork": (Imperfect(0.1), "eps", lambda u: (u[:, 2], u[:, 1])),
}


@pytest.mark.parametrize("case", FOLDS)
def test_the_whole_curve_through_a_cusp(case):
    homotopy, name, split = FOLDS[case]
    path = continuation.trace_both(
        Curve(Family(homotopy, name), first_fold(homotopy, direction=0 if name != "eps" else -1)),
        box={"lam": (-4.0, 4.0), "y": (-16.0, 16.0)},
        tolerance=1e-12,
    )
    a, b = split(path.u)
    assert np.abs(27.0 * a**2 - 4.0 * b**3).max() <= 1e-10
    (cusp,) = named(path, "cusp")
    assert np.abs(cusp.u).max() <= 1e-10
    assert {np.sign(u) for u in a} >= {-1.0, 1.0}


def height_of(nodes):
    """The time map of the perturbed Gelfand problem: lam as a function of u(0) and eps, by Gauss' formula."""
    x, w = leggauss(nodes)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    below = 1.0 - np.outer(x**2, x)

    def lam(top, eps):
        u = top * below
        slope = np.exp(u / (1.0 + eps * u)) @ w
        return 0.5 * (2.0 * np.sqrt(top) / np.sqrt(slope) @ w) ** 2

    return lam


def exact_cusp(nodes):
    """(u(0), eps, lam) where the first two derivatives of lam by u(0) vanish."""
    lam, z = height_of(nodes), np.array([4.9, 0.2458])

    def slopes(z):
        return jets.taylor(lambda top: lam(top, z[1]), z[0], 2)[1:]

    for _ in range(8):
        columns = [(slopes(z + h) - slopes(z - h)) / 2e-6 for h in 1e-6 * np.eye(2)]
        z = z - np.linalg.solve(np.array(columns).T, slopes(z))
    return np.append(z, lam(*z))


def test_the_cusp_of_the_perturbed_gelfand_problem():
    exact = exact_cusp(60)
    np.testing.assert_allclose(exact_cusp(80), exact, rtol=1e-13)
    homotopy = Gelfand()
    curve = Curve(Family(homotopy, "eps"), first_fold(homotopy))
    path = continuation.trace(curve, box={"y": (None, 12.0)}, tolerance=1e-12)
    for event in (*named(path, "cusp"), *path.turning_points):
        assert abs(event.lam - exact[1]) <= 1e-11
        assert abs(event.u[-2] - exact[2]) <= 1e-11
        assert abs(event.u[-3] - exact[0]) <= 1e-9
    assert len(named(path, "cusp")) == len(path.turning_points) == 1


def test_the_fold_curve_ends_in_the_problem_that_is_not_perturbed():
    homotopy = Gelfand()
    path = continuation.trace(Curve(Family(homotopy, "eps"), first_fold(homotopy)), target=0.0, tolerance=1e-12)
    assert path.status is continuation.Status.REACHED_TARGET
    assert abs(path.endpoint.y[-1] - 0.8784576797812903) <= 1e-11


@pytest.mark.parametrize("kind", ["banded", "sparse", "symmetric"])
def test_structures_give_one_curve(kind):
    found = []
    for member in (GelfandBanded(kind=kind), GelfandBanded(kind="dense")):
        curve = Curve(Family(member, "eps"), first_fold(member))
        found.append(continuation.trace(curve, box={"y": (None, 7.0)}))
    ours, dense = found
    assert len(ours) == len(dense)
    np.testing.assert_allclose(ours.u, dense.u, rtol=1e-5, atol=1e-9)
    (cusp,), (other,) = (named(path, "cusp") for path in found)
    assert abs(cusp.lam - other.lam) <= 1e-11


def test_operators_have_curves_of_values_alone():
    member = GelfandBanded(kind="operator")
    curve = Curve(Family(member, "eps"), TargetValue(0.5, 7), (np.full(16, 0.4), 0.8))
    path = continuation.trace(curve, box={"lam": (None, 0.4)}, tolerance=1e-10)
    assert np.abs(path.y[:, 7] - 0.5).max() <= 1e-12
    assert max(np.abs(GelfandBanded(u[-1]).residual(u[:-2], u[-2])).max() for u in path.u) <= 1e-10
    with pytest.raises(ArithmeticError, match="a matrix is needed here, and the Jacobian is an operator"):
        continuation.trace(Curve(Family(member, "eps"), first_fold(member)))


def test_two_jacobians_do_as_well_as_jets():
    member = GelfandBanded()
    fold = first_fold(member)
    calculus = Curve(Family(member, "eps"), fold)._calculus
    assert calculus.jets
    plain = evolve(calculus, jets=False)
    v, left = fold.tangent, np.cos(np.arange(16.0))
    exact = calculus.second(fold.u, 0.2, v, left)
    np.testing.assert_allclose(plain.second(fold.u, 0.2, v, left), exact, atol=1e-9 * np.abs(exact).max())
    np.testing.assert_allclose(plain.by_parameter(fold.u, 0.2), calculus.by_parameter(fold.u, 0.2), atol=1e-11)


def test_units_change_nothing():
    generator = np.random.default_rng(3)
    member = Gelfand(n=8)
    d, e = 2.0 ** generator.integers(-30, 30, (2, 8))
    other = Rescaled(Family(member, "eps"), d, e, 2.0**20, 0.2)
    box = {"lam": (0.15, None)}
    ours = continuation.trace(Curve(Family(member, "eps"), first_fold(member)), box=box)
    theirs = continuation.trace(Curve(Family(other, "mu"), first_fold(other)), box=box)
    assert len(ours) == len(theirs)
    assert ours.counts.rejected == theirs.counts.rejected
    scale = np.concatenate([d, [2.0**-20, 1.0]])
    np.testing.assert_allclose(theirs.u / scale, ours.u, rtol=1e-3)
    for event, other in zip(ours.turning_points, theirs.turning_points, strict=True):
        np.testing.assert_allclose(other.u / scale, event.u, rtol=1e-9)


def test_a_fold_curve_meets_a_hopf_curve():
    homotopy = TakensBogdanov()
    curve = Curve(Family(homotopy, "mu"), first_fold(homotopy, target=0.5))
    path = continuation.trace(curve, direction=-1, box={"lam": (-1.0, None)})
    (point,) = named(path, "Bogdanov-Takens")
    assert np.abs(point.u).max() <= 1e-12
    assert np.abs(path.y).max() <= 1e-12


def test_the_aircraft_has_a_cusp_in_the_elevator():
    homotopy = Aircraft(-0.05)
    curve = Curve(Family(homotopy, "elevator"), continuation.trace(homotopy).turning_points[0])
    path = continuation.trace(curve, box={"lam": (-0.06, 0.05)}, budget=Budget(steps=40))
    turn = path.turning_points[0]
    (cusp,) = named(path, "cusp")
    assert np.abs(cusp.u - turn.u).max() <= 1e-9
    # Beyond the cusp the two folds of a member are gone: its fold is on the other side of it.
    folds = continuation.trace(Aircraft(turn.lam + 1e-3)).turning_points
    assert all(abs(fold.lam - turn.u[-2]) > 0.03 for fold in folds)
