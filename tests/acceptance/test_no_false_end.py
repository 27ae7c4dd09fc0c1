"""No false end: what round-off, noise and small numbers make of a path is neither an end nor a refusal.

The campaign is `examples/benchmarks/ends.py`; a few paths of each family are traced here.
"""

import itertools
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from mpmath import mp, mpf
from numpy.polynomial import Polynomial

import continuation
from continuation import (
    CONSERVATIVE,
    DEFAULT,
    FAST,
    SERIES,
    Budget,
    Monitor,
    Status,
    TargetValue,
    from_functions,
    trace,
)
from continuation.controllers import Bounds, Fixed
from continuation.evaluation.noise import noise_along
from continuation.metric import Euclidean
from continuation.step.tracer import Tracer

from ..util import benchmark, by_preset, path_of

families = benchmark("ends.py")
without_series = by_preset(FAST, DEFAULT)
every_preset = by_preset(FAST, DEFAULT, SERIES)


NOISE = [
    *(("zero by symmetry", [k, 77]) for k in (36, 48, 51, 95)),
    *(("trusses", [*seed, 7]) for seed in ([1, 3], [1, 4], [1, 8], [20261127])),
    *(("trusses", seed) for seed in ([20261128, 21], [20261201, 1], [20261126, 27])),
]
"""It vanishes at the start, or looks smooth on a grid: these ended as STEP_TOO_SMALL, since scales were round-off's."""


@pytest.mark.parametrize(
    ("preset", "family", "seed"),
    [
        *itertools.product((FAST, DEFAULT, SERIES), families.FAMILIES, ([0, 45], [1, 45])),
        *((preset, *noise) for preset in (FAST, CONSERVATIVE) for noise in NOISE),
    ],
)
def test_families_in_random_units(preset, family, seed):
    generator = np.random.default_rng(seed)
    case = families.FAMILIES[family](generator)
    path = trace(case.homotopy(*10.0 ** generator.uniform(-4.0, 4.0, 3)), preset=preset, budget=Budget(steps=2000))
    assert families.wrong(path, case) == ""
    assert (family, seed) not in NOISE or not path.events


@every_preset
@pytest.mark.parametrize("d", [1e-2, 1e-6, 1e-10, 1e-12, 1e-13, 1e-14, 1e-15])
@pytest.mark.parametrize("others", [[], [(2.0, 0.0)], [(0.0, 1e-6)]], ids=["alone", "at rest", "in a small unit"])
def test_the_error_of_an_end_is_a_bound(preset, others, d):
    """Beside an unknown that stands still, or follows the parameter in a small unit, too."""

    def residual(y, lam):
        return np.stack([y[0] ** 2 + lam**2 - 1.0, *(y[1] - at - slope * lam for at, slope in others)])

    start = [1.0, *(at for at, _ in others)]
    homotopy = from_functions(residual, start=(start, 0.0), target=1.0 - d)
    path = path_of(homotopy, preset=preset)
    with mp.workdps(50):
        true = mp.sqrt((1 - mpf(homotopy.target)) * (1 + mpf(homotopy.target)))
        error = float(abs(mpf(float(path.endpoint.y[0])) - true))
    assert error <= 2.0 * path.end_error
    # Round-off of the parameter moves the end by eps / sqrt(d).
    known = np.finfo(float).eps / (np.sqrt(d) if others else 1.0)
    assert path.end_error <= 1e4 * max(error, known)


@every_preset
@pytest.mark.parametrize(
    ("size", "unit", "target"),
    [
        (0.0012464456977341373, 746.997097442634, 746.9970897293323),
        (0.0787474205648065, 0.011253023365254989, 0.011253023249876249),
        (7411.434926737541, 210.0635473548268, 210.06354524870105),
        (16.568561467980505, 2.4606021211320215, 2.460602093027407),
    ],
)
def test_the_error_of_an_end_before_a_pole_is_a_bound(preset, size, unit, target):
    """The parameter is rounded by its unit, alike at all samples of the endgame that lie close together."""
    path = path_of(
        from_functions(lambda y, lam: (1.0 - lam / unit) * (y / size) - 1.0, start=([size], 0.0), target=target),
        preset=preset,
    )
    true = Fraction(size) / (1 - Fraction(target) / Fraction(unit))
    assert abs(float(Fraction(float(path.endpoint.y[0])) - true)) <= 2.0 * path.end_error


