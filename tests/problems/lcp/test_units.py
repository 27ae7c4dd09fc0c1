"""Units must not matter: scaling, certificates and outcomes are the same for LCP(q, A) and LCP(D q, D A E)."""

import warnings
from fractions import Fraction

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from problems import lcp
from problems.lcp.data.scaling import balanced, units
from problems.lcp.proof import off
from problems.lcp.proof.compensated import row_terms
from problems.lcp.proof.farkas import FloatFarkas, infeasibility
from problems.lcp.reference.enumeration import exhaust

from ...util import benchmark
from .util import powers

Outcome = lcp.Outcome
campaign = benchmark("claims.py")


@pytest.mark.parametrize(("mode", "number"), [("units", 60), ("factor", 20), ("truth", 60), ("bounds", 60)])
def test_the_benchmark_of_units_finds_nothing_wrong(capsys, mode, number):
    assert campaign.CAMPAIGN.run(number, 3, [mode]) == 0, capsys.readouterr().out


def test_the_benchmark_can_fail(monkeypatch):
    monkeypatch.setattr(campaign, "same_outcome", lambda one, other, exact: False)
    assert campaign.CAMPAIGN.run(3, 0, ["units"]) == 3


@pytest.mark.parametrize("power", [-990, -40, 3, 900])
def test_a_common_factor_changes_no_digit_where_active_sets_come_before_units(power):
    """Of games with several solutions another one was found, where the factor made the entries not about 1."""
    for seed in range(12):
        A, q = campaign.game(13 + seed, np.random.default_rng(seed))
        one, other = lcp.solve(lcp.LCP(A, q)), lcp.solve(lcp.LCP(np.ldexp(A, power), np.ldexp(q, power)))
        assert one.outcome is other.outcome
        assert one.x.tobytes() == other.x.tobytes()
        assert one.message == other.message


@given(st.integers(0, 2**32 - 1), st.booleans(), st.booleans())
@settings(deadline=None)
def test_units_that_are_powers_of_two_come_out_again_exactly(seed, sparse, stored_sparse):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 12))
    A, q = rng.standard_normal((n, n)), rng.standard_normal(n)
    A = A * (rng.random((n, n)) < 0.4) if sparse else A
    D, E = powers(rng, n, 40), powers(rng, n, 40)
    kind = sp.csr_array if stored_sparse else np.asarray
    one, other = lcp.LCP(kind(A), q), lcp.LCP(kind(D[:, None] * A * E), D * q)
    (rows, columns), (r, c) = units(one), units(other)
    # Only a part whose q is zero, and so x = 0, has no unit of its own.
    scaled, again = np.ldexp(A, rows[:, None] + columns), np.ldexp(D[:, None] * A * E, r[:, None] + c)
    np.testing.assert_array_equal(scaled, again)
    np.testing.assert_array_equal(np.ldexp(q, rows), np.ldexp(D * q, r))


def test_scaling_brings_rows_and_columns_to_about_one_and_is_undone():
    rng = np.random.default_rng(0)
    n = 30
    A = 10.0 ** rng.uniform(-8, 8, n)[:, None] * rng.standard_normal((n, n)) * 10.0 ** rng.uniform(-8, 8, n)
    problem = lcp.LCP(A, rng.standard_normal(n) * 1e7)
    scaled = balanced(problem)
    entries = np.abs(scaled.problem.A)
    for largest in (entries.max(axis=0), entries.max(axis=1)):
        assert 0.2 < largest.min() <= largest.max() < 3.0
    assert 0.5 <= np.abs(scaled.problem.q).max() < 2.0
    u = rng.random(n)
    np.testing.assert_array_equal(scaled.u(scaled.x(u)), u)
    np.testing.assert_array_equal(np.ldexp(problem.w(scaled.x(u)), scaled.rows), scaled.problem.w(u))
    assert scaled.exact


@pytest.mark.parametrize("sparse", [False, True])
def test_what_is_symmetric_up_to_units_becomes_symmetric(sparse):
    rng = np.random.default_rng(1)
    n = 9
    M = rng.standard_normal((n, n))
    A = (M + M.T) * powers(rng, n, 30)[:, None] * powers(rng, n, 30)
    scaled = balanced(lcp.LCP(sp.csr_array(A) if sparse else A, rng.standard_normal(n)))
    B = scaled.problem.A.toarray() if sparse else scaled.problem.A
    np.testing.assert_array_equal(B, B.T)


