"""Diagrams that were interrupted or killed: what was finished is kept, and not traced again."""

import os
import pickle
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from attrs import define

from continuation import Budget, Interrupted, Stability, diagram
from continuation.archive import ArchiveError, open_archive
from problems.bifurcation import Pitchfork

from .util import CROSSED, Forks

BOX = {"lam": (0.0, 5.0)}


@define(eq=False)
class Stopping:
    """Three pitchforks, and something that happens at the n-th residual."""

    at: float = np.inf
    deed: object = None
    calls: int = 0

    def start(self):
        return np.zeros(3), 0.5

    def residual(self, y, lam):
        self.calls += 1
        if self.calls == self.at:
            self.deed()
        return Forks((1.0, 2.0, 3.0)).residual(y, lam)

    def jacobian(self, y, lam):
        return Forks((1.0, 2.0, 3.0)).jacobian(y, lam)


def interrupt():
    raise KeyboardInterrupt


def kill():
    os.kill(os.getpid(), signal.SIGKILL)


def ends(found):
    """Where branches end, as a set: which of two ends comes first is no matter."""
    return {tuple(np.round(u, 6) + 0.0) for path in found.paths for u in path.u[[0, -1]]}


def same(found, whole):
    assert (found.complete, found.message) == (whole.complete, whole.message)
    assert [(b.origin, b.generation) for b in found.branches] == [(b.origin, b.generation) for b in whole.branches]
    assert [(p.label, p.branches) for p in found.points] == [(p.label, p.branches) for p in whole.points]
    assert [p.event.lam for p in found.points] == pytest.approx([p.event.lam for p in whole.points], abs=1e-9)
    assert ends(found) == ends(whole)


@pytest.fixture(scope="module")
def whole():
    homotopy = Stopping()
    return diagram(homotopy, box=BOX), homotopy.calls


@pytest.mark.parametrize(("share", "keep"), [(0.15, "all"), (0.7, "all"), (0.7, "ends")])
def test_ctrl_c_gives_what_was_found_and_the_diagram_goes_on(tmp_path, whole, share, keep):
    found, calls = whole
    file = tmp_path / "d.h5"
    with pytest.raises(Interrupted) as stopped:
        diagram(Stopping(int(share * calls), interrupt), box=BOX, archive=file, keep=keep)
    part = stopped.value.diagram
    assert not part.complete
    assert "interrupted" in part.message
    assert pickle.loads(pickle.dumps(stopped.value)).diagram.message == part.message
    kept = points = 0
    if file.exists():
        with open_archive(file) as archive:
            kept = len(archive)
            points = sum(path.u.shape[0] for path in archive)
            for stored, path in zip(archive, part.paths):
                np.testing.assert_array_equal(stored.u, path.u)
    assert len(part) - 1 <= kept <= len(part)
    again = Stopping()
    same(diagram(again, box=BOX, archive=file, resume=True, keep=keep), found)
    # What is kept is not traced again; what was under way is, and kernels of BLAS differ in its share.
    assert again.calls < (1.1 - 0.8 * points / sum(len(path.steps) for path in found.paths)) * calls
    with open_archive(file) as archive:
        assert len(archive) == len(found)


CHILD = """
from tests.continuation.diagrams.test_resumed import BOX, Stopping, kill
import sys
from continuation import diagram
diagram(Stopping(int(sys.argv[2]), kill), box=BOX, archive=sys.argv[1])
"""


def test_a_killed_diagram_leaves_its_branches_and_goes_on(tmp_path, whole):
    found, calls = whole
    file = tmp_path / "d.h5"
    child = subprocess.run([sys.executable, "-c", CHILD, str(file), str(int(0.6 * calls))], check=False)
    assert child.returncode == -signal.SIGKILL
    with open_archive(file) as archive:
        assert not archive.closed_by_writer
        kept = len(archive)
        assert 3 <= kept < len(found)
    again = Stopping()
    same(diagram(again, box=BOX, archive=file, resume=True), found)
    assert again.calls < 0.6 * calls
    # What is finished is finished: a third time nothing is traced.
    third = Stopping()
    assert diagram(third, box=BOX, archive=file, resume=True).complete
    assert third.calls < 0.2 * calls


def test_threads_are_interrupted_and_go_on_too(tmp_path, whole):
    found, calls = whole
    file = tmp_path / "d.h5"
    with ThreadPoolExecutor(2) as workers:
        with pytest.raises(Interrupted):
            diagram(Stopping(int(0.5 * calls), interrupt), box=BOX, archive=file, executor=workers)
        same(diagram(Stopping(), box=BOX, archive=file, executor=workers, resume=True), found)


@pytest.mark.parametrize(
    ("homotopy", "options"),
    [
        (CROSSED, {"box": {"lam": (-2.0, 2.0)}}),
        (
            Pitchfork(imperfection=0.01),
            {"box": {"lam": (-2.0, 2.0)}, "deflate": [1.0], "stability": Stability()},
        ),
        (Forks((1.0, 2.0)), {"box": BOX, "budget": Budget(steps=6)}),
    ],
    ids=["kinks", "what deflation found", "what ended early"],
)
def test_a_diagram_that_was_finished_is_the_same_again(tmp_path, homotopy, options):
    first, again = (diagram(homotopy, archive=tmp_path / "d.h5", resume=k, **options) for k in (False, True))
    same(again, first)
    assert first.complete == ("budget" not in options)


@pytest.mark.parametrize(
    ("homotopy", "resume", "error", "words"),
    [
        (Forks((1.0, 2.0)), False, ArchiveError, r"d\.h5"),
        (Forks((1.0,)), True, ValueError, "homotopy: expected 2 unknowns, as in the archive, found 1"),
        (Forks((1.0, 3.0)), True, ValueError, "homotopy: expected the archive's residual"),
    ],
)
def test_another_diagram_is_not_gone_on_with(tmp_path, homotopy, resume, error, words):
    diagram(Forks((1.0, 2.0)), box=BOX, archive=tmp_path / "d.h5")
    with pytest.raises(error, match=words):
        diagram(homotopy, box=BOX, archive=tmp_path / "d.h5", resume=resume)
    with open_archive(tmp_path / "d.h5") as archive:
        assert len(archive) == 5


def test_resuming_needs_an_archive():
    with pytest.raises(ValueError, match="resume: expected True with an archive"):
        diagram(Forks((1.0, 2.0)), box=BOX, resume=True)