@pytest.mark.parametrize("metric", [None, Euclidean()])
def test_a_parameter_that_hardly_enters(metric):
    homotopy = from_functions(lambda y, lam: y**3 + y - 1.0 - 1e-9 * lam, start=([0.6823278038280193], 0.0))
    path = path_of(homotopy, target=1.0, metric=metric)
    assert len(path) <= 5


def powell(start):
    """Powell's badly scaled function: the parameter rises to a pole at which the first unknown vanishes.

    As y_2 grows y_1 falls to 0: (1 - lam) times the second component is then -1e-4.
    """

    def plain(y):
        return np.stack([1e4 * y[0] * y[1] - 1.0, np.exp(-y[0]) + np.exp(-y[1]) - 1.0001])

    there = plain(np.array(start))
    pole = f"|lam - {1.0 - 1e-4 / -there[1]:.9g}|^-1."
    return lambda y, lam: plain(y) + (lam - 1.0) * there, (start, 0.0), 1.0, Status.DIVERGED, pole, None, []


ENDS = {
    # Residual, start, target; status, what is said, the end, and the folds, where they are known.
    "an asymptote at the target": (
        lambda y, lam: np.exp(-y) - (1.0 - lam), ([0.0], 0.0), 1.0,
        Status.DIVERGED, "An asymptote: the parameter tends to 1 ", None, None,
    ),
    "an asymptote at zero": (
        # lam = 3 x (1 - x) / (1 - exp(-5 x)) tends to 0 as x falls, and never is 0.
        lambda y, lam: 3.0 * y * (1.0 - y) - lam * (1.0 - np.exp(-5.0 * y)),
        ([-0.5], 3.0 * -0.5 * 1.5 / (1.0 - np.exp(2.5))), 0.0,
        Status.DIVERGED, "An asymptote: the parameter tends to 0 ", None, None,
    ),
    "growth for ever": (
        lambda y, lam: y**3 - lam, ([1.0], 1.0), None, Status.BUDGET_EXHAUSTED, "Reached: numbers of ", None, None,
    ),
    "far out, where the parameter is next to nothing": (
        lambda y, lam: lam * (1.0 + y**8) - 1.0, ([0.5], 1.0 / (1.0 + 0.5**8)), 0.0, Status.DIVERGED, "", None, [],
    ),
    # The denominators of Pade's approximants are singular on the way.
    "a target just beyond a fold": (
        lambda y, lam: y**2 + lam - 1.0 + 1e-9, ([-1.0], 0.0), 1.0,
        Status.BUDGET_EXHAUSTED, "Reached: numbers of ", None, pytest.approx([1.0 - 1e-9], abs=1e-14),
    ),
    # p V = p0 V0 from p0 = 1e7 Pa, in terms of p - p0.
    "pascals": (
        lambda y, lam: (y + 1e7) * (1.0 - lam) - 1e7, ([0.0], 0.0), 0.5,
        Status.REACHED_TARGET, "", pytest.approx(1e7, rel=1e-12), [],
    ),
    **{
        f"a slope of {slope}": (
            lambda y, lam, slope=slope: y - slope * lam, ([0.0], 0.0), 1.0,
            Status.REACHED_TARGET, "", pytest.approx(slope, rel=1e-14), [],
        ) for slope in (1e3, 1e8, 1e12)
    },
    **{
        f"an imperfection of {eps}": (
            lambda y, lam, eps=eps: lam * y - y**3 + eps, ([eps], -1.0), 1.0,
            Status.REACHED_TARGET, "", pytest.approx(1.0, abs=1e-7), [],
        ) for eps in (1e-8, 1e-10, 1e-12, 1e-14)
    },
    # Differences with steps of the size of y would see another function.
    **{
        f"1e5 of its extents away from zero, lam of {1.0 / scale:g}": (
            lambda y, lam, scale=scale: (y - 1e5) ** 3 * (1.0 - lam * scale) - 1.0, ([1e5 + 1.0], 0.0), 0.5 / scale,
            Status.REACHED_TARGET, "", pytest.approx(1e5 + 2.0 ** (1.0 / 3.0), abs=1e-9), None,
        ) for scale in (1.0, 1e-3)
    },
    **{f"Powell's function from {start}": powell(start) for start in ((3.0, 6.0), (4.0, 5.0))},
}  # fmt: skip


