"""Contact with friction: published answers, and what physics says of every step."""

from __future__ import annotations

import numpy as np
import pytest

from problems.scenes import solve
from problems.scenes.block import Block
from problems.scenes.box import Box
from problems.scenes.painleve_rod import PainleveRod
from problems.scenes.puck import Puck


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
    a, b = found["a"], found["acceleration without force"]
    assert a == pytest.approx(-0.8480762114, abs=5e-11)
    (kink,) = path.kinks
    assert kink.name == "turning kink"
    assert np.abs(kink.u).max() == 0.0
    x, t = path.endpoint.u
    assert x == pytest.approx(-t / a, rel=1e-15)
    assert found["forces"] == pytest.approx([0.0, b / 0.8480762113533159], rel=1e-14)
    slow = PainleveRod(spin=3.0)
    found = slow.answer(solve(slow))
    assert found["acceleration without force"] < 0.0
    assert found["forces"].size == 0


def test_a_rod_on_a_smooth_table_has_one_force():
    for spin, forces in ((3.0, 1), (4.0, 1)):
        rod = PainleveRod(friction=0.1, spin=spin)
        assert rod.answer(solve(rod))["forces"] == pytest.approx(rod.exact()["forces"], rel=1e-14)
        assert rod.answer(solve(rod))["forces"].size == forces


def test_a_box_rests_slides_and_tips():
    rests, slides, tips = Box(), Box(height=0.5, push=6.0), Box(push=3.0)
    assert rests.answer(solve(rests))["rotation"] == pytest.approx(0.0, abs=1e-15)
    found = slides.answer(solve(slides))
    assert found["friction force"] == pytest.approx(-0.5 * 9.81, rel=1e-13)
    assert found["speed"] == pytest.approx(0.01 * (6.0 - 0.5 * 9.81), rel=1e-12)
    assert found["rotation"] == pytest.approx(0.0, abs=1e-15)
    # It turns about its right corner, from a push of mass * gravity * width / (2 height) on.
    found = tips.answer(solve(tips))
    inertia = 5.0 / 12.0 + 1.25
    assert found["rotation"] == pytest.approx(-0.01 * (3.0 * 2.0 - 9.81 * 0.5) / inertia, rel=1e-12)
    assert found["left force"] == pytest.approx(0.0, abs=1e-12)


def test_friction_against_the_motion_is_second_order_in_the_edges():
    off = []
    for edges in (8, 16, 32):
        puck = Puck(edges=edges, heading=180.0 / edges)
        name = "friction against motion"
        off.append(1.0 - puck.answer(solve(puck))[name] / puck.exact()[name])
    assert np.log2(off[0] / off[1]) == pytest.approx(2.0, abs=0.02)
    assert np.log2(off[1] / off[2]) == pytest.approx(2.0, abs=0.01)
