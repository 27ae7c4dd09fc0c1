"""Paths that stay in their archive: the same steps, read when they are asked for."""

import gc
import tracemalloc
import weakref

import numpy as np
import pytest

from continuation import Budget, Kind, Tracer, trace
from continuation.archive import ArchiveError, PathLog, resume
from continuation.controllers import Bounds, Fixed
from problems.bifurcation import ExponentialCosine, FreudensteinRoth

from .util import assert_same, logged, read

OPTIONS = {"controller": Fixed(bounds=Bounds(initial=0.05))}
HOMOTOPY = ExponentialCosine(3)


@pytest.mark.parametrize("keep", ["ends", "all"])
@pytest.mark.parametrize("problem", [FreudensteinRoth(), HOMOTOPY], ids=["events", "many steps"])
def test_what_is_not_in_memory_is_read(tmp_path, keep, problem):
    path = trace(problem, **OPTIONS)
    found = trace(problem, archive=logged(tmp_path / "run.h5", 10, keep=keep), **OPTIONS)
    assert_same(found, path)
    assert np.array_equal(found.steps[-3].u, path.steps[-3].u)
    assert [step.index for step in found.steps[9:2:-3]] == [9, 6, 3]
    for stored in (read(tmp_path / "run.h5"), read(tmp_path / "run.h5", keep="ends")):
        assert_same(stored, path)


def test_it_can_be_read_while_it_grows(tmp_path):
    tracer, seen = Tracer(HOMOTOPY, observers=(logged(tmp_path / "run.h5", 4, keep="ends"),), **OPTIONS), []
    for step in tracer:
        seen.append(step.u)
        if step.index % 9 == 5:
            assert np.array_equal(tracer.path.u, seen)


@pytest.mark.parametrize("keep", ["ends", "all"])
def test_resume_from_it(tmp_path, keep):
    path = trace(FreudensteinRoth(), **OPTIONS)
    log = logged(tmp_path / "run.h5", 3, keep="ends")
    trace(FreudensteinRoth(), archive=log, budget=Budget(steps=len(path) // 2), **OPTIONS)
    found = resume(tmp_path / "run.h5", budget=Budget(), keep=keep)
    assert isinstance(found.steps, list) == (keep == "all")
    assert_same(found, path)
    if keep == "ends":
        middle = path.arclength[7:9].mean()
        assert np.array_equal(found(middle), read(tmp_path / "run.h5")(middle))


def test_memory_does_not_grow_with_the_path(tmp_path):
    """Of Python's own, which is counted exactly: a list of steps takes more than a kilobyte a step.

    The block of rows that is being filled is held, so the first look comes when one has been full.
    """
    options = {"controller": Fixed(bounds=Bounds(initial=0.005))}
    log = logged(tmp_path / "run.h5", 256, keep="ends")
    used = []
    tracer = Tracer(HOMOTOPY, observers=(log,), **options)
    tracemalloc.start()
    try:
        for step in tracer:
            if step.index in (300, 700):
                log._commit()
                # h5py's objects form cycles, and its table of them, of 18 kB, is made anew now and then: when, depends
                # on every allocation before.
                gc.collect()
                traces = tracemalloc.take_snapshot().filter_traces([tracemalloc.Filter(False, weakref.__file__)])
                used.append(sum(trace.size for trace in traces.traces))
    finally:
        tracemalloc.stop()
    assert len(used) == 2
    assert used[1] - used[0] < 200 * 100


def test_every_fifth_step_is_saved_with_the_ends_and_the_events(tmp_path):
    path = trace(HOMOTOPY, archive=tmp_path / "run.h5", save_every=5)
    saved = read(tmp_path / "run.h5")
    expected = [step.u for step in path.steps if step.index % 5 == 0 or step.kind != Kind.REGULAR]
    np.testing.assert_array_equal(saved.u, expected)
    assert [event.lam for event in saved.events] == [event.lam for event in path.events]
    np.testing.assert_array_equal(saved.u[-1], path.u[-1])


def test_what_was_thinned_out_is_resumed_as_if_it_had_never_stopped(tmp_path):
    whole = trace(HOMOTOPY)
    trace(HOMOTOPY, archive=tmp_path / "run.h5", save_every=4, budget=Budget(steps=17))
    assert len(read(tmp_path / "run.h5")) == 6
    found = resume(tmp_path / "run.h5", budget=Budget())
    assert found.status is whole.status
    np.testing.assert_array_equal(found.u[-1], whole.u[-1])
    # From the last saved step but one on, which is where a resumed trace begins.
    np.testing.assert_array_equal(found.u[:3], whole.u[:12:4])
    np.testing.assert_array_equal(found.u[3:], whole.u[12:])
    assert [event.lam for event in found.events] == [event.lam for event in whole.events]


def test_an_archive_that_is_gone_says_so(tmp_path):
    found = trace(HOMOTOPY, archive=PathLog(tmp_path / "run.h5", keep="ends"), **OPTIONS)
    (tmp_path / "run.h5").unlink()
    assert found.endpoint.index == len(found) - 1
    with pytest.raises(ArchiveError, match="No such file"):
        _ = found.u
