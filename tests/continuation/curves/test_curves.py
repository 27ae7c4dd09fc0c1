"""Curves of branch points, kinks, values and monitors; what a curve is asked for; files, proofs, and the suite."""

import re

import numpy as np
import pytest

import continuation
from continuation import Budget, Curve, Family, Kind, KinkPoint, Monitor, TargetValue, TurningPoint
from continuation.archive import open_archive, resume
from continuation.counts import Counts
from continuation.evaluation.errors import NotFiniteError
from continuation.evaluation.evaluator import Evaluator
from continuation.testing import check_homotopy
from problems import lcp

from ...util import path_of
from .util import (
    Bent,
    GelfandBanded,
    Lorenz,
    brusselator,
    coupled,
    cusp_form,
    first_fold,
    imperfect,
    named,
    ring,
    steep,
    takens_bogdanov,
    wing,
    zero_hopf,
)


def folds():
    return Curve(imperfect, first_fold(imperfect(), direction=-1), mu=0.1)


def uneven(u, v):
    """It has no power of the tangent's length as a factor."""
    return v[0] ** 4 - 0.09 * u[0] ** 4 * v[1] ** 2


def last_kink():
    """Of the bent line, where it leaves the circle of radius 5^(1/2)."""
    return continuation.trace(Bent(), start=(np.array([-1.6]), -0.8), box={"lam": (-0.8, 2.0)}).kinks[-1]


