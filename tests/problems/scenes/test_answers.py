"""Scenes: published answers, closed forms, and what holds of any answer."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from problems.scenes import error, solve
from problems.scenes.block import Block
from problems.scenes.box import Box
from problems.scenes.braess import Braess
from problems.scenes.bratu_lid import BratuLid
from problems.scenes.converter import Converter
from problems.scenes.cournot import Cournot
from problems.scenes.denoising import Denoising
from problems.scenes.diode_bridge import DiodeBridge
from problems.scenes.flash_drum import FlashDrum
from problems.scenes.game import Game
from problems.scenes.lasso import Lasso, penalised
from problems.scenes.membrane import Membrane
from problems.scenes.painleve_rod import PainleveRod
from problems.scenes.pile import Pile
from problems.scenes.portfolio import Portfolio, critical_line
from problems.scenes.puck import Puck
from problems.scenes.regulator import Regulator
from problems.scenes.snap_through import SnapThrough
from problems.scenes.spatial_prices import SpatialPrices
from problems.scenes.string import String
from problems.scenes.svm import SVM, clouds
from problems.scenes.torsion import Torsion
from problems.scenes.traffic import Traffic
from problems.scenes.truss import Truss


def answered(scene):
    """The answer of a scene."""
    return scene.answer(solve(scene))


TRUSS = {"plastic elongations": [0.7, 0.4, 0.0], "yield loads": [0.9, 1.5, 2.1], "collapse load": 2.1}
PUBLISHED = {
    "bars yield one after another": (Truss(), TRUSS, 1e-15, 1e-15),
    "a box rests": (Box(), {"rotation": 0.0}, 0.0, 1e-15),
    "a box slides": (
        Box(height=0.5, push=6.0),
        {"friction force": -0.5 * 9.81, "speed": 0.01 * (6.0 - 0.5 * 9.81), "rotation": 0.0}, 1e-13, 1e-15,
    ),
    # It turns about its right corner, from a push of mass * gravity * width / (2 height) on.
    "a box tips": (
        Box(push=3.0),
        {"rotation": -0.01 * (3.0 * 2.0 - 9.81 * 0.5) / (5.0 / 12.0 + 1.25), "left force": 0.0}, 1e-12, 1e-15,
    ),
    "portfolio": (Portfolio(), {"weights": [0.748, 0.221, 0.031, 0.0]}, 0.0, 5e-4),
    "with a bridge": (Braess(), {"flows": [2.0, 2.0, 2.0], "time": 92.0}, 1e-14, 0.0),
    "without it": (Braess(bridge=False), {"flows": [3.0, 3.0], "time": 83.0}, 1e-14, 0.0),
    "cournot": (Cournot(), {"quantities": [30.0, 20.0, 10.0, 0.0], "price": 40.0}, 1e-14, 1e-13),
    "prisoners": (
        Game(rows=[[2, 0], [3, 1]], columns=[[2, 3], [0, 1]]),
        {"equilibria": np.array([[0.0, 1.0, 0.0, 1.0]])}, 0.0, 1e-15,
    ),
    "levels move by the weight over their length": (
        Denoising(samples=40, noise=0.0, weight=1.0), {"signal": np.repeat([0.1, 1.8, 1.2, 2.9], 10)}, 0.0, 1e-13
    ),
    "a bridge rectifies": (DiodeBridge(voltage=7.0), {"load voltage": 700.0 / 101.0}, 1e-13, 0.0),
    "either way": (DiodeBridge(voltage=-7.0), {"load voltage": 700.0 / 101.0}, 1e-13, 0.0),
    # With current all the time the mean of the output is duty * input, whatever the ripple.
    "current without a gap": (Converter(load=2.0, n=40), {"output": 6.0, "part without current": 0.0}, 1e-12, 0.0),
    "current with a gap": (Converter(capacity=1.0, n=120, load=36.0), {"output": 9.0}, 2e-4, 0.0),
    "saturated": (Regulator(), {"force": -1.0}, 0.0, 0.0),
    "phases": (FlashDrum(), {"bubble point": 92.1, "dew point": 98.8}, 0.0, 0.05),
    "liquid": (FlashDrum(temperature=80.0), {"vapour": 0.0}, 0.0, 1e-12),
    "vapour": (FlashDrum(temperature=110.0), {"vapour": 1.0}, 0.0, 1e-12),
    "hardening bars never collapse": (Truss(hardening=0.25), {"collapse load": np.inf}, 0.0, 0.0),
    "a string on the floor": (String(n=1000), {"contact from": np.sqrt(0.1)}, 0.0, 4e-7),
    "a string above it": (String(height=0.2), {"floor force": 0.0}, 0.0, 1e-12),
    "a membrane on a ball": (Membrane(n=1000), {"contact radius": 0.697965148223}, 0.0, 1e-6),
    "elastic torsion": (Torsion(twist=1.0, n=40), {"torque": 0.1406}, 0.0, 1e-4),
    "plastic torsion": (Torsion(twist=1e4, n=40), {"torque": 1.0 / 3.0}, 0.0, 3.3e-4),
    "Bratu under a lid, 10 points": (BratuLid(n=10), {"turning kink": 2.969647}, 0.0, 6e-7),
    "Bratu under a lid, 50 points": (BratuLid(n=50), {"turning kink": 2.974110}, 0.0, 6e-7),
}  # fmt: skip


@pytest.mark.parametrize(("scene", "expected", "relative", "absolute"), PUBLISHED.values(), ids=PUBLISHED)
def test_published_answers(scene, expected, relative, absolute):
    found = answered(scene)
    for key, value in expected.items():
        assert found[key] == pytest.approx(value, rel=relative, abs=absolute), key


CLOSED = {
    **{f"hardening bars at {load}": (Truss(hardening=0.25, load=load), 1e-13) for load in (0.5, 1.2, 1.9, 5.0)},
    **{f"{cars} cars": (Braess(cars=cars), 1e-13) for cars in (2.0, 5.0, 8.0, 12.0)},
    **{f"a rod on a smooth table at {spin}": (PainleveRod(friction=0.1, spin=spin), 1e-14) for spin in (3.0, 4.0)},
    "without noise": (Lasso(penalty=0.0), 1e-12),
    "two points": (SVM(samples=2), 1e-13),
    "until the first kink": (Regulator(distance=0.2), 1e-12),
    "one step ahead": (Regulator(horizon=1, distance=0.1), 1e-12),
}


@pytest.mark.parametrize(("scene", "accuracy"), CLOSED.values(), ids=CLOSED)
def test_closed_forms_at_other_parameters(scene, accuracy):
    assert error(answered(scene), scene.exact()) <= accuracy


@pytest.mark.parametrize(
    ("block", "x"),
    [
        (Block(), [0.0981, 0.0, 0.04905, 0.95095]),
        (Block(speed=0.03), [0.0981, 0.0, 0.03, 0.0]),
        (Block(speed=0.0, push=6.0), [0.0981, 0.0, 0.04905, 0.01095]),
        (Block(speed=-1.0), [0.0981, 0.04905, 0.0, 0.95095]),
        (Block(speed=0.1, friction=1.5), [0.0981, 0.0, 0.1, 0.0]),
        (Block(friction=0.0), [0.0981]),
    ],
    ids=["slides", "sticks", "pushed", "backwards", "rough", "smooth"],
)
def test_a_block_on_a_plane(block, x):
    assert solve(block).x == pytest.approx(x, abs=1e-15)


def test_painleves_rod_has_no_force_or_two():
    rod = PainleveRod()
    path = solve(rod)
    found = rod.answer(path)
    assert found["a"] == pytest.approx(-0.8480762114, abs=5e-11)
    (kink,) = path.kinks
    assert kink.name == "turning kink"
    assert np.abs(kink.u).max() == 0.0
    b = found["acceleration without force"]
    assert found["forces"] == pytest.approx([0.0, b / 0.8480762113533159], rel=1e-14)
    assert answered(PainleveRod(spin=3.0))["forces"].size == 0


def test_friction_against_the_motion_is_second_order_in_the_edges():
    name, off = "friction against motion", []
    for edges in (8, 16, 32):
        puck = Puck(edges=edges, heading=180.0 / edges)
        off.append(1.0 - answered(puck)[name] / puck.exact()[name])
    assert np.log2(np.divide(off[:2], off[1:])) == pytest.approx([2.0, 2.0], abs=0.02)


@pytest.mark.parametrize("boxes", [1, 4])
def test_a_pile_gains_no_energy_and_nothing_overlaps(boxes):
    pile = Pile(boxes=boxes, steps=60)
    fall = solve(pile)
    # Round-off of energies of some 80 J, and of places of some metres.
    assert np.diff(fall.energies).max() <= 1e-15 * fall.energies[0]
    assert fall.gaps.min() >= -1e-15 * boxes
    assert pile.answer(fall)["heights"] == pytest.approx(0.5 + np.arange(boxes), abs=1e-12)
    assert np.abs(fall.velocities[-1]).max() <= 1e-12


def test_bars_collapse():
    assert not solve(Truss()).success


def test_an_arch_snaps_onto_its_stop():
    path = solve(SnapThrough())
    assert [event.name for event in (*path.turning_points, *path.kinks)] == ["turning point", "turning kink"]
    assert answered(SnapThrough(stop=-0.9))["force on stop"] > 0.0


def test_portfolios_with_a_cap_and_on_the_critical_line():
    assert answered(Portfolio(cap=0.4))["weights"].max() == 0.4
    deviation = np.sqrt([0.04, 0.09, 0.16, 0.01])
    covariance = np.outer(deviation, deviation) * (0.3 + 0.7 * np.eye(4))
    line = critical_line(np.array([0.12, 0.10, 0.07, 0.03]), covariance)
    found = answered(Portfolio(tolerance=0.0, correlation=0.3))
    assert found["weights"] == pytest.approx(line.endpoint.y[:4], abs=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_nobody_finds_a_quicker_way_through_traffic(seed):
    found = answered(Traffic(side=6, seed=seed))
    assert found["time"] == pytest.approx(found["quickest way"], rel=1e-10)


def test_nothing_is_traded_at_a_loss():
    found = answered(SpatialPrices())
    costs = 2.0 * (1.0 + np.abs(np.subtract.outer(np.arange(3), np.arange(3))))
    gain = found["bids"][None] - found["offers"][:, None] - costs
    assert gain.max() <= 1e-12
    assert np.abs(gain[found["flows"] > 0.0]).max() <= 1e-12


def test_a_lasso_whose_correlations_tie():
    # Issue 2746 of scikit-learn.
    X, y = np.array([[0, 0, 0, -1, 0], [0, -1, 0, 0, 0.0]]), np.array([-2.5, -2.5])
    assert penalised(X.T @ X, X.T @ y)(t=0.002)[:-1] == pytest.approx([0.0, 2.498, 0.0, 2.498, 0.0], rel=1e-15)


def test_a_cloud():
    found = answered(SVM())
    X, side = clouds(60, 3.0, 0)
    margin = side * (X @ (X.T @ (found["weights"] * side)) + found["offset"])
    assert margin[found["weights"] == 0.0].min() >= 1.0 - 1e-9
    assert margin[found["weights"] == 1.0].max() <= 1.0 + 1e-9


def test_an_answer_of_a_vector_is_that_of_a_solution():
    assert Cournot().answer(SimpleNamespace(x=np.array([30.0, 20.0, 10.0, 0.0])))["price"] == 40.0
