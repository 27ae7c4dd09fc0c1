"""Where the parameter of a path has a value."""

from __future__ import annotations

import numpy as np
import pytest

import continuation
from problems.bifurcation import Cusp, FreudensteinRoth


def test_all_crossings_of_a_path_with_folds():
    path = continuation.trace(FreudensteinRoth())
    inside = float(np.median([fold.lam for fold in path.turning_points]))
    found = path.crossings(inside)
    assert len(path.turning_points) == 2
    homotopy = FreudensteinRoth()
    assert all(u[-1] == inside for u in found)
    # Between accepted points the path is interpolated.
    assert max(np.abs(homotopy.residual(u[:-1], u[-1])).max() for u in found) <= 1e-2
    assert np.array_equal(path(t=inside), found[0])


def test_an_accepted_point_is_found_once():
    path = continuation.trace(Cusp())
    assert np.array_equal(path.crossings(path.steps[2].lam)[0], path.steps[2].u)
    assert len(path.crossings(path.steps[2].lam)) == 1


def test_both_or_neither_is_refused():
    path = continuation.trace(Cusp())
    for given in ({}, {"s": 0.0, "t": 0.0}):
        with pytest.raises(ValueError, match="s: expected an arclength, or t in its place"):
            path(**given)