SIDE = {"box": {"lam": (-1.0, 1.0), "y": (-5.0, 5.0)}}
CLOSED = {
    "a value": (
        Curve(imperfect, TargetValue(1.5), (np.array([1.2]), 1.5), mu=-0.07), SIDE,
        lambda y, lam, mu: (lam - 1.5, lam * y - y**3 + mu), {},
    ),
    "a monitor": (
        Curve(imperfect, Monitor(lambda u, v: u[0] ** 2 + u[1] ** 2 - 1.0), (np.array([0.2]), 1.0), mu=0.1), SIDE,
        lambda y, lam, mu: (y**2 + lam**2 - 1.0, lam * y - y**3 + mu), {},
    ),
    # dy/dlam = y / (3 y^2 - lam) = -0.4 there.
    "a slope": (
        Curve(imperfect, Monitor(steep), (np.array([-1.2]), 1.4), mu=0.1), SIDE,
        lambda y, lam, mu: 1.2 * y**2 - 0.4 * lam + y, {},
    ),
    "kinks until another switch vanishes": (
        Curve(Family(Bent(), "mu"), last_kink()), {"direction": -1},
        lambda y, lam, mu: (5.0 * lam**2 - mu, y - 2.0 * lam), {"switch 1 vanishes": (-1.0, -0.5, 1.25)},
    ),
    "Hopf points until the frequency is zero": (
        Curve(takens_bogdanov, Kind.HOPF, (np.array([-1.0, 0.0]), -1.0), mu=1.0), {"direction": -1},
        lambda y, z, lam, frequency, mu: (y + mu, z, lam + mu**2, frequency**2 - 2.0 * mu),
        {"Bogdanov-Takens": np.zeros(5)},
    ),
    "Hopf points past where the equilibrium turns": (
        Curve(zero_hopf, Kind.HOPF, (np.array([-1.0, 0.0, 0.0]), 1.0), mu=1.0),
        {"direction": -1, "box": {"lam": (-1.5, None)}},
        lambda x, y, z, lam, frequency, mu: (lam - mu**2, frequency - 2.0),
        {"zero-Hopf": (0.0, 0.0, 0.0, 0.0, 2.0, 0.0)},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CLOSED)
def test_points_of_a_curve_are_those_of_its_closed_form(name):
    curve, options, off, special = CLOSED[name]
    path = path_of(curve, tolerance=1e-12, **options, status=continuation.Status.STOPPED_AT_EVENT)
    assert np.abs(off(*path.u.T)).max() <= 1e-10
    for event, u in special.items():
        np.testing.assert_allclose([at.u for at in named(path, event)], [u], rtol=0, atol=1e-10)


def test_a_kink_by_its_event():
    by_event = Curve(Family(Bent(), "mu"), KinkPoint(), (np.array([1.9]), 1.1))
    np.testing.assert_allclose(by_event.start()[0], [2.0, 1.0])


def test_a_condition_that_nothing_near_meets_has_no_curve():
    curve = Curve(imperfect, Monitor(lambda u, v: 1.0 + u[0] ** 2), (np.array([-1.2]), 1.4), mu=0.1)
    assert continuation.trace(curve).status is continuation.Status.START_NOT_ON_PATH


def test_a_family_with_a_factorisation_of_its_own():
    generator = np.random.default_rng(1)
    A, q, d = generator.standard_normal((5, 5)), *generator.standard_normal((2, 5))

    def family(mu):
        return lcp.KKTHomotopy(lcp.LCP(A @ A.T + np.eye(5), q - 1.0 + mu * d), x0=np.full(5, 0.7))

    u = continuation.trace(family(0.0)).crossings(0.5)[0]
    path = path_of(Curve(family, TargetValue(0.5), (u[:-1], u[-1]), mu=0.0), target=0.3)
    assert np.abs(path.y[:, -1] - 0.5).max() <= 1e-12
    there = continuation.solve_at(family(0.3), 0.5, u[:-1])
    np.testing.assert_allclose(path.endpoint.y[:-1], there, rtol=1e-7)


def topmost(a):
    """Where y_1 turns on the ring."""
    path = continuation.trace(ring(a), events=[TurningPoint(1)], box={"y": (-3.0, 3.0)})
    return named(path, "turning point of component 1")


def test_where_an_unknown_turns():
    curve = Curve(ring, TurningPoint(1), topmost(1.0)[0], mu=1.0)
    path = continuation.trace(curve, box={"lam": (None, 3.0)}, tolerance=1e-12)
    # The members themselves say where it turns.
    for u in path.u[1:]:
        assert min(np.abs(event.u - u[:-1]).max() for event in topmost(u[-1])) <= 1e-10


def test_a_resumed_curve_is_the_one_that_was_never_stopped(tmp_path):
    curve, box = folds(), {"lam": (-1.0, 0.4)}
    continuation.trace(curve, archive=tmp_path / "a.h5", budget=Budget(steps=3), box=box, direction=-1)
    whole = continuation.trace(curve, budget=Budget(steps=8), box=box, direction=-1)
    again = resume(tmp_path / "a.h5", trust=[imperfect], budget=Budget(steps=8))
    assert named(again, "cusp")
    assert np.array_equal(again.u, whole.u)
    assert [event.name for event in again.events] == [event.name for event in whole.events]
    with open_archive(tmp_path / "a.h5") as stored:
        assert stored.path(0).labels.parameter_name == "mu"


def pitchforks():
    """From the first of the coupled trunk."""
    trunk = continuation.trace(coupled(), direction=-1, box={"lam": (2.5, None)})
    return Curve(coupled, next(event for event in trunk.events if event.kind == Kind.BRANCH_POINT), mu=1.0)


KINDS = {
    "folds": folds,
    "Hopf points": lambda: Curve(Family(Lorenz(), "b"), Kind.HOPF, wing(25.0)),
    "branch points": pitchforks,
    "a slope": lambda: Curve(imperfect, Monitor(steep), (np.array([-1.2]), 1.4), mu=0.1),
    "no homogeneous condition": lambda: Curve(imperfect, Monitor(uneven), (np.array([-0.95]), 1.008), mu=0.1),
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_suite_of_homotopies_passes(kind):
    """Its eliminations are the bordered matrix, with the sign of the determinant, and its derivatives right."""
    check_homotopy(KINDS[kind](), steps=5)


class Plain:
    """Not an attrs class."""

    target = None

    def __init__(self, c):
        self.c = c

    def start(self):
        return np.array([-2.0]), self.c - 4.0

    def residual(self, y, lam):
        return self.c - lam - y**2


def test_attributes_of_plain_objects():
    family = Family(Plain(1.0), "c")
    assert family(3.0).c == 3.0
    assert family.homotopy.c == 1.0
    path = continuation.trace(Curve(family, first_fold(Plain(1.0))), target=2.0)
    np.testing.assert_allclose(path.y[:, 1], path.lam, atol=1e-12)


NEAR = "at: expected a pair of eigenvalues of H_y near the imaginary axis, found "
AWAY = brusselator, Kind.HOPF, (np.array([1.0, 1.2]), 1.2)
OPERATOR = GelfandBanded(kind="operator")
BRANCH_POINTS = Curve(coupled, Kind.BRANCH_POINT, (np.array([1.0, -1.0]), 3.0), mu=1.0)
WRONG = {
    "no family": (lambda: Curve(3.0, Kind.HOPF, (np.zeros(1), 0.0)), TypeError, "family: expected a function"),
    "no mu": (lambda: Curve(cusp_form, Kind.HOPF, (np.zeros(1), 0.0)), ValueError, "mu: expected a number"),
    "an infinite mu": (
        lambda: Curve(cusp_form, Kind.HOPF, (np.zeros(1), 0.0), mu=np.inf), ValueError, "mu: expected a finite",
    ),
    "no point": (lambda: Curve(cusp_form, Kind.HOPF, mu=1.0), TypeError, "at: expected a located event, a step"),
    "half a point": (
        lambda: Curve(cusp_form, Kind.HOPF, (np.zeros(1), np.nan), mu=1.0), ValueError, "at: expected finite",
    ),
    "a kind without a condition": (
        lambda: Curve(cusp_form, Kind.EVENT, (np.zeros(1), 0.0), mu=1.0), TypeError, "event: expected a turning",
    ),
    "a turn of an unknown": (
        lambda: Curve(
            ring, topmost(1.0)[0], mu=1.0,
        ), ValueError, "give TurningPoint(component), and the point as `at`",
    ),
    "sizes of another number": (
        lambda: Curve(cusp_form, Kind.TURNING_POINT, (np.zeros(1), 0.0), mu=1.0, size=[1.0]),
        ValueError, "size: expected 2 positive numbers",
    ),
    "another number of unknowns": (
        lambda: Curve(cusp_form, Kind.TURNING_POINT, (np.zeros(2), 0.0), mu=1.0),
        ValueError, "at: expected 1 unknowns, as the family has, found 2",
    ),
    "no kinks": (
        lambda: Curve(cusp_form, Kind.KINK, (np.zeros(1), 0.0), mu=1.0),
        TypeError, "family: expected piecewise smooth homotopies",
    ),
    "branch points that part": (
        lambda: continuation.trace(Curve(imperfect, Kind.BRANCH_POINT, (np.zeros(1), 0.0), mu=0.0)),
        ValueError, "family: expected branch points for every mu, as in symmetric problems",
    ),
    "no pair of eigenvalues": (
        lambda: continuation.trace(Curve(cusp_form, Kind.HOPF, (np.zeros(1), 0.0), mu=1.0)), ValueError, NEAR + "none",
    ),
    "no pair near the axis": (
        lambda: continuation.trace(Curve(*AWAY, mu=1.0)), ValueError, NEAR + "-0.4+0.917j",
    ),
    "folds of an operator": (
        lambda: continuation.trace(Curve(Family(OPERATOR, "eps"), first_fold(OPERATOR))),
        ArithmeticError, "a matrix is needed here, and the Jacobian is an operator",
    ),
    "a proof of branch points": (
        lambda: continuation.certify(continuation.trace(BRANCH_POINTS, box={"lam": (0.5, 2.0)}), BRANCH_POINTS),
        TypeError, "residual of a branch point curve is not plain arithmetic: it takes a factor",
    ),
    "no such attribute": (lambda: Family(Plain(1.0), "nu"), ValueError, "name: expected an attribute of Plain"),
    "an attribute that is no number": (lambda: Family(Plain(1.0), "start"), TypeError, "start: expected a number to"),
    "no name": (lambda: Family(Plain(1.0), 3), TypeError, "name: expected the name of an attribute"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_said(case):
    make, error, sentence = WRONG[case]
    with pytest.raises(error, match=re.escape(sentence)):
        make()


def test_a_frequency_that_is_told_is_believed():
    told = Curve(*AWAY, mu=1.0, frequency=1.0)
    np.testing.assert_allclose(told.start()[0][2:], [2.0, 1.0], atol=1e-12)


def raising(y, lam):
    raise ValueError("no such state")


def test_an_exception_of_the_family_is_said():
    def family(mu):
        if mu > 1.5:
            return continuation.from_functions(raising, start=([0.0], 0.0))
        return cusp_form(mu)

    curve = Curve(family, first_fold(cusp_form(1.0)), mu=1.0)
    path = path_of(curve, target=3.0, budget=Budget(steps=60), status=continuation.Status.LEFT_DOMAIN)
    assert "no such state" in path.message
    with pytest.raises(NotFiniteError, match="no such state"):
        Evaluator(Curve(family, TargetValue(0.3), curve.at, mu=1.0), Counts()).residual(np.array([0.5, 0.3, 2.0]))
