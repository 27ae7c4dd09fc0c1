"""Rows with two sides: one multiplier of each is in what is factored."""

import numpy as np
import pytest
import scipy.sparse as sp
from attrs import evolve
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.optimize import linprog

from problems import lcp
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.mixed_strategies import programs

from ...util import BOUNDED

INF = np.inf
NARROW = lcp.MixedLCP(
    [[2.0, 1.0, 0.0, 0.0], [-1.0, 1.0, 0.5, 0.0], [0.0, -0.5, 3.0, 1.0], [0.0, 0.0, -1.0, 0.0]], [-1.0, 2.0, -6.0, 0.5],
    [0.0, -INF, -1e-3, 0.0], [INF, 1.0, 1e-3, 1e-3],
)  # fmt: skip
"""Boxes so narrow that forces and distances are larger."""
KINDS = pytest.mark.parametrize("sparse", [False, True])


@KINDS
def test_linear_programs_with_rows_of_two_sides_beside_highs(sparse):
    rng = np.random.default_rng(5)
    for _ in range(15):
        n, m = int(rng.integers(2, 12)), int(rng.integers(1, 12))
        G, c = rng.integers(-3, 4, (m, n)).astype(float), rng.integers(-4, 5, n).astype(float)
        middle = G @ rng.integers(-2, 3, n)
        low, high = middle - rng.integers(0, 3, m), middle + rng.integers(1, 3, m)
        solution = lcp.solve(lcp.from_lp(c, sp.csr_array(G) if sparse else G, high, lower=-5, upper=5, rows_lower=low))
        wanted = linprog(c, np.vstack([G, -G]), np.append(high, -low), bounds=(-5, 5))
        assert solution.success
        assert solution.objective == pytest.approx(wanted.fun, rel=1e-9, abs=1e-9)


@KINDS
@pytest.mark.parametrize("name", BOUNDED)
@given(st.one_of(st.just(NARROW), programs().map(lambda program: program.problem)), st.integers(0, 2**32 - 1))
def test_solves_and_signs_agree_with_the_full_system(name, sparse, problem, seed):
    """Forces of an activity far larger and far smaller than its distances, and none at all."""
    rng = np.random.default_rng(seed)
    given_problem = evolve(problem, A=sp.csr_array(problem.A)) if sparse else problem
    homotopy = HOMOTOPIES[name].make(given_problem, None)
    y, _ = homotopy.start()
    y[problem.n :] *= np.exp(5.0 * rng.standard_normal(y.size - problem.n)) if seed % 5 else 0.0
    lam, border = (0.0, 1.0, 1e-3, rng.random())[seed % 4], rng.standard_normal(y.size + 1)
    H_y, H_lam = homotopy.jacobian(y, lam)
    whole = np.vstack([np.column_stack([H_y.toarray() if sp.issparse(H_y) else H_y, H_lam]), border])
    condition = np.linalg.cond(whole)
    assume(condition <= 1e14)
    system, r = homotopy.bordered(y, lam, border), rng.standard_normal(y.size)
    wanted = np.linalg.solve(whole, np.append(r, 0.5))
    assert np.abs(system.solve(r, 0.5) - wanted).max() < 1e-14 * condition * np.abs(wanted).max()
    assert system.sign == np.linalg.slogdet(whole)[0]
