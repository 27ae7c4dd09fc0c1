"""Statuses and kinds: what counts as success, and what a reader sees of them."""

import pickle

import numpy as np
import pytest

from continuation import Kind, Path, Status, trace
from continuation.path import Step
from problems.bifurcation import Cusp


def test_a_status_is_true_exactly_where_the_path_came_to_an_end_that_was_asked_for():
    assert {status for status in Status if status} == {Status.REACHED_TARGET, Status.STOPPED_AT_EVENT, Status.CLOSED}
    assert all(bool(status) == status.success == Path(status=status).success for status in Status)


def test_a_kind_shows_its_name_and_is_made_of_a_stored_number():
    path = trace(Cusp())
    assert {repr(step.kind) for step in path.steps} == {"Kind.REGULAR", "Kind.START", "Kind.TARGET"}
    assert pickle.loads(pickle.dumps(Kind.TARGET)) is Kind.TARGET
    assert Step(0, np.zeros(2), np.ones(2), 0.0, kind=3).kind is Kind.TURNING_POINT
    with pytest.raises(ValueError, match="17 is not a valid Kind"):
        Step(0, np.zeros(2), np.ones(2), 0.0, kind=17)
