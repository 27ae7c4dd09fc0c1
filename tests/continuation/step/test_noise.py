"""Residuals with noise: its level is measured at the start and where steps fail; the folds of the path are found."""

import numpy as np
import pytest

from continuation import CONSERVATIVE, DEFAULT, FAST, SERIES, Status, from_functions, trace
from continuation.archive import resume
from continuation.budget import Budget

from ...util import by_preset, every_preset, path_of


def cubic(noise):
    """The path lam = t^3 - 3 t, with folds at lam = 2 and -2, in three unknowns, and `noise` of (t, lam)."""

    def residual(y, lam):
        t, lam = float(y[0]), float(lam)
        exact = np.array([t**3 - 3.0 * t - lam, float(y[1]) - t * t, float(y[2]) - np.sin(t) * float(y[1])])
        return exact + noise(t, lam)

    t = -2.5
    return from_functions(residual, start=([t, t * t, np.sin(t) * t * t], t**3 - 3.0 * t), target=8.125)


def drawn(level):
    generator = np.random.default_rng(0)
    return cubic(lambda t, lam: level(t) * generator.uniform(-1.0, 1.0, 3))


def growing(t):
    return 10.0 ** (-14.0 + 8.0 * min(max((t + 2.5) / 4.0, 0.0), 1.0))


@by_preset(FAST, DEFAULT, CONSERVATIVE, SERIES)
@pytest.mark.parametrize("level", [1e-10, 1e-8, 1e-6])
def test_both_folds_are_found_in_at_most_twice_the_steps(preset, level):
    clean, path = trace(drawn(lambda t: 0.0), preset=preset), trace(drawn(lambda t: level), preset=preset)
    assert path.status is Status.REACHED_TARGET
    assert [point.lam for point in path.turning_points] == pytest.approx([2.0, -2.0], abs=level**0.5)
    assert len(path) <= 2 * len(clean) + 10


@every_preset
def test_noise_that_grows_along_the_path_is_noticed_and_said(preset):
    path = path_of(drawn(growing), preset=preset)
    assert [point.lam for point in path.turning_points] == pytest.approx([2.0, -2.0], abs=1e-3)
    assert "The residual is noisy: the tolerance was raised to" in path.message
    assert len(path) < 150  # it took 1,300 steps, and found one fold


def test_noise_that_a_start_at_zero_does_not_show_is_measured_ahead_of_it():
    """The domain ends behind the start: noise that is looked for there takes 18 points, and not 7."""

    def residual(y, lam):
        y, lam = float(y[0]), float(lam)
        return np.array([y - lam + 1e-6 * lam * np.sin(1e11 * (y + lam)) if lam >= -1e-4 else np.nan])

    path = path_of(from_functions(residual, start=([0.0], 0.0), target=1.0))
    assert "The residual is noisy" in path.message
    assert len(path) <= 12


@pytest.mark.parametrize("level", [growing, lambda t: 1e-7, lambda t: 1e-8 * (t > -1.5)], ids=["grows", "is", "begins"])
@pytest.mark.parametrize("steps", [2, 8])
def test_a_trace_that_is_resumed_knows_the_noise_and_the_steps_of_differences(tmp_path, level, steps):
    """The same noise at the same point: the points that follow are those of the trace that was not cut, bit for bit."""
    homotopy = cubic(lambda t, lam: level(t) * np.sin(1e11 * (np.array([1.0, 2.0, 3.0]) * t + lam)))
    whole = path_of(homotopy)
    trace(homotopy, archive=tmp_path / "part.h5", budget=Budget(steps=steps))
    again = resume(tmp_path / "part.h5", homotopy, budget=Budget())
    np.testing.assert_array_equal(again.u, whole.u)
    assert again.message == whole.message


@pytest.mark.parametrize(("unit", "origin"), [(1e6, 3e9), (1e8, 1e12)])
def test_a_slow_unknown_in_a_unit_that_makes_it_the_largest_does_not_blur_the_others(unit, origin):
    """The third unknown moves by a millionth and is known to eleven digits: held still, all others would have five.

    Scales of the others were twelve and thirty times too large.
    """

    def path(unit, origin):
        def residual(y, lam):
            x, z, slow = y[0], y[1], (y[2] - origin) / unit
            return np.stack([x - 12 * lam - z * z, z - 0.002 * x * x - 0.01 * x, slow - 1e-6 * x - 1e-3 * z])

        return trace(from_functions(residual, start=([0.0, 0.0, origin], 0.0), target=1.0))

    own, other = path(1.0, 0.0), path(unit, origin)
    assert own.status is other.status is Status.REACHED_TARGET
    assert other.counts.rejected <= own.counts.rejected + 1
    ratio = np.sqrt(own.steps[1].weights / other.steps[1].weights)[[0, 1, 3]]
    assert ratio.min() > 0.5
    assert ratio.max() < 2.0
