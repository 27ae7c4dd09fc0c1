"""Paths whose turning points, ends and lengths are known, in closed form or to many digits, under two presets."""

import numpy as np
import pytest
from attrs import evolve

from continuation import DEFAULT, FAST, Status, TurningPoint, trace
from continuation import arclength as length
from continuation.controllers import Bounds
from problems.bifurcation import Aircraft, Circle, Cusp, ExponentialCosine
from problems.nonlinear import brown, fixed_point
from tests.truth import aircraft, exponential_cosine

from ..util import by_preset, path_of

# n: x1 at the end, turning points of lam.
COSINES = {
    2: (1.1003509626909, 0), 3: (0.37472756109156, 4), 4: (0.42145547339476, 4), 5: (1.5875828159969, 10),
    6: (1.9949909313114, 12), 7: (2.3730945655736, 18), 8: (0.39859096762391, 24),
}  # fmt: skip
LENGTHS = {5: 2.7114077076, 10: 3.7199286259, 20: 5.1259069338, 30: 6.1886027468}
"""Of the paths to the roots of Brown's almost linear function; six digits are promised, the tables have eleven."""


def cusp(splitting):
    """Folds where algebra puts them."""
    x = np.sqrt(splitting / 3.0)
    mu = 2.0 / 3.0 * splitting * x
    return Cusp(splitting), {}, Status.REACHED_TARGET, [(-x, mu), (x, -mu)], (1e-12, 1e-13), [], None


def flight(elevator, aileron, direction):
    """Every limit point of the tables, at a high angle of attack; the last one ends the path."""
    turns = aircraft.limit_points(elevator, aileron)
    options = {"direction": direction, "events": [TurningPoint(terminal=len(turns))]}
    return Aircraft(elevator), options, Status.STOPPED_AT_EVENT, turns, (0.0, 1e-10), [], None


def cosines(n, **options):
    """The family on which other tracers jump."""
    turns, (x1, count) = exponential_cosine.turning_points(n), COSINES[n]
    assert len(turns) == count
    return ExponentialCosine(n), options, Status.REACHED_TARGET, turns, (0.0, 1e-10), [x1], None


def almost_linear(n):
    F = brown(n)
    homotopy, along = fixed_point(F, np.zeros(n), F.jacobian), pytest.approx(LENGTHS[n], abs=1e-9)
    return homotopy, {}, Status.REACHED_TARGET, np.zeros((0, n + 1)), (0.0, 1e-9), np.ones(n), along


# Homotopy, options; status, turning points and their accuracy, the first components of the end, the length.
KNOWN = {
    **{
        f"circle, {sign}": (
            Circle(), {"direction": sign}, Status.CLOSED, [(0.0, sign), (0.0, -sign)], (0.0, 1e-12), [1.0, 0.0],
            pytest.approx(2.0 * np.pi, rel=1e-10),
        ) for sign in (-1, 1)
    },
    **{f"cusp, {splitting}": cusp(splitting) for splitting in (1.0, 0.003, 0.01, 0.0324, 0.07, 30.0)},
    **{
        f"aircraft, {elevator}, {aileron}": flight(elevator, aileron, direction)
        for elevator in aircraft.ELEVATORS for aileron, direction in (("falling", -1), ("rising", 1))
    },
    **{f"Brown, {n}": almost_linear(n) for n in LENGTHS},
    **{f"exponential-cosine, {n}": cosines(n) for n in COSINES},
}  # fmt: skip
CASES = {
    **{
        f"{preset.name}, {name}": (preset, row)
        for preset in (FAST, DEFAULT) for name, row in KNOWN.items()
    },
    # Steps of a tenth are those of the ceiling, whatever the preset.
    **{
        f"{preset.name}, exponential-cosine, {n}, steps of {longest}": (
            preset, cosines(n, controller=evolve(preset.controller, bounds=Bounds(maximum=longest))),
        ) for n in COSINES for preset, longest in ((FAST, 1.0), (DEFAULT, 0.1))
    },
}  # fmt: skip


@pytest.mark.parametrize(("preset", "row"), CASES.values(), ids=CASES)
def test_turning_points_ends_and_lengths(preset, row):
    homotopy, options, status, turns, (rtol, atol), end, along = row
    path = path_of(homotopy, preset=preset, **options, status=status)
    assert status is not Status.REACHED_TARGET or path.endpoint.lam == homotopy.target
    found = np.reshape([event.u for event in path.turning_points], np.shape(turns))
    np.testing.assert_allclose(found, turns, rtol=rtol, atol=atol)
    np.testing.assert_allclose(path.endpoint.u[: len(end)], end, rtol=0.0, atol=atol)
    assert along is None or length(homotopy, path) == along


@by_preset(FAST, DEFAULT)
def test_the_published_digits_of_a_fold(preset):
    assert trace(Cusp(1.0), preset=preset).turning_points[0].lam == pytest.approx(0.3849001794597505, abs=1e-14)
