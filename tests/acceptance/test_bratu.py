"""Bratu's problem in one and two dimensions: the folds of the difference equations, at few factorisations."""

import pytest

from continuation import FAST, Status, TargetValue
from problems.bifurcation import Bratu1D, Bratu2D
from tests.truth import bratu

from ..util import every_preset, path_of


def upper_branch(homotopy, lam, **options):
    path = path_of(homotopy, events=[TargetValue(lam, direction=-1)], **options, status=Status.STOPPED_AT_EVENT)
    assert path.endpoint.lam == lam
    (fold,) = path.turning_points
    return path, fold


@every_preset
@pytest.mark.parametrize("n", bratu.FOLD_1D)
def test_the_fold_in_one_dimension(n, preset):
    _, fold = upper_branch(Bratu1D(n), 1.0, preset=preset)
    lam, height = bratu.FOLD_1D[n]
    assert fold.lam == pytest.approx(lam, abs=1e-12)
    assert fold.y.max() == pytest.approx(height, abs=3e-12)


@pytest.mark.parametrize("n", range(60, 140, 25))
def test_large_steps_pass_the_fold_on_every_mesh(n):
    """A factorisation from too far away tells nothing of the next crossing: FAST once stuck on two meshes of 16."""
    upper_branch(Bratu1D(n), 1.0, preset=FAST)


@pytest.mark.parametrize("m", [10, 20, 30, 50])
def test_the_fold_in_two_dimensions(m):
    _, fold = upper_branch(Bratu2D(m), 2.0)
    assert fold.lam == pytest.approx(bratu.FOLD_2D[m], abs=1e-11)
    assert m not in bratu.FOLD_MAX_2D or fold.y.max() == pytest.approx(bratu.FOLD_MAX_2D[m], abs=1e-11)


def test_the_number_of_steps_does_not_grow_with_the_grid():
    lengths = [len(upper_branch(Bratu1D(n), 1.0)[0]) for n in (50, 500, 5000)]
    assert max(lengths) <= 1.3 * min(lengths)
