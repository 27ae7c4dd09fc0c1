"""Writers that die within a commit: what was committed is there, and is exactly the path.

Kills at random moments are a campaign of `tests/reliability`.
"""

from itertools import count

import h5py
import numpy as np
import pytest

from continuation import Budget, Status, Tracer, trace
from continuation.archive import open_archive, recover, resume
from continuation.archive.store import Store
from problems.bifurcation import FreudensteinRoth

from .util import assert_same, logged, read


class Death(BaseException):
    """As far as the file is concerned, the writer is gone."""


@pytest.fixture
def dying(monkeypatch):
    """A call whose writer dies after so many flushes, in the first or the second phase of a commit."""

    def call(flushes, work):
        calls = []

        def flush(store):
            calls.append(store)
            if len(calls) > flushes:
                raise Death
            store._h5.flush()

        with monkeypatch.context() as patch:
            patch.setattr(Store, "_flush", flush)
            with pytest.raises(Death):
                work()
        calls[-1].close()

    return call


@pytest.mark.parametrize("flushes", range(13))
def test_death_between_the_phases(tmp_path, dying, flushes):
    """Whichever phase of whichever commit is the last: rows, checkpoint and counters agree."""
    path, file = trace(FreudensteinRoth()), tmp_path / "run.h5"
    dying(flushes, lambda: list(Tracer(FreudensteinRoth(), observers=(logged(file, 3),))))
    with open_archive(file) as archive:
        # Of each commit the first flush is what counts, since the counters follow it.
        commits = (flushes + 1) // 2
        assert 3 * commits <= archive.points.size <= 5 * commits
        if len(archive):
            found, checkpoint = archive.path(0), archive.checkpoint()
            assert np.array_equal(found.u, path.u[: len(found)])
            assert checkpoint.rows <= archive.points.size
            assert np.array_equal(checkpoint.state.here.u, path.u[checkpoint.state.index])
    if flushes:
        assert np.array_equal(resume(file).u, path.u)


@pytest.mark.parametrize("rows", [3, 4, 5, 6])
@pytest.mark.parametrize("recovered", [False, True])
def test_death_in_the_first_commits_of_a_resumed_path(tmp_path, dying, rows, recovered):
    """The checkpoint that the file was resumed from is not what the first new one is written over."""
    path, file = trace(FreudensteinRoth()), tmp_path / "run.h5"
    trace(FreudensteinRoth(), archive=logged(file, rows), budget=Budget(steps=12))
    for _ in range(3):
        # Two flushes make the copy; the third would end the first phase of the commit that ends the path.
        dying(2, lambda: resume(file, budget=Budget()))
        if recovered:
            recover(file)
    assert_same(resume(file, budget=Budget()), path)


def test_a_torn_checkpoint_gives_way_to_the_one_before(tmp_path):
    file = tmp_path / "run.h5"
    trace(FreudensteinRoth(), archive=logged(file, 4), budget=Budget(steps=13))
    with open_archive(file) as archive:
        latest = archive.checkpoint().sequence
    with h5py.File(file, "r+", libver="latest") as opened:
        opened["resume/slots"][latest % 2, 60] ^= 1
    with open_archive(file) as archive:
        assert archive.checkpoint().sequence == latest - 1
    assert np.array_equal(resume(file, budget=Budget()).u, trace(FreudensteinRoth()).u)


def test_keyboard_interrupt_within_a_commit_repeats_it(tmp_path, monkeypatch):
    """Ctrl-C between the phases: the commit at the end of the path writes the same rows again, once."""
    path, flush, calls = trace(FreudensteinRoth()), Store._flush, count(1)

    def interrupted(self):
        flush(self)
        if next(calls) == 6:
            raise KeyboardInterrupt

    monkeypatch.setattr(Store, "_flush", interrupted)
    with pytest.raises(KeyboardInterrupt) as interrupt:
        trace(FreudensteinRoth(), archive=logged(tmp_path / "run.h5", 4))
    found = interrupt.value.path
    assert found.status is Status.INTERRUPTED
    assert np.array_equal(read(tmp_path / "run.h5").u, found.u)
    assert np.array_equal(resume(tmp_path / "run.h5").u, path.u)
