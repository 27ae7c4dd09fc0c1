"""Meshes that change along a path, files, and what is refused."""

import numpy as np
import pytest

import continuation
from continuation import Budget, TargetValue
from continuation.archive import open_archive
from problems.orbits import PeriodicOrbit, from_model


def test_orbits_of_lorenz_up_to_period_50():
    """Towards the homoclinic orbit at r = 13.926557407."""
    orbit = from_model("lorenz", intervals=40)
    end = TargetValue(50.0, component=orbit.period_index)
    followed = continuation.follow(orbit, start=orbit.leaving, events=[end], budget=Budget(steps=120))
    path = followed.path
    assert path.steps[0].lam == pytest.approx(470.0 / 19.0, abs=1e-3)
    assert path.steps[-1].lam == pytest.approx(13.926557407, abs=1e-6)
    periods = [step.observed["period"] for step in path.steps]
    assert periods == sorted(periods)
    assert periods[-1] == 50.0
    assert not {"period doubling", "torus"} & {event.name for event in path.events}
    assert followed.homotopy_of(path.steps[-1]) is followed.homotopies[-1]


def test_a_point_of_a_file_says_its_orbit(tmp_path):
    orbit = from_model("brusselator", intervals=8)
    file = tmp_path / "orbits.h5"
    followed = continuation.follow(orbit, every=3, start=orbit.leaving, budget=Budget(steps=7), archive=file)
    with open_archive(file) as archive:
        stored = [archive.path(k) for k in range(3)]
    for path, homotopy, kept in zip(followed.paths, followed.homotopies, stored, strict=True):
        last = kept.steps[-1]
        assert np.array_equal(last.u, path.steps[-1].u)
        again = PeriodicOrbit.from_point(orbit.f, last, 2, scale=homotopy.scale)
        assert np.array_equal(again.mesh, homotopy.mesh)
        assert np.array_equal(again.at(last.y, [0.1, 0.7]), homotopy.at(last.y, [0.1, 0.7]))
        assert np.abs(again.residual(last.y, last.lam)[:-8]).max() < 1e-7


def test_a_path_on_which_the_phase_condition_fails_says_so():
    orbit = from_model("lorenz")
    path = continuation.trace(orbit, start=orbit.leaving, budget=Budget(steps=60))
    assert path.events[-1].name == "phase condition fails"
    assert orbit.renewed_at == ("phase condition fails",)
