"""Diagrams that were interrupted or killed: what was finished is kept, and not traced again."""

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

from ...util import interrupt
from .util import CROSSED, Forks

BOX = {"lam": (0.0, 5.0)}


@define(eq=False)
class Stopping(Forks):
    """Three pitchforks, and something that happens at the n-th residual."""

    places: tuple[float, ...] = (1.0, 2.0, 3.0)
    at: float = np.inf
    deed: object = None
    calls: int = 0

    def residual(self, y, lam):
        self.calls += 1
        if self.calls == self.at:
            self.deed()
        return super().residual(y, lam)


def outline(found):
    """What is the same wherever a diagram was taken up; which of two ends of a branch comes first is no matter."""
    ends = {tuple(np.round(u, 6) + 0.0) for path in found.paths for u in path.u[[0, -1]]}
    points = [(p.label, p.branches, round(p.event.lam, 6) + 0.0) for p in found.points]
    return found.complete, found.message, [(b.origin, b.generation) for b in found.branches], points, ends


@pytest.fixture(scope="module")
def whole():
    homotopy = Stopping()
    return diagram(homotopy, box=BOX), homotopy.calls


@pytest.mark.parametrize(("share", "keep"), [(0.4, "all"), (0.7, "ends")])
def test_ctrl_c_gives_what_was_found_and_the_diagram_goes_on(tmp_path, whole, share, keep):
    (found, calls), file, again = whole, tmp_path / "d.h5", Stopping()
    with pytest.raises(Interrupted) as stopped:
        diagram(Stopping(at=int(share * calls), deed=interrupt), box=BOX, archive=file, keep=keep)
    part = stopped.value.diagram
    assert not part.complete
    assert "interrupted" in part.message
    assert pickle.loads(pickle.dumps(stopped.value)).diagram.message == part.message
    with open_archive(file) as archive:
        assert len(part) - 1 <= len(archive) <= len(part)
        for stored, path in zip(archive, part.paths):
            np.testing.assert_array_equal(stored.u, path.u)
        points = sum(path.u.shape[0] for path in archive)
    assert outline(diagram(again, box=BOX, archive=file, resume=True, keep=keep)) == outline(found)
    # What is kept is not traced again; what was under way is, and kernels of BLAS differ in its share.
    assert again.calls < (1.1 - 0.8 * points / sum(len(path.steps) for path in found.paths)) * calls


CHILD = """
from tests.continuation.diagrams.test_resumed import BOX, Stopping
import os, signal, sys
from continuation import diagram
kill = lambda: os.kill(os.getpid(), signal.SIGKILL)
diagram(Stopping(at=int(sys.argv[2]), deed=kill), box=BOX, archive=sys.argv[1])
"""


def test_a_killed_diagram_leaves_its_branches_and_goes_on(tmp_path, whole):
    (found, calls), file, again, third = whole, tmp_path / "d.h5", Stopping(), Stopping()
    child = subprocess.run([sys.executable, "-c", CHILD, str(file), str(int(0.6 * calls))], check=False)
    assert child.returncode == -signal.SIGKILL
    with open_archive(file) as archive:
        assert not archive.closed_by_writer
        assert 3 <= len(archive) < len(found)
    assert outline(diagram(again, box=BOX, archive=file, resume=True)) == outline(found)
    assert again.calls < 0.6 * calls
    # What is finished is finished: a third time nothing is traced.
    assert outline(diagram(third, box=BOX, archive=file, resume=True)) == outline(found)
    assert third.calls < 0.2 * calls


def test_threads_are_interrupted_and_go_on_too(tmp_path, whole):
    options = {"box": BOX, "archive": tmp_path / "d.h5"}
    with ThreadPoolExecutor(2) as workers:
        with pytest.raises(Interrupted):
            diagram(Stopping(at=int(0.5 * whole[1]), deed=interrupt), executor=workers, **options)
        again = diagram(Stopping(), executor=workers, resume=True, **options)
    assert outline(again) == outline(whole[0])


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
    assert outline(again) == outline(first)
    assert first.complete == ("budget" not in options)


@pytest.mark.parametrize(
    ("homotopy", "resume", "error", "words"),
    [
        (Forks((1.0, 2.0)), None, ValueError, "resume: expected True with an archive"),
        (Forks((1.0, 2.0)), False, ArchiveError, r"d\.h5"),
        (Forks((1.0,)), True, ValueError, "homotopy: expected 2 unknowns, as in the archive, found 1"),
        (Forks((1.0, 3.0)), True, ValueError, "homotopy: expected the archive's residual"),
    ],
)
def test_another_diagram_is_not_gone_on_with(tmp_path, homotopy, resume, error, words):
    diagram(Forks((1.0, 2.0)), box=BOX, archive=tmp_path / "d.h5")
    with pytest.raises(error, match=words):
        diagram(homotopy, box=BOX, archive=None if resume is None else tmp_path / "d.h5", resume=resume is not False)
    with open_archive(tmp_path / "d.h5") as archive:
        assert len(archive) == 5
