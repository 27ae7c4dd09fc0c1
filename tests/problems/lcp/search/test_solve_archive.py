"""The archive of `solve`: it holds every path, and changes nothing of what is done."""

import numpy as np
import pytest

from continuation.archive import open_archive
from problems import lcp

PD = lcp.LCP([[4.0, -1.0, 0.5], [1.0, 3.0, -1.0], [0.0, 1.0, 2.0]], [-1.0, 1.0, -2.0])


BIMATRIX = lcp.LCP([[0, 0, 1, 2], [0, 0, 3, 1], [1, 3, 0, 0], [2, 1, 0, 0]], [-1.0, -1.0, -1.0, -1.0])


# Feasible, without a solution, and too large for groups of faces to be tried: one block of two, and ones.
RESTARTED = lcp.LCP(
    np.block([[np.array([[0.0, 1.0], [0.0, 0.0]]), np.zeros((2, 59))], [np.zeros((59, 2)), np.eye(59)]]),
    np.append([-1.0, 1.0], -np.ones(59)),
)


@pytest.mark.parametrize("problem", [PD, BIMATRIX, RESTARTED], ids=["a path", "a game", "restarts"])
def test_an_archive_holds_every_path_and_changes_nothing_of_what_is_done(problem, tmp_path):
    without = lcp.solve(problem, restarts=3, path=True)
    with_archive = lcp.solve(problem, restarts=3, archive=tmp_path / "run.h5")
    assert with_archive.message == without.message
    assert with_archive.counts == without.counts
    assert with_archive.x is without.x is None or (with_archive.x == without.x).all()
    with open_archive(tmp_path / "run.h5") as archive:
        assert len(archive) == len(without.paths) > 0
        # Wang's path has 2n unknowns, the others 3n: the shorter one is filled up with NaN.
        ends = [path.u[[0, -1]] for path in archive]
    for kept, path in zip(ends, without.paths):
        np.testing.assert_array_equal(kept[:, -1], path.lam[[0, -1]])
        np.testing.assert_array_equal(kept[np.isfinite(kept)], path.u[[0, -1]].ravel())
