"""Paths under strain: close folds, near-singular and badly scaled matrices, weights, degenerate and double ends.

The rule asserted throughout: an end that is claimed is right, and where it cannot be reached the status says so.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from continuation import Status, trace
from problems.lcp import LCP, KKTHomotopy, Outcome, WangHomotopy, certify, solve
from problems.lcp.strategies import badly_scaled_lcps, near_singular_lcps, planted_lcps
from problems.paper import COUNTEREXAMPLES

from ...util import for_interior_paths, path_of, share
from .util import x_at_end

MERGE = 3.9121535
"""Where the two turning points of the family below merge, from their distance at eight values of a beyond."""


def folding(a):
    """A row sufficient matrix, a start from which lambda turns twice for a > MERGE, and not at all for a < MERGE."""
    return KKTHomotopy(LCP([[0, -a], [1, 0]], [5, 2]), [2.0, 1.0])


@for_interior_paths
@pytest.mark.parametrize("a", [4.5, MERGE + 4e-3, MERGE + 1e-3])
def test_two_close_turning_points_are_found_and_are_folds(preset, a):
    """H_y is singular at each, the path between them runs backwards, and all presets agree to nine digits."""
    homotopy = folding(a)
    path = trace(homotopy, preset=preset)
    assert path.turning_points[0].lam < path.turning_points[1].lam
    for turn, reference in zip(path.turning_points, trace(homotopy).turning_points, strict=True):
        values = np.linalg.svd(homotopy.jacobian(turn.y, turn.lam)[0], compute_uv=False)
        assert values[-1] < 1e-9 * values[-2]
        np.testing.assert_allclose(turn.u, reference.u, rtol=0, atol=1e-7)
        assert turn.lam == pytest.approx(reference.lam, abs=1e-9)
    np.testing.assert_allclose(path.endpoint.y[:2], 0.0, atol=1e-8)


@for_interior_paths
@pytest.mark.parametrize("d", [-1e-2, -1e-3, -1e-6, 1e-6, 1e-4])
def test_close_to_the_merger_none_or_both_are_found_and_the_end_is_the_same(preset, d):
    """A pair inside one step may be missed, never one of the two: the orientation goes on as it was."""
    path = path_of(folding(MERGE + d), preset=preset)
    assert len(path.turning_points) in ((0,) if d < -1e-4 else (0, 2))
    assert {step.orientation for step in path.steps[1:]} == {-1}
    np.testing.assert_allclose(path.endpoint.y[:2], 0.0, atol=1e-8)


@share(60)
@given(near_singular_lcps())
def test_near_singular_matrices_stop_near_the_end_if_at_all(pair):
    """A power of two from singular: the path arrives, or stops where a singular end begins, and says that it did."""
    problem, x0 = pair
    path = trace(KKTHomotopy(problem, x0))
    if path.status is not Status.REACHED_TARGET:
        assert path.status is Status.STEP_TOO_SMALL
        assert "singular point" in path.message
        assert path.endpoint.lam < 1e-4
    assert np.isfinite(path.y).all()


@share(40)
@given(badly_scaled_lcps("P"))
def test_badly_scaled_problems_are_solved(pair):
    """Units between 2^-26 and 2^26, ratios beyond 1e15: the certificate's residual, in the units of q."""
    problem, _ = pair
    solution = solve(problem)
    assert solution.outcome is Outcome.SOLVED
    assert solution.certificate.solves(1e-10)


FACES = {
    "integers to 18": ([[0, -6, -18], [4, 0, -12], [6, 6, 0]], [61, 18, -34], [2.0, 4.0, 2.0]),
    "integers to 27": ([[0, -3, -27], [2, 0, -18], [3, 3, 0]], [67, 36, -13], [1.0, 4.0, 2.0]),
}


@for_interior_paths
@pytest.mark.parametrize(("A", "q", "x0"), FACES.values(), ids=FACES)
def test_an_end_inside_a_face_of_solutions(A, q, x0, preset):
    """Row sufficient, A singular, all w = 0 on a segment: near its inside the condition of H' is about 1/lambda^2.

    Below lambda = 1e-4 Newton's method has no more digits to give than the tolerance asks for, or fewer; the limit has
    them all, by way of samples at larger values. `end_error` holds: presets, which sample elsewhere, differ by less.
    """
    problem = LCP(A, q)
    path = path_of(KKTHomotopy(problem, x0), preset=preset)
    assert certify(problem, x_at_end(problem, path), 1e-8).solves(1e-8)
    assert path.endpoint.residual_norm < 1e-12
    assert 0.0 < path.end_error < 1e-8
    reference = trace(KKTHomotopy(problem, x0))
    apart = np.abs(path.endpoint.y - reference.endpoint.y).max()
    assert apart <= path.end_error + reference.end_error


@share(25)
@given(planted_lcps("degenerate", "P", st.integers(1, 3)))
def test_degenerate_vertices_of_p_matrices(pair):
    """Some x_i = w_i = 0, which only the half power reaches: the solution to ten digits, from an infeasible start."""
    problem, x = pair
    path = path_of(KKTHomotopy(problem))
    assert path.winding_number == 2
    np.testing.assert_allclose(x_at_end(problem, path), x, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("q", [1e-6, 1e-8, 1e-12, 0.0])
def test_two_solutions_within_the_tolerance(q):
    """Nearer than the tolerance, and where they are one, the path ends in the gap; `solve` finds a solution exactly."""
    problem = LCP([[-1]], [q])
    end = trace(KKTHomotopy(problem, [1.0])).endpoint
    assert end.lam == 0.0
    assert -1e-12 <= end.y[0] <= q + 1e-12
    assert solve(problem).residual <= 1e-12


@pytest.mark.parametrize("case", COUNTEREXAMPLES, ids=lambda c: c.matrix_class)
def test_the_path_of_wang_runs_off_where_there_is_nothing_to_find(case):
    path = path_of(WangHomotopy(case.problem), status=Status.DIVERGED)
    assert "runs off to infinity" in path.message
    assert path.endpoint.lam > 1e-3
    assert np.abs(path.endpoint.y).max() > 1e3
