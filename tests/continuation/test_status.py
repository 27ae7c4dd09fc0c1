"""Statuses and kinds: what counts as success, and what a reader sees of them."""

import pickle

import numpy as np
import pytest

from continuation import Kind, Path, Status, trace
from continuation.path import Step
from problems.bifurcation import Circle, Cusp


def test_a_status_is_true_exactly_where_the_path_came_to_an_end_that_was_asked_for():
    assert {status for status in Status if status} == {Status.REACHED_TARGET, Status.STOPPED_AT_EVENT, Status.CLOSED}
    assert all(bool(status) == status.success == Path(status=status).success for status in Status)


def test_a_path_says_whether_it_arrived():
    assert trace(Circle()).success
    assert not trace(Cusp(), target=float(np.pi) * 1e9, direction=-1).success


def test_numbers_are_those_of_the_archives():
    assert [int(status) for status in Status] == list(range(17))
    assert [int(kind) for kind in Kind] == list(range(9))
    assert [kind.flag for kind in Kind] == [
        "regular", "start", "target", "turning_point", "branch_point", "event", "kink", "singular_point",
        "hopf",
    ]  # fmt: skip


def test_a_kind_shows_its_name_and_stays_a_number():
    assert repr(Kind.TARGET) == "Kind.TARGET"
    assert Kind.TARGET == 2
    assert pickle.loads(pickle.dumps(Kind.TARGET)) is Kind.TARGET
    path = trace(Cusp())
    assert [type(step.kind) for step in path.steps] == [Kind] * len(path)
    assert {repr(event.kind) for event in path.events} == {"Kind.TURNING_POINT"}


def test_a_stored_number_becomes_its_kind():
    assert Step(0, np.zeros(2), np.ones(2), 0.0, kind=3).kind is Kind.TURNING_POINT
    with pytest.raises(ValueError, match="17 is not a valid Kind"):
        Step(0, np.zeros(2), np.ones(2), 0.0, kind=17)
