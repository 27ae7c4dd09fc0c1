"""Discretised scenes: second order in the mesh, by Richardson's quotient of three meshes and against closed forms.

Where the edge of a contact lies between two points moves the error by a bounded multiple of h^2. Meshes on which it
lies equally far from the next point, as at a third of the length for h, h/4 and h/16, show the order.
"""

from __future__ import annotations

from math import log, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq

from problems.scenes import solve
from problems.scenes.american_put import AmericanPut
from problems.scenes.arch import Arch
from problems.scenes.bearing import Bearing
from problems.scenes.bratu_lid import BratuLid
from problems.scenes.converter import Converter
from problems.scenes.membrane import Membrane
from problems.scenes.string import String
from problems.scenes.torsion import Torsion

BREAKS_AT_240 = 0.21723615212719208
"""The eccentricity at which the film breaks after two thirds of the round."""

CASES = {
    "string": ((String, {"height": 1.0 / 18.0}), "contact from", (10, 40, 160)),
    "membrane": ((Membrane, {"radius": 3.0 / sqrt(1.0 + log(3.0))}), "contact radius", (10, 40, 160)),
    "bearing": ((Bearing, {"eccentricity": BREAKS_AT_240}), "film breaks at", (39, 159, 639)),
    "bearing's load": ((Bearing, {"eccentricity": BREAKS_AT_240}), "load", (39, 159, 639)),
    "Bratu's fold": ((BratuLid, {}), "fold", (10, 20, 40)),
    "Bratu's kink": ((BratuLid, {}), "turning kink", (10, 20, 40)),
    "elastic torsion": ((Torsion, {"twist": 1.0}), "torque", (8, 16, 32)),
    "plastic torsion": ((Torsion, {"twist": 2.5}), "torque", (8, 16, 32)),
    # The current is zero for a third of the period, and ends between two points on all meshes.
    "converter": ((Converter, {"load": 36.0}), "output", (20, 40, 80)),
}


@pytest.mark.parametrize("case", CASES)
def test_the_order_is_two(case):
    (factory, parameters), name, meshes = CASES[case]
    found, exact = [], factory(**parameters).exact().get(name)
    for n in meshes:
        one = factory(**parameters, n=n)
        found.append(one.answer(solve(one))[name])
    ratio = (meshes[1] + (case[:7] == "bearing")) / (meshes[0] + (case[:7] == "bearing"))
    order = log((found[0] - found[1]) / (found[1] - found[2])) / log(ratio)
    assert order == pytest.approx(2.0, abs=0.15), found
    if exact is not None and case != "converter":
        limit = found[2] + (found[2] - found[1]) / (ratio**2 - 1.0)
        assert abs(limit - exact) <= 0.1 * abs(found[2] - exact)


def test_an_arch_stands_from_milankovitchs_thickness_on():
    def spare(thickness):
        arch = Arch(thickness=thickness, stones=60)
        return arch.answer(solve(arch))["spare moment"]

    assert brentq(spare, 0.10, 0.12, xtol=1e-6) == pytest.approx(0.1075, abs=1e-4)
    assert not Arch(thickness=0.09).answer(solve(Arch(thickness=0.09)))["stands"]


@pytest.mark.parametrize(
    ("case", "published"),
    [
        ((100.0, 100.0, 0.05, 0.2, 1.0), 6.0905),
        ((36.0, 40.0, 0.06, 0.2, 1.0), 4.4867),
        ((44.0, 40.0, 0.06, 0.4, 2.0), 5.6470),
    ],
)
def test_american_puts(case, published):
    """The published digits are those of a tree; its limit is a little lower."""
    coarse, fine = (AmericanPut(*case, n=n, steps=steps) for n, steps in ((199, 50), (399, 100)))
    found = [one.answer(solve(one))["price"] for one in (coarse, fine)]
    limit = found[1] + (found[1] - found[0]) / 3.0
    assert limit == pytest.approx(fine.exact()["price"], abs=6e-5)
    assert limit == pytest.approx(published, abs=4e-4)
    assert found[1] == pytest.approx(fine.exact()["price"], abs=1e-3)


def test_the_price_of_exercise_falls_from_the_strike_with_the_time_left():
    scene = AmericanPut(n=199, steps=50)
    found = solve(scene)
    assert found.boundary[0] == 100.0
    assert np.diff(found.boundary).max() <= 1e-7
    assert 50.0 < found.boundary[-1] < 100.0


def test_values_that_no_float_holds_stop_no_time_step():
    """On this mesh they fall to subnormal numbers in the second step: no row is right relative to its terms."""
    scene = AmericanPut(n=800, steps=200)
    found = solve(scene)
    assert found.success
    assert scene.answer(found)["price"] == pytest.approx(6.09037, abs=1e-4)