@every_preset
@pytest.mark.parametrize("name", ENDS)
def test_an_end_and_what_is_said_of_it(name, preset):
    residual, start, target, status, said, end, folds = ENDS[name]
    path = path_of(from_functions(residual, start=start, target=target), preset=preset, status=status)
    assert said in path.message
    assert end is None or path.endpoint.y[0] == end
    assert folds is None or [event.lam for event in path.turning_points] == folds
    # At zero no root is sought where lam is below round-off of any step: 48 to 204 under the kernels of OpenBLAS, where
    # it was 294 to 919.
    assert name != "an asymptote at zero" or path.counts.factorizations <= 290


def test_all_says_of_the_budget_what_is_in_sight():
    homotopy = from_functions(lambda y, lam: np.stack([y[0] * (1.0 - lam) - 1.0]), start=([1.0], 0.0), target=1.0)
    whole = trace(homotopy)
    path = path_of(homotopy, budget=Budget(steps=len(whole) - 2), status=Status.BUDGET_EXHAUSTED)
    assert "In sight, and not followed to its end: a pole: " in path.message


def test_samples_of_one_field_have_one_scale():
    """Of two fields of three samples, and the parameter, which is no part of one."""
    size = np.array([1.0, 10.0, 0.1, 1e6, 1e5, 1e7])

    start, target, blocks = (np.zeros(6), 0.0), 1.0, (0, 0, 0, 1, 1, 1)
    plain = from_functions(lambda y, lam: y / size + (y / size) ** 3 - lam, start=start, target=target)
    known = SimpleNamespace(residual=plain.residual, start=plain.start, target=target, blocks=blocks)
    for tracer in (Tracer(known), Tracer(plain, metric=continuation.Automatic(blocks=np.array(blocks)))):
        next(iter(tracer))
        weights = tracer.state.weights
        assert len(set(weights[:3])) == len(set(weights[3:6])) == 1
        assert weights[0] / weights[3] == pytest.approx(1e12, rel=1e-6)
        assert tracer.run().status is Status.REACHED_TARGET


@every_preset
@pytest.mark.parametrize("y", [np.cos(np.pi / 2.0), -np.cos(np.pi / 2.0), 1e-12, 1e-9])
@pytest.mark.parametrize("unit", [1.0, 5e-6, 3e3])
def test_a_start_at_a_fold_to_round_off(preset, y, unit):
    """The circle from its top: where y = cos(pi / 2) the parameter's tangent is what the path has next to its fold."""
    start = (np.array([unit * y]), 1.0)
    path = path_of(
        from_functions(lambda x, lam: (x / unit) ** 2 + lam**2 - 1.0, start=start, target=None),
        preset=preset,
        status=Status.CLOSED,
    )
    assert sorted(round(fold.lam, 9) for fold in path.turning_points) == [-1.0, 1.0]


@without_series
@pytest.mark.parametrize(
    ("residual", "start"),
    [
        (lambda y, lam: np.stack([y[0] + y[1] - np.hypot(*y) - lam, y[1] - y[0] - lam]), [1e-17, 2e-17]),
        (lambda y, lam: np.stack([y[0] - lam**2, y[1] - 1.0 - lam - y[0] ** 1.5]), [1e-17, 1.0]),
    ],
)
def test_a_start_near_zero_where_no_derivative_is_at_zero(preset, residual, start):
    path_of(from_functions(residual, start=(start, 0.0), target=1.0), preset=preset)


@every_preset
@pytest.mark.parametrize(
    ("folds", "unit"),
    [
        ((-0.509, -0.356, 0.646, 0.932), (7e4, 1e3)),
        ((-0.917, -0.807, -0.552, 0.25, 0.716), (1e-3, 3e-2)),
        ((-0.96, 0.002), (4e-5, 0.3)),
        ((-0.567, -0.326, 0.207), (20.0, 1e2)),
    ],
)
def test_a_path_begins_at_a_fold_of_a_polynomial(preset, folds, unit):
    """At a fold the parameter is a parabola, which has no scale: only what bends it away from one tells how far."""
    p = Polynomial.fromroots(folds).integ()
    homotopy = from_functions(
        lambda y, lam: p(y / unit[0]) - lam / unit[1], start=(np.array([folds[0] * unit[0]]), p(folds[0]) * unit[1])
    )
    path = path_of(
        homotopy, target=None, preset=preset, box={0: (-1.5 * unit[0], 1.5 * unit[0])}, status=Status.STOPPED_AT_EVENT
    )
    found = [fold.u[0] / unit[0] for fold in path.turning_points]
    beyond = [t for t in folds if folds[0] < t] if path.u[-1, 0] > path.u[0, 0] else []
    np.testing.assert_allclose([t for t in found if abs(t - folds[0]) > 1e-5], beyond, atol=1e-6)


