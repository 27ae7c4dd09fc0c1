"""Kinks in archives: their switches and rays come back, and windows of rows do not tear them apart."""

import numpy as np
import pytest

from continuation import trace
from problems.nonlinear import bratu_under_obstacle

from .util import assert_same, read


@pytest.mark.parametrize("rows_at_once", [None, 3])
def test_switches_and_rays_come_back(tmp_path, monkeypatch, rows_at_once):
    path = trace(bratu_under_obstacle(9, 2.0, target=6.0), archive=tmp_path / "run.h5")
    assert {len(event.switches) for event in path.kinks} == {1, 2}
    if rows_at_once:
        monkeypatch.setattr("continuation.archive.reader.ROWS_AT_ONCE", rows_at_once)
    for keep in ("all", "ends"):
        found = read(tmp_path / "run.h5", keep=keep)
        assert_same(found, path)
        for event, told in zip(found.kinks, path.kinks, strict=True):
            assert (event.switches, event.ends_step) == (told.switches, told.ends_step)
            assert np.array_equal(event.rays, told.rays)
            # The curve leaves a kink along its second ray.
            leaves = found.steps[told.step + 1].segment.derivative(0.0)
            unit, ray = (v / np.linalg.norm(v) for v in (leaves, told.rays[1]))
            np.testing.assert_allclose(unit, ray, atol=1e-12)
