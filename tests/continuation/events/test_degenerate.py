"""Degenerate branch points: branches that touch, and more than two that cross, are passed, located and said."""

import numpy as np
import pytest

from continuation import (
    CONSERVATIVE,
    DEFAULT,
    FAST,
    SERIES,
    Kind,
    Status,
    branch_directions,
    from_functions,
    switch_branch,
    trace,
)

from ...util import every_preset

# Of y, the residual; the branch that is followed; the directions of the others at 0.
CASES = {
    "touching": (lambda y, l: y * (y - l**2), 0.0, []),
    "cubic contact": (lambda y, l: y * (y - l**3), 0.0, []),
    "three lines": (lambda y, l: y * (y - l) * (y + 2.0 * l), 0.0, [1.0, -2.0]),
    "four lines": (lambda y, l: y * (y - l) * (y + l) * (y - 2.0 * l), 0.0, [1.0, -1.0, 2.0]),
    "three sloped lines": (lambda y, l: (y - l) * (y + 2.0 * l) * (y - 0.3 * l) * (1.0 + 0.2 * y), 0.3, [1.0, -2.0]),
    "touching with a slope": (lambda y, l: (y - l) * (y - l - l**2), 1.0, []),
}


def path_of(name, preset, begin=-1.0, D=1.0, E=1.0):
    function, slope, _ = CASES[name]
    homotopy = from_functions(
        lambda y, lam: np.stack([E * function(y[0] / D, lam)]), start=([D * slope * begin], begin), target=1.0
    )
    return homotopy, trace(homotopy, preset=preset)


@every_preset
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize(("begin", "D", "E"), [(-1.0, 1.0, 1.0), (-0.73, 1e5, 1e-3)])
def test_the_path_goes_straight_on_and_the_point_is_said(name, preset, begin, D, E):
    _, path = path_of(name, preset, begin, D, E)
    assert path.status is Status.REACHED_TARGET, path.message
    assert path.endpoint.y / D == pytest.approx(CASES[name][1], abs=1e-9)
    (event,) = path.events
    assert event.kind == Kind.SINGULAR_POINT
    assert abs(event.lam) < 1e-4  # a third root of round-off
    assert path.counts.factorizations < 80  # it crept past with 150 to 380


TOUCHING = [
    *((2, gap, preset) for gap in (0.0, 1e-5, 1e-7) for preset in (FAST, DEFAULT, CONSERVATIVE, SERIES)),
    (3, 0.0, SERIES),  # the others often end before a contact of third order, and say so
]


@pytest.mark.parametrize(("order", "gap", "preset"), TOUCHING, ids=lambda value: getattr(value, "name", value))
@pytest.mark.parametrize("a", [0.4, 1.3])
def test_curved_branches_that_touch_or_nearly_do_are_not_confused(a, order, gap, preset):
    homotopy = from_functions(
        lambda y, lam: np.stack([(y[0] - a * lam**order) * (y[0] + 0.9 * lam**order + gap), y[1] - np.sin(lam) - y[0]]),
        start=([a * (-0.83) ** order, np.sin(-0.83) + a * (-0.83) ** order], -0.83),
        target=0.7,
    )
    path = trace(homotopy, preset=preset)
    assert path.status is Status.REACHED_TARGET, path.message
    assert path.endpoint.y[0] == pytest.approx(a * 0.7**order, rel=1e-9)
    assert [event.kind for event in path.events] == ([] if gap else [Kind.SINGULAR_POINT])
    assert all(abs(event.lam) < 1e-3 for event in path.events)


@pytest.mark.parametrize("name", ["three lines", "three sloped lines"])
def test_the_directions_of_all_lines_are_found(name):
    homotopy, path = path_of(name, DEFAULT)
    _, *others = branch_directions(homotopy, path.events[0])
    found = sorted(float(v[0] / v[1]) for v in others)
    assert found == pytest.approx(sorted(CASES[name][2]), abs=1e-3)


@pytest.mark.parametrize("name", ["three lines", "four lines", "three sloped lines"])
def test_every_line_is_left_both_ways(name):
    homotopy, path = path_of(name, DEFAULT)
    slopes = sorted(float(v[0] / v[1]) for _, v in switch_branch(homotopy, path.events[0]))
    assert slopes == pytest.approx(sorted(2 * CASES[name][2]), abs=1e-6)
