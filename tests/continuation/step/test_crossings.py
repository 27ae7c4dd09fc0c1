"""Where the parameter of a path has a value."""

import numpy as np

import continuation
from problems.bifurcation import FreudensteinRoth


def test_all_crossings_of_a_path_with_folds():
    path, homotopy = continuation.trace(FreudensteinRoth()), FreudensteinRoth()
    inside = float(np.median([fold.lam for fold in path.turning_points]))
    found = path.crossings(inside)
    assert all(u[-1] == inside for u in found)
    # Between accepted points the path is interpolated.
    assert max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in found) <= 1e-2
    assert np.array_equal(path(t=inside), found[0])
