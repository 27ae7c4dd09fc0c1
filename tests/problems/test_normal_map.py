"""Complementarity problems with a parameter along their kinked paths, against answers from elsewhere."""

import numpy as np
import pytest

from continuation import Budget, Kind, Monitor, Status, TargetValue, trace
from continuation.linear import Banded
from continuation.testing import check_homotopy
from problems.nonlinear import NormalMap, bratu_under_obstacle

from .test_conformance import chain

PSI = 2.0
FOLD = 8.0 * np.exp(-PSI) * np.arccosh(np.exp(PSI / 2.0)) ** 2
OFF = Monitor(lambda u, v: float(np.abs(u).max()) - 100.0, "off", terminal=1)


@pytest.fixture(scope="module")
def bratu():
    """Paths under the obstacle for three meshes."""
    return {n: trace(bratu_under_obstacle(n, PSI, target=6.0)) for n in (19, 39, 99)}


def test_bratu_under_an_obstacle_turns_in_a_kink(bratu):
    known = {19: 2.969647, 39: 2.973134, 99: 2.974110}
    errors = {}
    for n, path in bratu.items():
        assert path.status is Status.REACHED_TARGET
        fold, kink = path.events[:2]
        assert (fold.name, fold.kind) == ("turning point", Kind.TURNING_POINT)
        assert (kink.name, kink.switches) == ("turning kink", (n // 2,))
        assert kink.lam == pytest.approx(known[n], abs=1e-6)
        errors[n] = (kink.lam - FOLD) * (n + 1) ** 2
    assert max(errors.values()) / min(errors.values()) == pytest.approx(1.0, abs=1e-3)


def kojima_shindo(x):
    """The four functions."""
    a, b, c, d = x[0], x[1], x[2], x[3]
    return np.stack([
        3 * a**2 + 2 * a * b + 2 * b**2 + c + 3 * d - 6, 2 * a**2 + a + b**2 + 10 * c + 2 * d - 2,
        3 * a**2 + a * b + 2 * b**2 + 2 * c + 9 * d - 9, a**2 + 3 * b**2 + 2 * c + 3 * d - 3,
    ])  # fmt: skip


def test_kojima_and_shindos_two_solutions_on_one_path():
    problem = NormalMap(lambda x, lam: kojima_shindo(x) + 10.0 * lam, x0=np.zeros(4), lam0=1.0, target=None)
    path = trace(problem, direction=-1, events=[TargetValue(0.0, terminal=0), OFF])
    solutions = [problem.x(event.y) for event in path.events if event.name != "off" and abs(event.lam) < 1e-14]
    assert np.abs(solutions[0] - [1.0, 0.0, 3.0, 0.0]).max() < 1e-13
    # The other one is degenerate: two components of x and F vanish there, and the path has a turning kink in it.
    assert np.abs(solutions[-1] - [np.sqrt(6.0) / 2.0, 0.0, 0.0, 0.5]).max() < 1e-13
    # At lam = 0.3 it goes on in the fold of another piece: the parameter stands still there and turns neither way.
    assert [event.name for event in path.events[:2]] == ["kink", "kink"]


def banded(n):
    """The chain in bands."""
    return Banded(np.array([np.full(n, -1.0), np.full(n, 2.5), np.full(n, -1.0)]), 1, 1)


@pytest.mark.parametrize("make", [lambda n: chain(n).toarray(), chain, banded], ids=["dense", "sparse", "banded"])
@pytest.mark.parametrize("count", [0, 3, 8])
def test_columns_of_unknowns_at_bounds_are_those_of_the_identity(make, count):
    generator = np.random.default_rng(5)
    problem = NormalMap.affine(make(8), np.ones(8), np.ones(8), x0=np.zeros(8), lam0=1.0)
    free = generator.permutation(np.arange(8) < count)
    H_y, H_lam = problem.piece(np.where(free, 1, -1)).jacobian(np.zeros(8), 0.0)
    np.testing.assert_allclose(H_y @ np.eye(8), np.where(free, chain(8).toarray(), np.eye(8)))
    np.testing.assert_array_equal(H_lam, 1.0)


def test_random_paths_end_in_solutions():
    generator, reached = np.random.default_rng(6), 0
    for _ in range(40):
        n = int(generator.integers(1, 6))
        A, q = generator.integers(-3, 4, (n, n)) + 0.0, generator.integers(-4, 5, n) + 0.0
        problem = NormalMap.affine(A, q, np.ones(n), x0=np.zeros(n), lam0=float(1.5 - q.min()))
        path = trace(problem, events=[OFF], budget=Budget(steps=99))
        assert path.status not in (Status.STEP_TOO_SMALL, Status.START_NOT_ON_PATH, Status.BUDGET_EXHAUSTED)
        for step in path.steps:
            x = np.maximum(step.y, 0.0)
            w = A @ x + q + step.lam
            assert min(x.min(), w.min()) > -1e-7
            assert abs(x @ w) < 1e-6
        reached += path.status is Status.REACHED_TARGET
    assert reached >= 10


def cubic(x, lam):
    """Plain numpy, for jets."""
    return x**3 + x - lam * np.array([1.0, 2.0]) + 0.5


CONFORMING = {
    "bratu": lambda: bratu_under_obstacle(9, PSI, target=6.0),
    "a box, sparse": lambda: NormalMap.affine(
        chain(6), np.full(6, 1.0), np.linspace(-2.0, -3.0, 6), x0=np.zeros(6), lam0=0.0, upper=0.7, target=1.0
    ),
    "without a derivative": lambda: NormalMap(cubic, x0=np.zeros(2), lam0=0.0, target=1.0),
}


@pytest.mark.parametrize("name", CONFORMING)
def test_it_conforms(name):
    check_homotopy(CONFORMING[name]())


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"lower": [0.0, 1.0]}, "lower: expected 1 numbers"),
        ({"lower": 1.0, "upper": 0.0}, "lower: expected at most upper"),
        ({"lower": 1.0, "upper": 1.0}, "lower: expected less than upper"),
        ({"jacobian": lambda x, lam: (np.eye(3), np.ones(1))}, "jacobian: expected a pair"),
    ],
    ids=["length", "order", "fixed", "shape"],
)
def test_bad_input_is_named(wrong, message):
    arguments = {"F": lambda x, lam: x - lam, "x0": [0.0], "lam0": 0.0, **wrong}
    with pytest.raises((TypeError, ValueError), match=message):
        NormalMap(arguments.pop("F"), arguments.pop("jacobian", None), **arguments)


def test_bad_affine_data_are_named():
    with pytest.raises(ValueError, match="A: expected a square matrix"):
        NormalMap.affine(np.eye(2), [1.0], [1.0], x0=[0.0], lam0=0.0)
    with pytest.raises(ValueError, match="psi: expected a positive number"):
        bratu_under_obstacle(9, -1.0)


def test_friction_slips_when_the_bound_is_reached():
    # A block on a spring of stiffness 1, pulled by 2 lam, with friction at most 1 + lam: it slips from lam = 1 on.
    block = NormalMap.affine(
        [[1.0]], [0.0], [-2.0], x0=[0.0], lam0=0.0, lower=-1.0, upper=1.0, lower_rate=-1.0, upper_rate=1.0, target=3.0
    )
    path = trace(block)
    (kink,) = path.kinks
    assert kink.lam == pytest.approx(1.0, rel=1e-15)
    assert block.x(path.endpoint.y, path.endpoint.lam)[0] == pytest.approx(4.0, rel=1e-15)
