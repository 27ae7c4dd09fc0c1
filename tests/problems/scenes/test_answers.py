"""Scenes without a mesh: published answers, closed forms, and what holds of any answer."""

from __future__ import annotations

import numpy as np
import pytest

from problems import lcp
from problems.scenes import Point, solve
from problems.scenes.braess import Braess
from problems.scenes.converter import Converter
from problems.scenes.cournot import Cournot
from problems.scenes.denoising import Denoising
from problems.scenes.diode_bridge import DiodeBridge
from problems.scenes.flash_drum import FlashDrum
from problems.scenes.game import Game
from problems.scenes.lasso import Lasso, penalised
from problems.scenes.pile import Pile
from problems.scenes.portfolio import Portfolio, critical_line
from problems.scenes.regulator import Regulator
from problems.scenes.snap_through import SnapThrough
from problems.scenes.spatial_prices import SpatialPrices
from problems.scenes.svm import SVM, clouds, kernel
from problems.scenes.traffic import Traffic
from problems.scenes.truss import Truss


def answered(scene):
    """The answer of a scene."""
    return scene.answer(solve(scene))


@pytest.mark.parametrize("boxes", [1, 4])
def test_a_pile_gains_no_energy_and_nothing_overlaps(boxes):
    pile = Pile(boxes=boxes, steps=60)
    fall = solve(pile)
    assert fall.success
    # Round-off of energies of some 80 J, and of places of some metres.
    assert np.diff(fall.energies).max() <= 1e-15 * fall.energies[0]
    assert fall.gaps.min() >= -1e-15 * boxes
    found = pile.answer(fall)
    assert found["heights"] == pytest.approx(0.5 + np.arange(boxes), abs=1e-12)
    assert np.abs(fall.velocities[-1]).max() <= 1e-12


def test_bars_yield_one_after_another_and_collapse():
    truss = Truss()
    path = solve(truss)
    found = truss.answer(path)
    assert lcp.solve(truss.problem()).x == pytest.approx([0.7, 0.4, 0.0], abs=1e-15)
    assert found["plastic elongations"] == pytest.approx([0.7, 0.4, 0.0], abs=1e-15)
    assert found["yield loads"] == pytest.approx([0.9, 1.5, 2.1], rel=1e-15)
    assert found["collapse load"] == pytest.approx(2.1, rel=1e-15)
    assert not path.success
    with pytest.raises(ArithmeticError, match=r"load: the bars bear 2.1 at most, found 2.2"):
        Truss(load=2.2).answer(solve(Truss(load=2.2)))


@pytest.mark.parametrize("load", [0.5, 1.2, 1.9, 5.0])
def test_hardening_bars_never_collapse(load):
    truss = Truss(hardening=0.25, load=load)
    found, exact = answered(truss), truss.exact()
    assert np.isinf(found["collapse load"])
    assert found["plastic elongations"] == pytest.approx(exact["plastic elongations"], abs=1e-13)
    assert found["yield loads"] == pytest.approx(exact["yield loads"], rel=1e-13)


def test_an_arch_snaps_onto_its_stop():
    scene = SnapThrough()
    assert [event.name for event in solve(scene).turning_points] == ["turning point"]
    assert [kink.name for kink in solve(scene).kinks] == ["turning kink"]
    assert answered(SnapThrough(stop=-0.9))["force on stop"] > 0.0


def test_portfolios():
    assert answered(Portfolio())["weights"] == pytest.approx([0.748, 0.221, 0.031, 0.0], abs=5e-4)
    capped = answered(Portfolio(cap=0.4))["weights"]
    assert capped.max() == 0.4
    assert capped.sum() == pytest.approx(1.0, rel=1e-15)
    deviation = np.sqrt([0.04, 0.09, 0.16, 0.01])
    covariance = np.outer(deviation, deviation) * (0.3 + 0.7 * np.eye(4))
    line = critical_line(np.array([0.12, 0.10, 0.07, 0.03]), covariance)
    assert line.success
    assert answered(Portfolio(tolerance=0.0, correlation=0.3))["weights"] == pytest.approx(
        line.endpoint.y[:4], abs=1e-13
    )


