"""Progress on stderr: lines, or a bar of tqdm on a terminal."""

import io
import sys

import pytest

import continuation
from continuation.step import progress
from continuation.step.progress import Progress

from ..util import Terminal

FOLD = continuation.from_functions(lambda y, lam: y**2 + lam - 1.0, start=([-1.0], 0.0), target=-0.5)
NOWHERE = continuation.from_functions(lambda y, lam: y**2 + 1.0, start=([1.0], 0.0))


def shown(homotopy, stream):
    path = continuation.trace(homotopy, direction=1, target=homotopy.target, observers=(Progress(stream, "one"),))
    return path, stream.getvalue()


@pytest.mark.parametrize("tqdm", [True, False])
@pytest.mark.parametrize("stream", [io.StringIO, Terminal])
def test_a_short_trace_shows_its_end(monkeypatch, stream, tqdm):
    if tqdm:
        pytest.importorskip("tqdm")
    else:
        monkeypatch.setitem(sys.modules, "tqdm", None)
    path, text = shown(FOLD, stream())
    end = f"one: {path.endpoint.index} steps, lam = {path.endpoint.lam:.4g}, {path.status.name} in "
    assert text.splitlines()[-1].rpartition("\r")[2].startswith(end)
    assert text.endswith(" s\n")


def test_of_a_path_without_points_none_is_shown():
    assert shown(NOWHERE, io.StringIO())[1].startswith("one: no point, START_NOT_ON_PATH in ")


def test_lines_in_between_when_it_takes_long(monkeypatch):
    monkeypatch.setattr(progress, "SECONDS", 0.0)
    path, text = shown(FOLD, io.StringIO())
    lines = text.splitlines()
    assert len(lines) == len(path) + 1
    assert lines[0].startswith("one: 0 steps, lam = 0, step length 0")


def test_trace_shows_it_on_stderr_when_asked(capsys):
    for asked in (False, True):
        path = continuation.trace(FOLD, direction=1, target=FOLD.target, progress=asked)
        out, err = capsys.readouterr()
        assert out == ""
        assert (path.status.name in err) == asked
