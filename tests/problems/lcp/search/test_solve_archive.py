"""The archive of `solve`: it holds every path, the answer where there is none, and changes nothing of what is done."""

import numpy as np
import pytest

import continuation
from continuation.archive import open_archive
from problems import lcp

PD = lcp.LCP([[4.0, -1.0, 0.5], [1.0, 3.0, -1.0], [0.0, 1.0, 2.0]], [-1.0, 1.0, -2.0])


BIMATRIX = lcp.LCP([[0, 0, 1, 2], [0, 0, 3, 1], [1, 3, 0, 0], [2, 1, 0, 0]], [-1.0, -1.0, -1.0, -1.0])


# Feasible, without a solution, and too large for groups of faces to be tried: one block of two, and ones.
RESTARTED = lcp.LCP(
    np.block([[np.array([[0.0, 1.0], [0.0, 0.0]]), np.zeros((2, 59))], [np.zeros((59, 2)), np.eye(59)]]),
    np.append([-1.0, 1.0], -np.ones(59)),
)


@pytest.mark.parametrize("problem", [PD, BIMATRIX, RESTARTED], ids=["no path", "a path", "restarts"])
def test_an_archive_changes_nothing_of_what_is_done(problem, tmp_path):
    without, with_archive = (lcp.solve(problem, restarts=3, archive=file) for file in (None, tmp_path / "run.h5"))
    assert with_archive.message == without.message
    assert with_archive.counts == without.counts
    np.testing.assert_array_equal(with_archive.x, without.x)
    with open_archive(tmp_path / "run.h5") as archive:
        assert len(archive) == max(len(without.paths), 1)
        # Wang's path has 2n unknowns, the others 3n: the shorter one is filled up with NaN.
        ends = [path.u[[0, -1]] for path in archive]
    for kept, path in zip(ends, without.paths):
        np.testing.assert_array_equal(kept[:, -1], path.lam[[0, -1]])
        np.testing.assert_array_equal(kept[np.isfinite(kept)], path.u[[0, -1]].ravel())


def test_an_archive_without_a_path_holds_the_solution_as_the_end_of_the_kkt_path(tmp_path):
    solution = lcp.solve(PD, archive=tmp_path / "run.h5")
    with open_archive(tmp_path / "run.h5") as archive:
        (path,) = archive
        assert archive.attributes["homotopy"] == "problems.lcp.homotopies.kkt:KKTHomotopy"
    assert path.status is continuation.Status.REACHED_TARGET
    assert solution.message in path.message
    assert len(path) == 1
    np.testing.assert_array_equal(path.endpoint.u, [*solution.x, *solution.w, *solution.x, 0.0])
    assert np.abs(lcp.KKTHomotopy(PD).residual(path.endpoint.y, 0.0)).max() <= 1e-15


def test_the_archive_of_a_problem_beyond_floats_holds_the_answer(tmp_path):
    file = tmp_path / "run.h5"
    problem = lcp.LCP([[1e-300, 1e300], [1e300, 1e-300]], [-1.0, 1.0])
    solution = lcp.solve(problem, archive=file)
    assert "too far apart for floats" in solution.message
    with open_archive(file) as archive:
        np.testing.assert_array_equal(archive.path(0).endpoint.y[:2], solution.x)


def test_an_archive_without_a_point_holds_the_reason(tmp_path):
    file = tmp_path / "run.h5"
    solution = lcp.solve(lcp.LCP([[0.0, 1.0], [-1.0, 0.0]], [-1.0, -1.0]), archive=file)
    assert solution.outcome is lcp.Outcome.UNSOLVABLE
    with open_archive(file) as archive:
        assert len(archive) == 1
        assert archive.paths["n_points"][0] == 0
        assert solution.message[:60] in archive.path(0).message
