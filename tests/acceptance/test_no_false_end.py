"""No false end: what round-off, noise and small numbers make of a path is neither an end nor a refusal.

The campaign is `examples/benchmarks/ends.py`; a few paths of each family are traced here.
"""

import numpy as np
import pytest
from mpmath import mp, mpf

import continuation
from continuation import CONSERVATIVE, DEFAULT, FAST, SERIES, Budget, Status, from_functions, trace
from continuation.metric import Euclidean
from continuation.step.tracer import Tracer

from ..util import benchmark

families = benchmark("ends.py")
PRESETS = (FAST, DEFAULT, CONSERVATIVE, SERIES)
without_series = pytest.mark.parametrize("preset", PRESETS[:3], ids=[preset.name for preset in PRESETS[:3]])
every_preset = pytest.mark.parametrize("preset", PRESETS, ids=[preset.name for preset in PRESETS])


@every_preset
@pytest.mark.parametrize("family", families.FAMILIES)
def test_families_in_random_units(family, preset):
    for seed in range(3):
        generator = np.random.default_rng([seed, 45])
        case = families.FAMILIES[family](generator)
        path = trace(case.homotopy(*10.0 ** generator.uniform(-4.0, 4.0, 3)), preset=preset, budget=Budget(steps=2000))
        assert path.status in case.ends
        assert len(path.turning_points) == case.folds


@pytest.mark.parametrize(
    ("family", "seed"),
    [("zero by symmetry", [k, 77]) for k in (36, 48, 51, 95)] + [("trusses", [1, k, 7]) for k in (3, 4, 8)],
)
@pytest.mark.parametrize("preset", [FAST, CONSERVATIVE], ids=lambda preset: preset.name)
def test_noise_that_vanishes_at_the_start_or_looks_smooth_on_a_grid(family, seed, preset):
    """Each of these ended as STEP_TOO_SMALL: scales were those of round-off."""
    generator = np.random.default_rng(seed)
    case = families.FAMILIES[family](generator)
    path = trace(case.homotopy(*10.0 ** generator.uniform(-4.0, 4.0, 3)), preset=preset, budget=Budget(steps=2000))
    assert path.status is Status.REACHED_TARGET
    assert list(path.events) == []


@every_preset
@pytest.mark.parametrize("eps", [1e-8, 1e-10, 1e-12, 1e-14])
def test_an_imperfect_pitchfork_is_no_pole(preset, eps):
    residual = lambda y, lam: np.stack([lam * y[0] - y[0] ** 3 + eps])  # noqa: E731
    path = trace(from_functions(residual, start=([eps], -1.0), target=1.0), preset=preset)
    assert path.status is Status.REACHED_TARGET
    assert path.endpoint.y[0] == pytest.approx(1.0, abs=1e-7)


@without_series
@pytest.mark.parametrize("lam0", [0.0, 1e-2])
def test_a_start_that_is_zero_by_symmetry_counts(preset, lam0):
    """A truss of six bars at rest: H is 1e-16 there, and two of its three unknowns never move but by round-off."""
    X = np.array([[43.3 * np.cos(k * np.pi / 3), 43.3 * np.sin(k * np.pi / 3), -8.216] for k in range(6)])
    L = np.linalg.norm(X, axis=1)

    def residual(y, lam):
        d = np.asarray(y, float) - X
        g = ((d * d).sum(1) / L**2 - 1) / 2
        return ((g / L)[:, None] * d).sum(0) + lam * np.array([0, 0, 1e-3])

    def jacobian(y, lam):
        d = np.asarray(y, float) - X
        g = ((d * d).sum(1) / L**2 - 1) / 2
        parts = ((a * np.eye(3) + np.outer(b, b) / c**2) / c for a, b, c in zip(g, d, L))
        return sum(parts), np.array([0, 0, 1e-3])

    path = trace(
        from_functions(residual, jacobian, start=(np.zeros(3), lam0), target=None), preset=preset, box={"lam": (-3, 3)}
    )
    assert path.status is Status.STOPPED_AT_EVENT
    assert path.endpoint.lam == 3.0


@without_series
@pytest.mark.parametrize("noise", [0.0, 1e-10, 1e-8, 1e-6])
def test_noise_is_measured_and_followed(preset, noise):
    generator = np.random.default_rng(7)

    def residual(y, lam):
        t, lam = float(y[0]), float(lam)
        exact = [t**3 - 3.0 * t - lam, float(y[1]) - t * t, float(y[2]) - np.sin(t) * float(y[1])]
        return np.array(exact) + noise * generator.uniform(-1.0, 1.0, 3)

    t = -2.5
    start = ([t, t * t, np.sin(t) * t * t], t**3 - 3.0 * t)
    path = trace(from_functions(residual, start=start, target=8.125), preset=preset, budget=Budget(steps=200))
    assert path.status is Status.REACHED_TARGET
    # Those of the clean path: 16, 18 and 52 points.
    assert len(path) <= {"FAST": 32, "DEFAULT": 36, "CONSERVATIVE": 104}[preset.name]
    folds = [event.lam for event in path.turning_points]
    assert folds == pytest.approx([2.0, -2.0], abs=max(1e-12, noise**0.5))
    assert ("noisy" in path.message) == (noise >= 1e-6)