@without_series
@pytest.mark.parametrize("tolerance", [1e-8, 1e-3])
def test_a_residual_in_single_precision(preset, tolerance):
    """Short differences of it are zero, and agree: that is no derivative."""

    def residual(y, lam):
        y = np.asarray(y, dtype=np.float32)
        return y**3 - np.float32(3.0) * y - np.float32(lam)

    path = path_of(from_functions(residual, start=([-2.5], -8.125), target=8.125), preset=preset, tolerance=tolerance)
    np.testing.assert_allclose([fold.lam for fold in path.turning_points], [2.0, -2.0], atol=1e-4)
    assert path.endpoint.y[0] == pytest.approx(2.5, abs=1e-4)
    assert ("noisy" in path.message) == (tolerance < 1e-5)


@every_preset
def test_an_event_before_the_end_of_an_arc_that_goes_on_is_found(preset):
    """Beyond the terminal event the function takes its old sign again, at once: the whole arc shows nothing."""
    hidden = Monitor(lambda u, v: min(30.0 - u[-1], 1.0) if u[-1] <= 36.0 else 1.0, "hidden")
    homotopy = from_functions(lambda y, lam: y - 1e-3 * lam, start=([0.0], 0.0), target=None)
    options = {"metric": Euclidean(), "controller": Fixed(Bounds(initial=50.0))}
    path = trace(homotopy, preset=preset, direction=1, events=[hidden, TargetValue(33.0)], **options)
    assert [event.lam for event in path.events] == pytest.approx([30.0, 33.0], rel=1e-12)


def test_equal_samples_are_no_evidence_of_an_exact_function():
    """At the first distance all samples are rounded alike, nearer by one of eight is not."""
    values = iter([0.1] * 8 + [0.1, 0.1, 0.1 + 1e-10, 0.1, 0.1, 0.1, 0.1, 0.1] * 2)
    u, w = np.array([1.0, 0.0]), np.array([1.0, 1.0])
    noise = noise_along(lambda _: np.array([next(values)]), u, w, np.array([0.1]), np.array([1e-14]))
    assert 1e-12 < noise[0] < 1e-8


@every_preset
def test_frequencies_do_not_run_off_to_infinity(preset):
    """Mutation and selection of eight species: at lam = 1.5 another takes over, within 1e-21 of a crossing.

    No such path ends there, whatever rounding makes of it; a frequency of .997 that rises like a pole said DIVERGED.
    """
    n, m = 8, 1e-3
    Q = (1 - 2 * m) * np.eye(n) + m * (np.eye(n, k=1) + np.eye(n, k=-1))
    Q[0, 0] = Q[-1, -1] = 1 - m

    def residual(x, lam):
        w = np.concatenate([np.stack([lam + 0 * x[0]]), np.ones(n - 2), np.array([1.5])])
        return (w * x) @ Q - x * (w * x).sum()

    values, vectors = np.linalg.eig(Q.T @ np.diag(np.r_[np.ones(n - 1), 1.5]))
    x = np.abs(vectors[:, np.argmax(values.real)].real)
    path = trace(
        from_functions(residual, start=(x / x.sum(), 1.0), target=2.0),
        preset=preset,
        budget=Budget(factorizations=1000),
    )
    assert path.status is not Status.DIVERGED


@every_preset
@pytest.mark.parametrize(("seed", "angle"), [(9, 1e-2), (9, 1e-3), (3, 1e-3), (5, 1e-2)])
def test_branches_that_cross_at_a_small_angle_are_told_from_noise(seed, angle, preset):
    """FAST's factorisation is of a point nearby: its eigenvalues differ from one before anything is noise."""
    generator = np.random.default_rng([seed, 7])
    place, b, c = generator.uniform(-0.5, 1.5), generator.uniform(0.3, 2.0), generator.uniform(-1.0, 1.0)

    def residual(y, lam):
        off = y[0] - np.sin(b * lam) - c * lam
        return np.stack([off * (off - angle * (lam - place))])

    first = np.sin(-b) - c
    path = trace(from_functions(residual, start=([first], -1.0), target=2.0), preset=preset)
    assert [event.lam for event in path.branch_points] == pytest.approx([place], abs=1e-6)
    assert path.endpoint.y == pytest.approx([np.sin(2.0 * b) + 2.0 * c], abs=1e-9)
