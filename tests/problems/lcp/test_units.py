"""Units must not matter: scaling, certificates and outcomes are the same for LCP(q, A) and LCP(D q, D A E)."""

from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from problems import lcp
from problems.lcp import Outcome
from problems.lcp.data.scaling import balanced
from problems.lcp.proof.compensated import row_terms
from problems.lcp.proof.farkas import FloatFarkas, infeasibility

from ...util import benchmark
from .util import powers, solution_of

campaign = benchmark("claims.py")


@pytest.mark.parametrize(("mode", "number"), [("units", 60), ("factor", 20), ("truth", 60), ("bounds", 300)])
def test_the_benchmark_of_claims_finds_nothing_wrong(capsys, mode, number):
    assert campaign.CAMPAIGN.run(number, 3, [mode]) == 0, capsys.readouterr().out


@pytest.mark.parametrize("make", [np.asarray, sp.csr_array])
def test_scaling_brings_rows_and_columns_to_about_one_keeps_symmetry_and_is_undone(make):
    rng = np.random.default_rng(0)
    M, D, E = rng.standard_normal((30, 30)), powers(rng, 30, 26), powers(rng, 30, 26)
    problem = lcp.LCP(make(D[:, None] * (M + M.T) * E), rng.standard_normal(30) * 1e7)
    scaled = balanced(problem)
    A = scaled.problem.A.toarray() if scaled.problem.sparse else scaled.problem.A
    np.testing.assert_array_equal(A, A.T)
    for largest in (np.abs(A).max(axis=0), np.abs(A).max(axis=1)):
        assert 0.2 < largest.min() <= largest.max() < 3.0
    assert 0.5 <= np.abs(scaled.problem.q).max() < 2.0
    u = rng.random(30)
    np.testing.assert_array_equal(scaled.u(scaled.x(u)), u)
    np.testing.assert_array_equal(np.ldexp(problem.w(scaled.x(u)), scaled.rows), scaled.problem.w(u))
    assert scaled.exact


