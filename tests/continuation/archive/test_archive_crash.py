"""Writers that die within a commit: what was committed is there, and is exactly the path.

Kills at random moments are in `test_archive_campaigns.py`.
"""

import numpy as np
import pytest

from continuation import Budget, Status, Tracer, trace
from continuation.archive import ArchiveError, Limits, PathLog, open_archive, recover, resume
from continuation.archive.store import Store
from problems.bifurcation import FreudensteinRoth


class Death(BaseException):
    """As far as the file is concerned, the writer is gone."""


def dying(monkeypatch, flushes):
    """Let the writer die after so many flushes, in the first or the second phase of a commit."""
    left, stores = [flushes], []

    def flush(self):
        stores.append(self)
        if not left[0]:
            raise Death
        left[0] -= 1
        self._h5.flush()

    monkeypatch.setattr(Store, "_flush", flush)
    return stores


def leave(log, steps=None):
    """Give the file up as it is, without a commit."""
    log._store.close()
    log._closed = True
    log.end = lambda tracer: None
    if steps is not None:
        steps.close()


@pytest.mark.parametrize("flushes", range(2, 15))
def test_death_between_the_phases(tmp_path, monkeypatch, flushes):
    """Whichever phase of whichever commit is the last: rows, checkpoint and counters agree."""
    path = trace(FreudensteinRoth())
    with monkeypatch.context() as patch:
        dying(patch, flushes)
        log = PathLog(tmp_path / "run.h5", limits=Limits(rows=3, seconds=3600.0))
        with pytest.raises(Death):
            for _ in Tracer(FreudensteinRoth(), observers=(log,)):
                pass
    leave(log)
    with open_archive(tmp_path / "run.h5") as archive:
        # Two flushes make the file; of each later commit the first one is what counts, since the counters follow it.
        commits = (flushes - 1) // 2
        assert 3 * commits <= archive.points.size <= 5 * commits
        if len(archive):
            found = archive.path(0)
            assert np.array_equal(found.u, path.u[: len(found)])
            checkpoint = archive.checkpoint()
            assert checkpoint.rows <= archive.points.size
            assert np.array_equal(checkpoint.state.here.u, path.u[checkpoint.state.index])
    if flushes > 2:
        assert np.array_equal(resume(tmp_path / "run.h5").u, path.u)


@pytest.mark.parametrize("rows", [3, 4, 5, 6])
@pytest.mark.parametrize("recovered", [False, True])
def test_death_in_the_first_commits_of_a_resumed_path(tmp_path, monkeypatch, rows, recovered):
    """The checkpoint that the file was resumed from is not what the first new one is written over."""
    path, file = trace(FreudensteinRoth()), tmp_path / "run.h5"
    trace(FreudensteinRoth(), archive=PathLog(file, limits=Limits(rows=rows, seconds=3600.0)), budget=Budget(steps=12))
    for _ in range(3):
        with monkeypatch.context() as patch:
            # Four flushes make the copy; the fifth would end the first phase of the commit that ends the path.
            stores = dying(patch, 4)
            with pytest.raises(Death):
                resume(file, budget=Budget())
        stores[-1].close()
        if recovered:
            recover(file)
    found = resume(file, budget=Budget())
    assert np.array_equal(found.u, path.u)
    assert found.counts == path.counts


def test_a_torn_checkpoint_gives_way_to_the_one_before(tmp_path):
    log = PathLog(tmp_path / "run.h5", limits=Limits(rows=4, seconds=3600.0))
    steps = iter(Tracer(FreudensteinRoth(), observers=(log,)))
    assert any(step.index == 13 for step in steps)
    with open_archive(tmp_path / "run.h5") as archive:
        latest = archive.checkpoint()
    slots = log._store._h5["resume/slots"]
    slots[latest.sequence % 2, 60] ^= 1
    leave(log, steps)
    with open_archive(tmp_path / "run.h5") as archive:
        assert archive.checkpoint().sequence == latest.sequence - 1
    assert np.array_equal(resume(tmp_path / "run.h5").u, trace(FreudensteinRoth()).u)


def test_a_file_that_was_closed_stays_as_it_is(tmp_path):
    trace(FreudensteinRoth(), archive=tmp_path / "run.h5")
    before = (tmp_path / "run.h5").read_bytes()
    recover(tmp_path / "run.h5")
    assert (tmp_path / "run.h5").read_bytes() == before


def test_recovery_by_force_keeps_what_was_committed(tmp_path):
    log = PathLog(tmp_path / "run.h5", limits=Limits(rows=2, seconds=3600.0))
    steps = iter(Tracer(FreudensteinRoth(), observers=(log,)))
    for _ in range(5):
        next(steps)
    recover(tmp_path / "run.h5", force=True)
    with open_archive(tmp_path / "run.h5") as archive:
        assert len(archive.path(0)) == 4
        assert archive.path(0).message.endswith("Its writer was killed.")
        assert "recovered" in archive.attributes["history"]
    steps.close()


def test_keyboard_interrupt_within_a_commit_repeats_it(tmp_path, monkeypatch):
    """Ctrl-C between the phases: the commit at the end of the path writes the same rows again, once."""
    path, flush, calls = trace(FreudensteinRoth()), Store._flush, []

    def interrupted(self):
        flush(self)
        calls.append(1)
        if len(calls) == 6:
            raise KeyboardInterrupt

    monkeypatch.setattr(Store, "_flush", interrupted)
    with pytest.raises(KeyboardInterrupt) as interrupt:
        trace(FreudensteinRoth(), archive=PathLog(tmp_path / "run.h5", limits=Limits(rows=4, seconds=3600.0)))
    found = interrupt.value.path
    assert found.status is Status.INTERRUPTED
    with open_archive(tmp_path / "run.h5") as archive:
        assert np.array_equal(archive.path(0).u, found.u)
    assert np.array_equal(resume(tmp_path / "run.h5").u, path.u)


def test_a_full_disk_is_one_clear_line(tmp_path, monkeypatch):
    put = Store._put

    def full(dataset, start, values):
        if start >= 6:
            raise OSError("Can't write data (file write failed: errno = 28, 'No space left on device')\nmore")
        put(dataset, start, values)

    monkeypatch.setattr(Store, "_put", staticmethod(full))
    with pytest.raises(ArchiveError, match=r"run.h5: could not be written \(.*No space left.*; what was committed is"):
        trace(FreudensteinRoth(), archive=PathLog(tmp_path / "run.h5", limits=Limits(rows=6, seconds=3600.0)))
    monkeypatch.undo()
    with open_archive(tmp_path / "run.h5") as archive:
        assert archive.points.size == 6