def test_braess():
    with_bridge, without = answered(Braess()), answered(Braess(bridge=False))
    assert with_bridge["flows"] == pytest.approx([2.0, 2.0, 2.0], rel=1e-14)
    assert with_bridge["time"] == pytest.approx(92.0, rel=1e-14)
    assert without["flows"] == pytest.approx([3.0, 3.0], rel=1e-14)
    assert without["time"] == pytest.approx(83.0, rel=1e-14)
    for cars in (2.0, 5.0, 8.0, 12.0):
        assert answered(Braess(cars=cars))["time"] == pytest.approx(Braess(cars=cars).exact()["time"], rel=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_nobody_finds_a_quicker_way_through_traffic(seed):
    found = answered(Traffic(side=6, seed=seed))
    assert found["time"] == pytest.approx(found["quickest way"], rel=1e-10)


def test_cournot():
    found = answered(Cournot())
    assert found["quantities"] == pytest.approx([30.0, 20.0, 10.0, 0.0], abs=1e-13)
    assert found["price"] == pytest.approx(40.0, rel=1e-14)
    capped = answered(Cournot(capacity=15.0))
    assert capped["quantities"].max() == 15.0


def test_nothing_is_traded_at_a_loss():
    scene = SpatialPrices()
    found = answered(scene)
    costs = 2.0 * (1.0 + np.abs(np.subtract.outer(np.arange(3), np.arange(3))))
    gain = found["bids"][None] - found["offers"][:, None] - costs
    assert gain.max() <= 1e-12
    assert np.abs(gain[found["flows"] > 0.0]).max() <= 1e-12


def test_all_equilibria_of_a_game():
    scene = Game()
    found = solve(scene)
    assert found.complete
    assert scene.answer(found)["equilibria"] == pytest.approx(scene.exact()["equilibria"], abs=1e-15)
    prisoners = Game(rows=[[2, 0], [3, 1]], columns=[[2, 3], [0, 1]])
    assert answered(prisoners)["equilibria"] == pytest.approx(np.array([[0.0, 1.0, 0.0, 1.0]]))


def test_a_lasso_whose_correlations_tie_and_one_without_noise():
    # Issue 2746 of scikit-learn.
    X, y = np.array([[0, 0, 0, -1, 0], [0, -1, 0, 0, 0.0]]), np.array([-2.5, -2.5])
    assert penalised(X.T @ X, X.T @ y)(t=0.002)[:-1] == pytest.approx([0.0, 2.498, 0.0, 2.498, 0.0], rel=1e-15)
    least = Lasso(penalty=0.0)
    assert answered(least)["coefficients"] == pytest.approx(least.exact()["coefficients"], abs=1e-12)


def test_the_diabetes_data_has_twelve_kinks():
    data = pytest.importorskip("sklearn.datasets").load_diabetes()
    X, y = data.data, data.target - data.target.mean()
    assert len(penalised(X.T @ X, X.T @ y).kinks) == 12


def test_two_points_and_a_cloud():
    assert answered(SVM(samples=2))["weights"] == pytest.approx(SVM(samples=2).exact()["weights"], rel=1e-13)
    scene = SVM(width=1.0)
    found = answered(scene)
    X, side = clouds(60, 3.0, 0)
    margin = side * (kernel(X, X, 1.0) @ (found["weights"] * side) + found["offset"])
    assert margin[found["weights"] == 0.0].min() >= 1.0 - 1e-9
    assert margin[found["weights"] == 1.0].max() <= 1.0 + 1e-9


def test_denoising_moves_levels_by_the_weight_over_their_length():
    found = answered(Denoising(samples=40, noise=0.0, weight=1.0))
    assert found["signal"] == pytest.approx(np.repeat([0.1, 1.8, 1.2, 2.9], 10), abs=1e-13)
    assert np.ptp(answered(Denoising(weight=1e6))["signal"]) <= 1e-9


def test_a_bridge_rectifies():
    for voltage in (-7.0, 7.0):
        found = answered(DiodeBridge(voltage=voltage))
        assert found["load voltage"] == pytest.approx(700.0 / 101.0, rel=1e-13)
    path = solve(DiodeBridge())
    assert [len(kink.switches) for kink in path.kinks] == [4]
    assert path.kinks[0].u == pytest.approx(np.zeros(5), abs=1e-15)


def test_a_converter_with_and_without_a_gap_in_its_current():
    # With current all the time the mean of the output is duty * input, whatever the ripple.
    full = answered(Converter(load=2.0, n=40))
    assert full["output"] == pytest.approx(6.0, rel=1e-12)
    assert full["part without current"] == 0.0
    gap = Converter(capacity=1.0, n=120, load=36.0)
    assert answered(gap)["output"] == pytest.approx(9.0, rel=2e-4)
    assert gap.exact()["output"] == pytest.approx(9.0, rel=1e-12)


def test_a_regulator_is_riccatis_until_its_first_kink_and_saturated_far_away():
    near = Regulator(distance=0.2)
    assert answered(near)["force"] == pytest.approx(near.exact()["force"], rel=1e-12)
    assert answered(near)["value"] == pytest.approx(near.exact()["value"], rel=1e-12)
    assert answered(Regulator())["force"] == -1.0
    # One step ahead, without a state behind it: a saturated linear law.
    for distance, force in ((0.1, None), (50.0, -1.0)):
        one = Regulator(horizon=1, distance=distance)
        expected = one.exact()["force"] if force is None else force
        assert answered(one)["force"] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("temperature", "vapour"), [(80.0, 0.0), (95.0, None), (110.0, 1.0)])
def test_phases_appear_and_vanish(temperature, vapour):
    scene = FlashDrum(temperature=temperature)
    found, exact = answered(scene), scene.exact()
    assert found["bubble point"] == pytest.approx(92.1, abs=0.05)
    assert found["dew point"] == pytest.approx(98.8, abs=0.05)
    assert found["vapour"] == pytest.approx(exact["vapour"] if vapour is None else vapour, abs=1e-12)
    assert found["benzene in vapour"] > found["benzene in liquid"]


def test_an_answer_of_a_vector_is_that_of_a_solution():
    scene = Cournot()
    assert scene.answer(Point(np.array([30.0, 20.0, 10.0, 0.0])))["price"] == 40.0
