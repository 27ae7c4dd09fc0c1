"""Rows with two sides: one multiplier of each is in what is factored."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import linprog

from continuation.testing import check_homotopy
from problems import lcp
from problems.lcp.homotopies.registry import HOMOTOPIES

BOUNDED = [name for name, one in HOMOTOPIES.items() if one.bounds]
INF = np.inf
NARROW = lcp.MixedLCP(
    [[2.0, 1.0, 0.0, 0.0], [-1.0, 1.0, 0.5, 0.0], [0.0, -0.5, 3.0, 1.0], [0.0, 0.0, -1.0, 0.0]], [-1.0, 2.0, -6.0, 0.5],
    [0.0, -INF, -1e-3, 0.0], [INF, 1.0, 1e-3, 1e-3],
)  # fmt: skip
"""Boxes so narrow that forces and distances are larger."""
KINDS = pytest.mark.parametrize("sparse", [False, True])


def random_program(rng, n, m, sparse=False, rank=None, width=0.5):
    """A convex program with m rows of two sides, every third of one side alone, half of the variables in boxes."""
    M = rng.standard_normal((rank or n, n))
    P, G = M.T @ M / n, rng.standard_normal((m, n))
    P, middle = (P + P.T) / 2, G @ rng.standard_normal(n)
    low, high = middle - width * rng.random(m), middle + width * rng.random(m)
    high[::3] = np.inf
    lower, upper = np.where(rng.random(n) < 0.5, -3.0, -np.inf), np.where(rng.random(n) < 0.5, 3.0, np.inf)
    if sparse:
        P, G = sp.csr_array(P), sp.csr_array(G)
    return lcp.from_qp(P, rng.standard_normal(n), G, high, rows_lower=low, lower=lower, upper=upper)


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
def test_solves_and_signs_agree_with_the_full_system(name, sparse):
    """Forces of an activity far larger and far smaller than its distances, and none at all."""
    rng, worst = np.random.default_rng(6), 0.0
    for k in range(30):
        program = random_program(rng, int(rng.integers(1, 6)), int(rng.integers(2, 5)), sparse)
        problem = program.problem if k % 3 else NARROW
        homotopy = HOMOTOPIES[name].make(problem, None)
        y, _ = homotopy.start()
        y[problem.n :] *= np.exp(5.0 * rng.standard_normal(y.size - problem.n)) if k % 5 else 0.0
        lam, border = (0.0, 1.0, 1e-3, rng.random())[k % 4], rng.standard_normal(y.size + 1)
        H_y, H_lam = homotopy.jacobian(y, lam)
        whole = np.vstack([np.column_stack([H_y.toarray() if sp.issparse(H_y) else H_y, H_lam]), border])
        if np.linalg.cond(whole) > 1e14:
            continue
        system, r = homotopy.bordered(y, lam, border), rng.standard_normal(y.size)
        wanted = np.linalg.solve(whole, np.append(r, 0.5))
        off = np.abs(system.solve(r, 0.5) - wanted).max() / np.abs(wanted).max()
        worst = max(worst, off / np.linalg.cond(whole))
        assert system.sign == np.linalg.slogdet(whole)[0]
    assert worst < 1e-14


def test_every_check_of_a_plug_in_passes_with_a_row_of_two_sides():
    problem = lcp.from_qp(np.diag([2.0, 1.0]), [-3.0, 1.0], [[1.0, 2.0]], [1.0], rows_lower=-1, lower=0).problem
    check_homotopy(HOMOTOPIES["wang"].make(problem, None))