@pytest.mark.parametrize(("bounds", "rows", "columns"), [(False, 300, 300), (True, 900, 100)])
@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None)
def test_the_verdict_of_a_certificate_knows_no_units(bounds, rows, columns, seed):
    """The relative residual of any x, negative entries and violated rows and bounds included, to round-off."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 7))
    A, q = rng.integers(-2, 3, (n, n)).astype(float), rng.integers(-2, 3, n).astype(float)
    x = rng.choice([-1.0, 1.0, 2.0] if bounds else [-1.0, 0.0, 1.0, 2.0], n) * 10.0 ** rng.uniform(-12, 2, n)
    D, E, lower = powers(rng, n, rows), powers(rng, n, columns), bounds * rng.integers(-2, 3, n).astype(float)
    upper = lower + rng.choice([1.0 if bounds else np.inf, np.inf], n)
    one = lcp.certify(lcp.MixedLCP(A, q, lower, upper), x)
    other = lcp.certify(lcp.MixedLCP(D[:, None] * A * E, D * q, lower / E, upper / E), x / E)
    assert one.relative_residual == pytest.approx(other.relative_residual, rel=1e-13)
    assert bounds or one.drowned == other.drowned


@pytest.mark.parametrize("size", [1e300, 1.0, 1e-5])
def test_what_only_a_subnormal_entry_is_off_by_is_rounding(size):
    assert lcp.certify(lcp.LCP([[size, 0.0], [0.0, 1.0]], [0.0, 1.0]), np.array([5e-324, 0.0])).solves()


@pytest.mark.parametrize(("share", "solves"), [(1.001, True), (0.999, False)])
def test_the_relative_residual_is_a_backward_error(share, solves):
    """x solves the problem whose entries are changed by that much relatively, and none whose are changed by less."""
    rng = np.random.default_rng(2)
    A, x = rng.standard_normal((6, 6)), np.array([0.7, 0.0, 1.3, 0.0, 0.2, 0.0])
    q = np.where(x > 0, -A @ x, 1.0) + 1e-3 * rng.standard_normal(6) * (x > 0)
    certificate = lcp.certify(lcp.LCP(A, q), x)
    assert 1e-5 < certificate.relative_residual < 1e-2
    # The extreme changes of all entries of a row move w_i by that share of its size, either way.
    w, moved = certificate.w, share * certificate.relative_residual * (np.abs(A) @ x + np.abs(q))
    assert ((np.abs(w) <= moved) | ((x == 0) & (w >= -moved))).all() == solves


@pytest.mark.parametrize(
    ("A", "q", "x"),
    [
        ([[1e12]], [-1e8], [5e-3]),
        ([[1e14]], [-1e10], [0.5]),
        ([[1.0]], [-1e-11], [0.0]),
        ([[-1.0]], [-1e-11], [0.0]),
        ([[0.0]], [-1e-12], [0.0]),
        ([[1.0, 0.0], [0.0, -1.0]], [-1e10, -0.5], [1e10, 0.0]),
    ],
)
def test_no_absolute_allowance_is_left(A, q, x):
    problem = lcp.LCP(A, q)
    assert not lcp.certify(problem, np.array(x)).solves()
    solvable = lcp.solve_by_enumeration(problem).solvable
    assert lcp.solve(problem).outcome is (Outcome.SOLVED if solvable else Outcome.UNSOLVABLE)


def test_small_entries_are_zeros_only_where_that_is_asked():
    problem = lcp.MixedLCP(np.diag([0.0, 0.0, 1.0]), [3.0, -3.0, 0.0], [0.0, -np.inf, -np.inf], [np.inf, 2.0, np.inf])
    x = np.array([1e-14, 2.0 - 1e-14, 1e-14])
    assert not lcp.certify(problem, x).solves()
    certificate = lcp.certify(problem, x, zero=1e-10)
    assert certificate.solves()
    assert certificate.x.tolist() == [0.0, 2.0, 0.0]


@given(st.integers(0, 2**32 - 1), st.booleans())
@settings(deadline=None)
def test_rows_beyond_the_range_of_floats_are_as_exact_as_others(seed, sparse):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 5))
    A, q, x = (rng.standard_normal(s) * 10.0 ** rng.uniform(-290, 290, s) for s in ((n, n), n, n))
    terms = row_terms(lcp.LCP(sp.csr_array(A) if sparse else A, q), x)
    for i in range(n):
        products = [Fraction(a) * Fraction(b) for a, b in zip(A[i], x)] + [Fraction(q[i])]
        unit = Fraction(2) ** int(np.broadcast_to(terms.exponents, n)[i])
        size = sum(map(abs, products))
        assert abs(Fraction(terms.w[i]) * unit - sum(products)) <= size * Fraction(1, 2**52)
        assert abs(Fraction(terms.size[i]) * unit - size) <= size * Fraction(1, 2**50)


@pytest.mark.parametrize(
    ("A", "q"),
    [
        # Where x = 1e-400 would solve, x = 0 leaves w = q < 0.
        ([[1e-300]], [-1e300]),
        ([[1e300]], [-1e-300]),
        ([[8.5e255]], [-3.9e-112]),
        ([[2.0, 3.0], [1e-300, 0.0]], [-5e-324, 1e160]),
        ([[1.0, 0.0], [0.0, 1e250]], [-1.0, -1e-110]),
        ([[1e200, 1e-100], [0.0, 1.0]], [-1e-200, 1.0]),
        ([[0.0, 1e-20, -4.9e-324], [1e-20, 2.2e-308, -1e20], [-1e300, 0.0, 3.0]], [-3.0, 5e-324, 0.0]),
    ],
)
def test_solutions_that_no_float_holds_are_not_claimed(A, q):
    solution = solution_of(lcp.LCP(A, q), outcome=Outcome.NOT_FOUND)
    assert "no float holds it" in solution.message or "misses the tolerance, by 1.0e+00" in solution.message
    assert "Solved" not in solution.message.partition("Before x was rounded: ")[0]
    assert solution.relative_residual >= 1.0


@pytest.mark.parametrize("k", [93, 143, 193])
@pytest.mark.parametrize("factor", [1.0, 2.0**-100, 2.0**100])
def test_groups_of_faces_are_excluded_whatever_the_common_factor(k, factor):
    r = np.random.default_rng([77, k])
    A, q = campaign.KINDS["z_matrix"](int(r.integers(13, 25)), r)
    assert lcp.solve(lcp.LCP(factor * A, factor * q)).outcome is Outcome.UNSOLVABLE


def test_entries_too_far_apart_for_floats_are_decided_exactly():
    wild = 10.0 ** np.random.default_rng(6).uniform(-300, 300, (5, 4))
    small = lcp.LCP(wild[:4], -wild[4])
    assert not balanced(small).exact
    assert lcp.solve(small).exhaustion.solvable is lcp.solve_by_enumeration(small).solvable


@pytest.mark.parametrize("name", ["kkt", "wang", "yu", "xu", "zhao"])
@pytest.mark.parametrize("factor", [1e-300, 1e300])
def test_homotopies_by_name_survive_extreme_data(name, factor):
    A, q = np.array([[2.0, 1.0], [-1.0, 2.0]]), np.array([-1.0, -3.0])
    solution = solution_of(lcp.LCP(factor * A, factor * q), name)
    np.testing.assert_allclose(solution.x, [0.0, 1.5], atol=1e-12)


@pytest.mark.parametrize("n", [40, 301])
@pytest.mark.parametrize("sparse", [False, True])
def test_infeasible_to_precision_at_any_order(n, sparse):
    """A y = 0 only up to rounding, y > 0, and q'y = -1."""
    rng = np.random.default_rng(n)
    y, q = np.abs(rng.standard_normal(n)) + 0.1, rng.standard_normal(n)
    A = np.eye(n) - np.outer(y, y) / (y @ y)
    found = infeasibility(lcp.LCP(sp.csr_array(A) if sparse else A, q - y * (q @ y + 1.0) / (y @ y)))
    assert isinstance(found, FloatFarkas)
    np.testing.assert_allclose(found.y, y / y.max(), rtol=1e-9)
    assert found.error <= 1e-14
    assert found.gap > 0.0


def test_a_multiplier_that_refining_brings_to_zero_proves_nothing():
    # The rows are parallel but for 1e-13, and A'y <= 0 holds for y = 0 alone.
    A = [[0.8695569049613653, -0.27387754482537663], [-1.3411839088997872, 0.42242221760845866]]
    problem = lcp.LCP(A, [0.6254688951848555, -1.1137001036044356])
    assert infeasibility(problem) is None
    assert lcp.solve(problem).outcome in (Outcome.SOLVED, Outcome.NOT_FOUND)


def test_a_proof_moves_between_units():
    rng = np.random.default_rng(5)
    D, E = powers(rng, 6, 60), powers(rng, 6, 60)
    problem = lcp.LCP(D[:, None] * (np.eye(6) - 2.0 * np.roll(np.eye(6), 1, axis=1)) * E, -D)
    solution = lcp.solve(problem)
    assert "Farkas" in solution.proof
    assert solution.farkas.holds(problem)
    assert not solution.farkas.holds(lcp.LCP(problem.A, -problem.q))