def test_tiny_entries_of_a_kernel_say_nothing_about_units():
    x = np.linspace(-20.0, 20.0, 60)
    kernel = np.exp(-((x[:, None] - x) ** 2))
    assert kernel[kernel > 0].min() < 1e-290
    rows, columns = units(lcp.LCP(kernel, np.where(x > 0, 1.0, -1.0)))
    assert np.unique(rows).size == np.unique(columns).size == 1


def test_a_game_of_unconnected_parts_and_a_diagonal_matrix_take_their_units_from_q():
    scaled = balanced(lcp.LCP(np.diag([1e5, 1e-5]), [-1e-9, 1e9])).problem
    for values in (scaled.A.diagonal(), np.abs(scaled.q)):
        assert 0.4 < values.min() <= values.max() < 2.5


@given(st.integers(0, 2**32 - 1))
@settings(deadline=None)
def test_the_verdict_of_a_certificate_knows_no_units(seed):
    """The relative residual of any x, negative entries and violated rows included, to the last digit."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 7))
    A, q = rng.integers(-2, 3, (n, n)).astype(float), rng.integers(-2, 3, n).astype(float)
    x = rng.integers(-1, 3, n) * 10.0 ** rng.uniform(-12, 2, n)
    D, E = powers(rng, n, 300), powers(rng, n, 300)
    one, other = lcp.certify(lcp.LCP(A, q), x), lcp.certify(lcp.LCP(D[:, None] * A * E, D * q), x / E)
    assert one.relative_residual == other.relative_residual
    assert one.drowned == other.drowned
    assert one.solves() is other.solves()


def test_the_relative_residual_is_a_backward_error():
    """x solves the problem whose entries are changed by that much relatively, and none whose are changed by less."""
    rng = np.random.default_rng(2)
    A, q = rng.standard_normal((6, 6)), rng.standard_normal(6)
    x = np.array([0.7, 0.0, 1.3, 0.0, 0.2, 0.0])
    q = np.where(x > 0, -A @ x, 1.0) + 1e-3 * rng.standard_normal(6) * (x > 0)
    problem = lcp.LCP(A, q)
    certificate = lcp.certify(problem, x)
    eps = certificate.relative_residual
    assert 1e-5 < eps < 1e-2
    w, size = certificate.w, np.abs(A) @ x + np.abs(q)
    for share, solves in ((1.001 * eps, True), (0.999 * eps, False)):
        # The extreme changes of all entries of a row move w_i by share * size_i, either way.
        possible = (np.abs(w) <= share * size) | ((x == 0) & (w >= -share * size))
        assert possible.all() == solves


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
    problem = lcp.LCP([[0.0]], [3.0])
    assert not lcp.certify(problem, np.array([1e-14])).solves()
    certificate = lcp.certify(problem, np.array([1e-14]), zero=1e-10)
    assert certificate.solves()
    assert certificate.x[0] == 0.0


@given(st.integers(0, 2**32 - 1), st.booleans())
@settings(deadline=None)
def test_rows_beyond_the_range_of_floats_are_as_exact_as_others(seed, sparse):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 5))
    A, q, x = (rng.standard_normal(s) * 10.0 ** rng.uniform(-290, 290, s) for s in ((n, n), n, n))
    terms = row_terms(lcp.LCP(sp.csr_array(A) if sparse else A, q), x)
    for i in range(n):
        products = [Fraction(a) * Fraction(b) for a, b in zip(A[i], x)] + [Fraction(q[i])]
        unit = Fraction(2) ** int(terms.exponents[i])
        size = sum(map(abs, products))
        assert abs(Fraction(terms.w[i]) * unit - sum(products)) <= size * Fraction(1, 2**52)
        assert abs(Fraction(terms.size[i]) * unit - size) <= size * Fraction(1, 2**50)


def test_solutions_that_no_float_holds_are_not_claimed():
    # Where x = 1e-400 would solve, x = 0 leaves w = q < 0.
    for A, q in (
        ([[1e-300]], [-1e300]),
        ([[1e300]], [-1e-300]),
        ([[8.5e255]], [-3.9e-112]),
        ([[2.0, 3.0], [1e-300, 0.0]], [-5e-324, 1e160]),
        ([[1.0, 0.0], [0.0, 1e250]], [-1.0, -1e-110]),
        ([[1e200, 1e-100], [0.0, 1.0]], [-1e-200, 1.0]),
        ([[0.0, 1e-20, -4.9e-324], [1e-20, 2.2e-308, -1e20], [-1e300, 0.0, 3.0]], [-3.0, 5e-324, 0.0]),
    ):
        solution = lcp.solve(lcp.LCP(A, q))
        assert solution.outcome is Outcome.NOT_FOUND
        assert "no float holds it" in solution.message or "misses the tolerance" in solution.message
        assert solution.relative_residual >= 1.0


def test_entries_too_far_apart_for_floats_are_decided_exactly_or_judged_as_given():
    wild = 10.0 ** np.random.default_rng(6).uniform(-300, 300, (5, 4))
    small = lcp.LCP(wild[:4], -wild[4])
    assert not balanced(small).exact
    solution = lcp.solve(small)
    assert solution.exhaustion is not None
    assert solution.exhaustion.solvable is lcp.solve_by_enumeration(small).solvable
    n = 16
    A, q = np.eye(n), -np.ones(n)
    A[:4, :4], q[:4] = small.A, small.q
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        large = lcp.solve(lcp.LCP(A, q), restarts=2)
    assert not large.solved or large.certificate.solves()


@pytest.mark.parametrize("name", ["kkt", "wang", "yu", "xu", "zhao"])
@pytest.mark.parametrize("factor", [1e-300, 1e300])
def test_homotopies_by_name_survive_extreme_data(name, factor):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        A, q = np.array([[2.0, 1.0], [-1.0, 2.0]]), np.array([-1.0, -3.0])
        solution = lcp.solve(lcp.LCP(factor * A, factor * q), name)
    assert solution.outcome is Outcome.SOLVED
    np.testing.assert_allclose(solution.x, [0.0, 1.5], atol=1e-12)


def test_exhaustion_agrees_with_enumeration_and_can_be_cut_off():
    rng = np.random.default_rng(4)
    for _ in range(40):
        n = int(rng.integers(1, 5))
        problem = lcp.LCP(rng.integers(-2, 3, (n, n)), rng.integers(-2, 3, n))
        decided = exhaust(problem)
        assert decided.solvable is lcp.solve_by_enumeration(problem).solvable
        if decided.x is not None:
            x = np.array(decided.x, dtype=object)
            w = problem.A.astype(int).astype(object) @ x + problem.q.astype(int)
            assert min(*x, *w) >= 0
            assert all(a * b == 0 for a, b in zip(x, w))
    with pytest.raises(ValueError, match=r"^problem: expected n <= "):
        exhaust(lcp.LCP(np.eye(15), -np.ones(15)))


@pytest.mark.parametrize("n", [40, 301])
@pytest.mark.parametrize("sparse", [False, True])
def test_infeasible_to_precision_at_any_order(n, sparse):
    """A y = 0 only up to rounding, y > 0, and q'y = -1."""
    rng = np.random.default_rng(n)
    y = np.abs(rng.standard_normal(n)) + 0.1
    A = np.eye(n) - np.outer(y, y) / (y @ y)
    q = rng.standard_normal(n)
    q -= y * (q @ y + 1.0) / (y @ y)
    problem = lcp.LCP(sp.csr_array(A) if sparse else A, q)
    found = infeasibility(problem)
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
    A, q = -np.abs(rng.standard_normal((6, 6))), -np.ones(6)
    D, E = powers(rng, 6, 60), powers(rng, 6, 60)
    problem = lcp.LCP(D[:, None] * A * E, D * q)
    solution = lcp.solve(problem)
    assert solution.outcome is Outcome.UNSOLVABLE
    assert solution.farkas.holds(problem)
    assert "Farkas" in solution.proof
    assert not solution.farkas.holds(lcp.LCP(problem.A, -problem.q))


def test_units_are_asked_for_only_where_they_may_matter(monkeypatch):
    """A row with q_i = 0, as those of friction, off by round-off: clear where the entries are alike."""
    A, q, x = np.array([[1.0, -3.0], [0.0, 1.0]]), np.array([0.0, -0.1]), np.array([0.3, 0.1])
    asked = []
    monkeypatch.setattr(off, "units", lambda problem: asked.append(problem) or units(problem))
    assert lcp.certify(lcp.LCP(A, q), x).drowned == 0.0
    assert not asked
    # In units a million apart, and at a point that is off by more, they are.
    assert lcp.certify(lcp.LCP(A * [[1e6], [1.0]], q), x).drowned == 0.0
    assert 1e-3 < lcp.certify(lcp.LCP(A, q), np.array([0.301, 0.1])).drowned < 1e-2
    assert len(asked) == 2
