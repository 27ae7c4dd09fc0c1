"""Deflation: known solutions divided out, whatever the structure of H_y."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp

from continuation import Deflated, check_jacobian, from_functions, solve_at
from continuation.diagrams.deflation import others
from continuation.linear import factor_bordered

A = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])
KNOWN = [np.array([1.0, 2.0, 0.0]), np.array([0.3, 0.1, -0.5])]
CUBIC = from_functions(lambda y, lam: (y - 1.0) * (y - 2.0) * (y - 3.0) + lam, start=([0.0], 0.0))


def coupled(structure=np.asarray):
    return from_functions(
        lambda y, lam: A @ y + y**3 - 4.0 * y - lam,
        lambda y, lam: (structure(A + np.diag(3.0 * y * y) - 4.0 * np.eye(3)), -np.ones(3)),
        start=(np.zeros(3), 0.0),
    )


def test_all_roots_of_a_cubic_are_found_from_one_guess_and_a_known_one_not_again():
    found = others(CUBIC, 0.0, [], [np.array([1.6])])
    np.testing.assert_allclose(np.sort(np.concatenate(found)), [1.0, 2.0, 3.0], rtol=1e-14)
    np.testing.assert_allclose(solve_at(CUBIC, 0.0, [1.6]), [2.0], rtol=1e-14)
    other = solve_at(Deflated(CUBIC, [np.array([2.0])]), 0.0, [1.6])
    assert np.abs(CUBIC.residual(other, 0.0)).max() < 1e-12
    assert abs(other[0] - 2.0) > 0.5


def test_all_solutions_of_a_system_are_found():
    # Nine states of three coupled cubics at lam = 0 are odd pairs and zero: each is divided out when it is found.
    guesses = [np.array([a, b, c]) for a in (-1.0, 1.0) for b in (-1.0, 0.5) for c in (-1.0, 1.0)]
    found = others(coupled(), 0.0, [np.zeros(3)], guesses)
    assert len(found) >= 6
    for y in found:
        assert np.abs(coupled().residual(y, 0.0)).max() < 1e-12
        assert min(np.abs(y - other).max() for other in [np.zeros(3), *found] if other is not y) > 1e-3
        assert any(np.abs(y + other).max() < 1e-8 for other in found)


@pytest.mark.parametrize("structure", [np.asarray, sp.csc_array], ids=["dense", "sparse"])
@pytest.mark.parametrize("options", [{"power": 2.0, "shift": 0.5}, {"scale": [1.0, 2.0, 0.5]}])
def test_its_derivative_is_right_and_its_bordered_system_that_of_it(structure, options):
    assert check_jacobian(Deflated(coupled(), KNOWN, **options)).correct
    deflated, generator = Deflated(coupled(structure), KNOWN, **options), np.random.default_rng(2)
    for _ in range(10):
        y, border, r = generator.standard_normal(3), generator.standard_normal(4), generator.standard_normal(3)
        system = deflated.bordered(y, 0.7, border)
        plain = factor_bordered(*deflated.jacobian(y, 0.7), border)
        np.testing.assert_allclose(system.solve(r, 0.4), plain.solve(r, 0.4), rtol=1e-9)
        assert system.sign == plain.sign


@pytest.mark.parametrize(
    ("known", "options", "words"),
    [([[1.0, 2.0]], {}, "known: expected solutions of 3 unknowns, found shape"), ([], {"power": 0.0}, "power")],
)
def test_what_is_no_solution_of_this_homotopy_is_refused(known, options, words):
    with pytest.raises(ValueError, match=words):
        Deflated(coupled(), known, **options)


@pytest.mark.parametrize(
    ("function", "known"),
    [
        (lambda y, lam: np.expm1(y), [[0.0]]),
        (lambda y, lam: y * y - 1.0, [[1.0], [-1.0]]),
        (lambda y, lam: np.arctan(y), [[0.0]]),
        (lambda y, lam: np.array([y[0] ** 2 - 1.0, y[1] - y[0]]), [[1.0, 1.0], [-1.0, -1.0]]),
    ],
    ids=["exp", "square", "arctan", "two"],
)
def test_where_every_root_is_known_no_guess_finds_another(function, known):
    # exp(y) - 1 far to the left: H_y = 1e-58, by which the change of rank one lost every digit of the increment.
    generator = np.random.default_rng(3)
    deflated = Deflated(from_functions(function, start=(known[0], 0.0)), known)
    for guess in [*map(np.array, known), *(generator.normal(size=len(known[0])) * 10.0**k for k in range(-2, 4))]:
        with pytest.raises(ArithmeticError):
            solve_at(deflated, 0.5, guess)


WRONG = SimpleNamespace(
    start=lambda: (np.zeros(1), 0.0),
    residual=lambda y, lam: y - 1.0,
    bordered=lambda y, lam, border: SimpleNamespace(sign=1, solve=lambda r, rho: np.array([0.0, rho])),
)
"""y = 1, by factors that solve nothing."""


@pytest.mark.parametrize(
    ("homotopy", "guess", "words"),
    [
        (from_functions(lambda y, lam: y * y + 1.0 + lam, start=([0.0], -2.0)), 0.7, "method at lam = 0 says"),
        (WRONG, 3.0, "no round-off"),
    ],
    ids=["no solution", "factors that solve nothing"],
)
def test_where_no_solution_is_found_newtons_method_says_so(homotopy, guess, words):
    with pytest.raises(ArithmeticError, match=words):
        solve_at(homotopy, 0.0, [guess])