@every_preset
@pytest.mark.parametrize("d", [1e-2, 1e-6, 1e-10, 1e-12, 1e-13, 1e-14, 1e-15])
def test_the_error_of_an_end_is_a_bound(preset, d):
    homotopy = from_functions(lambda y, lam: np.stack([y[0] ** 2 + lam**2 - 1.0]), start=([1.0], 0.0), target=1.0 - d)
    path = trace(homotopy, preset=preset)
    with mp.workdps(50):
        true = mp.sqrt((1 - mpf(homotopy.target)) * (1 + mpf(homotopy.target)))
        error = float(abs(mpf(float(path.endpoint.y[0])) - true))
    assert path.status is Status.REACHED_TARGET
    assert error <= 2.0 * path.end_error
    assert path.end_error <= 1e4 * max(error, np.finfo(float).eps)


@every_preset
def test_an_asymptote_at_the_target_is_no_end(preset):
    homotopy = from_functions(lambda y, lam: np.stack([np.exp(-y[0]) - (1.0 - lam)]), start=([0.0], 0.0), target=1.0)
    path = trace(homotopy, preset=preset)
    assert path.status is Status.DIVERGED
    assert "An asymptote: the parameter tends to 1 " in path.message


@every_preset
def test_a_path_that_grows_for_ever_is_followed_until_the_budget_ends(preset):
    homotopy = from_functions(lambda y, lam: np.stack([y[0] ** 3 - lam]), start=([1.0], 1.0), target=None)
    path = trace(homotopy, preset=preset)
    assert path.status is Status.BUDGET_EXHAUSTED
    assert "Reached: numbers of " in path.message


def test_a_parameter_that_hardly_enters():
    root = 0.6823278038280193
    homotopy = from_functions(lambda y, lam: np.stack([y[0] ** 3 + y[0] - 1.0 - 1e-9 * lam]), start=([root], 0.0))
    for metric in (None, Euclidean()):
        path = trace(homotopy, target=1.0, metric=metric)
        assert path.status is Status.REACHED_TARGET
        assert len(path) <= 5


def test_no_folds_far_out_where_the_parameter_is_next_to_nothing():
    start = ([0.5], 1.0 / (1.0 + 0.5**8))
    homotopy = from_functions(lambda y, lam: np.stack([lam * (1.0 + y[0] ** 8) - 1.0]), start=start, target=0.0)
    for preset in PRESETS:
        path = trace(homotopy, preset=preset)
        assert path.status is Status.DIVERGED
        assert path.turning_points == []


def test_all_says_of_the_budget_what_is_in_sight():
    homotopy = from_functions(lambda y, lam: np.stack([y[0] * (1.0 - lam) - 1.0]), start=([1.0], 0.0), target=1.0)
    whole = trace(homotopy)
    path = trace(homotopy, budget=Budget(steps=len(whole) - 2))
    assert path.status is Status.BUDGET_EXHAUSTED
    assert "In sight, and not followed to its end: a pole: " in path.message
    assert continuation.Status(path.status) is path.status


def test_samples_of_one_field_have_one_scale():
    """Of two fields of three samples, and the parameter, which is no part of one."""
    size = np.array([1.0, 10.0, 0.1, 1e6, 1e5, 1e7])

    def residual(y, lam):
        return y / size + (y / size) ** 3 - lam

    homotopy = from_functions(residual, start=(np.zeros(6), 0.0), target=1.0)
    tracer = Tracer(homotopy, metric=continuation.Automatic(blocks=np.array([0, 0, 0, 1, 1, 1])))
    next(iter(tracer))
    weights = tracer.state.weights
    assert len(set(weights[:3])) == len(set(weights[3:6])) == 1
    assert weights[0] / weights[3] == pytest.approx(1e12, rel=1e-6)
    assert tracer.run().status is Status.REACHED_TARGET


@every_preset
@pytest.mark.parametrize("y", [np.cos(np.pi / 2.0), -np.cos(np.pi / 2.0), 1e-12, 1e-9])
def test_a_start_at_a_fold_to_round_off(preset, y):
    """The circle from its top: where y = cos(pi / 2) the parameter's tangent is what the path has next to its fold."""
    for size, unit in ((1.0, 1.0), (5.0, 1e-6), (0.3, 1e4)):
        homotopy = from_functions(
            lambda x, lam, size=size, unit=unit: (x / (size * unit)) ** 2 + lam**2 - 1.0,
            start=(np.array([size * unit * y]), 1.0),
            target=None,
        )
        path = trace(homotopy, preset=preset)
        assert path.status is Status.CLOSED
        assert sorted(round(fold.lam, 9) for fold in path.turning_points) == [-1.0, 1.0]


@without_series
@pytest.mark.parametrize("tolerance", [1e-8, 1e-3])
def test_a_residual_in_single_precision(preset, tolerance):
    """Short differences of it are zero, and agree: that is no derivative."""

    def residual(y, lam):
        y = np.asarray(y, dtype=np.float32)
        return y**3 - np.float32(3.0) * y - np.float32(lam)

    path = trace(from_functions(residual, start=([-2.5], -8.125), target=8.125), preset=preset, tolerance=tolerance)
    assert path.status is Status.REACHED_TARGET
    np.testing.assert_allclose([fold.lam for fold in path.turning_points], [2.0, -2.0], atol=1e-4)
    assert path.endpoint.y[0] == pytest.approx(2.5, abs=1e-4)
    assert ("noisy" in path.message) == (tolerance < 1e-5)
