"""Step controllers: pure functions of a state and an attempt."""

from math import inf

import pytest
from attrs import evolve

from continuation.controllers import AllgowerGeorg, Bounds, Fixed, StepMeasures
from continuation.rejection import Rejection

CONTROLLERS = [Fixed(), AllgowerGeorg()]
every_controller = pytest.mark.parametrize("controller", CONTROLLERS, ids=lambda c: type(c).__name__)

GOOD = StepMeasures(h=0.1, iterations=3, contraction=0.01, distance=1e-4, angle=0.05, order=3, rejections=0)
EASY = evolve(GOOD, angle=1e-9, distance=1e-12, contraction=1e-9, iterations=1)
FAILED = StepMeasures(h=0.1, order=3, rejections=0, rejection=Rejection.NOT_CONTRACTING)
PAPER = AllgowerGeorg(contraction=0.3, distance=0.1, angle=0.3, deceleration=1.5)


@every_controller
def test_a_state_is_a_tuple_of_floats_and_updates_are_pure(controller):
    state = controller.init()
    for attempt in (GOOD, FAILED, evolve(GOOD, rejections=1)):
        assert all(type(number) is float for number in state)
        assert controller.update(state, attempt) == controller.update(state, attempt)
        state = controller.update(state, attempt).state


@every_controller
def test_a_failure_shortens_the_step_down_to_the_floor(controller):
    state, h = controller.init(), controller.bounds.initial or 0.1
    for count in range(200):
        decision = controller.update(state, evolve(FAILED, h=h, rejections=count))
        assert not decision.accept
        assert 0.0 < decision.h < h
        state, h = decision.state, decision.h
        if h < controller.bounds.minimum:
            break
    assert h < controller.bounds.minimum


@every_controller
def test_a_good_step_is_accepted_a_sharp_turn_is_not_and_the_ceiling_holds(controller):
    assert controller.update(controller.init(), GOOD).accept
    bent = controller.update(controller.init(), evolve(GOOD, angle=1.2))
    assert not bent.accept
    assert bent.h < GOOD.h
    bounded = evolve(controller, bounds=Bounds(minimum=1e-6, initial=0.1, maximum=0.1))
    decision = bounded.update(bounded.init(), EASY)
    assert decision.accept
    assert decision.h <= 0.1


def test_the_papers_backtracking():
    controller = Fixed(Bounds(minimum=1e-6, initial=1.0), max_angle=inf, ratio=0.6)
    steps = [1.0]
    for l in range(3):
        steps.append(controller.update((), evolve(FAILED, h=steps[-1], rejections=l)).h)
    assert steps == pytest.approx([1.0, 0.6, 0.36, 0.216])
    # Success: l starts at 0 again, whatever the step was.
    assert controller.update((), evolve(GOOD, h=0.216)).h == 1.0
    assert controller.update((), evolve(GOOD, angle=3.0, distance=5.0)).accept


@pytest.mark.parametrize(
    ("controller", "attempt", "h"),
    [
        (Fixed(Bounds(initial=0.2)), evolve(FAILED, h=0.2), 0.1),
        (Fixed(Bounds(initial=0.2)), evolve(GOOD, rejections=1), 0.2),
        # By twice the deceleration at most.
        (AllgowerGeorg(deceleration=1.5), evolve(GOOD, angle=3.0), 0.1 / 3.0),
    ],
)
def test_lengths_of_the_next_step(controller, attempt, h):
    assert controller.update((), attempt).h == pytest.approx(h)


@pytest.mark.parametrize(
    ("change", "factor"),
    [
        # Angle over its goal: the step is divided by the ratio.
        ({"angle": 0.36}, 1.2),
        # Distance (relative to h) and contraction over theirs: by the root of order p + 1 = 4.
        ({"distance": 0.1 * 0.1 * 1.4}, 1.4**0.25),
        ({"contraction": 0.3 * 1.4}, 1.4**0.25),
        # The worst decides.
        ({"angle": 0.33, "contraction": 0.3 * 1.4}, 1.1),
        # A measure below its goal lengthens the step, but not by more than the acceleration.
        ({"angle": 0.2}, 0.2 / 0.3),
        ({}, 0.5),
    ],
)
def test_allgower_georg_divides_by_the_worst_factor(change, factor):
    decision = PAPER.update((), evolve(GOOD, **{"angle": 1e-6, "distance": 0.0, "contraction": 0.0, **change}))
    assert decision.accept
    assert decision.h == pytest.approx(GOOD.h / factor)
