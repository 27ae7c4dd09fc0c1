"""Deflation: known solutions divided out, whatever the structure of H_y."""

import numpy as np
import pytest
import scipy.sparse as sp

from continuation import Deflated, check_jacobian, from_functions, solve_at
from continuation.diagrams.deflation import others
from continuation.linear import factor_bordered


def cubic(y, lam):
    return (y - 1.0) * (y - 2.0) * (y - 3.0) + lam


def coupled(structure):
    A = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])

    def jacobian(y, lam):
        return structure(A + np.diag(3.0 * y * y) - 4.0 * np.eye(3)), -np.ones(3)

    return from_functions(lambda y, lam: A @ y + y**3 - 4.0 * y - lam, jacobian, start=(np.zeros(3), 0.0))


def test_all_roots_of_a_cubic_are_found_from_one_guess():
    found = others(from_functions(cubic, start=([0.0], 0.0)), 0.0, [], [np.array([1.6])])
    np.testing.assert_allclose(np.sort(np.concatenate(found)), [1.0, 2.0, 3.0], rtol=1e-14)


def test_a_known_root_is_not_found_again():
    homotopy = from_functions(cubic, start=([0.0], 0.0))
    y = solve_at(homotopy, 0.0, [1.6])
    np.testing.assert_allclose(y, [2.0], rtol=1e-14)
    other = solve_at(Deflated(homotopy, [y]), 0.0, [1.6])
    assert abs(cubic(other[0], 0.0)) < 1e-12
    assert abs(other[0] - 2.0) > 0.5


def test_all_solutions_of_a_system_are_found():
    # Nine states of three coupled cubics at lam = 0 are odd pairs and zero: each is divided out when it is found.
    homotopy = coupled(np.asarray)
    guesses = [np.array([a, b, c]) for a in (-1.0, 1.0) for b in (-1.0, 0.5) for c in (-1.0, 1.0)]
    found = others(homotopy, 0.0, [np.zeros(3)], guesses)
    assert len(found) >= 6
    for y in found:
        assert np.abs(homotopy.residual(y, 0.0)).max() < 1e-12
        assert min(np.abs(y - other).max() for other in [np.zeros(3), *found] if other is not y) > 1e-3
        assert any(np.abs(y + other).max() < 1e-8 for other in found)


def test_the_derivative_is_right():
    deflated = Deflated(
        coupled(np.asarray), [np.array([1.0, 2.0, 0.0]), np.array([0.3, 0.1, -0.5])], power=2.0, shift=0.5
    )
    assert check_jacobian(deflated).correct


@pytest.mark.parametrize("structure", [np.asarray, sp.csc_array], ids=["dense", "sparse"])
def test_its_bordered_system_is_that_of_its_derivative(structure):
    known = [np.array([1.0, 2.0, 0.0]), np.array([0.3, 0.1, -0.5])]
    deflated = Deflated(coupled(structure), known, scale=[1.0, 2.0, 0.5])
    generator = np.random.default_rng(2)
    for _ in range(10):
        y, border, r = generator.standard_normal(3), generator.standard_normal(4), generator.standard_normal(3)
        system = deflated.bordered(y, 0.7, border)
        plain = factor_bordered(*deflated.jacobian(y, 0.7), border)
        np.testing.assert_allclose(system.solve(r, 0.4), plain.solve(r, 0.4), rtol=1e-9)
        assert system.sign == plain.sign


def test_what_is_no_solution_of_this_homotopy_is_refused():
    with pytest.raises(ValueError, match="known: expected solutions of 3 unknowns, found shape"):
        Deflated(coupled(np.asarray), [[1.0, 2.0]])
    with pytest.raises(ValueError, match="power"):
        Deflated(coupled(np.asarray), [], power=0.0)


def test_where_there_is_nothing_newtons_method_says_so():
    with pytest.raises(ArithmeticError, match="method at lam = 0 says"):
        solve_at(from_functions(lambda y, lam: y * y + 1.0 + lam, start=([0.0], -2.0)), 0.0, np.array([0.7]))


@pytest.mark.filterwarnings("error")
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


def test_solves_of_a_plugin_that_solve_nothing_lead_to_no_solution():
    class Lazy:
        sign = 1

        def solve(self, r, rho):
            return np.array([0.0, rho])

    class Wrong:
        def start(self):
            return np.zeros(1), 0.0

        def residual(self, y, lam):
            return y - 1.0

        def jacobian(self, y, lam):
            return np.ones((1, 1)), np.zeros(1)

        def bordered(self, y, lam, border):
            return Lazy()

    with pytest.raises(ArithmeticError, match="no round-off"):
        solve_at(Wrong(), 0.0, [3.0])
