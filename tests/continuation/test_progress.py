"""Progress on stderr: lines where there is no terminal, one live line where there is."""

import io
import sys

import pytest

import continuation
from continuation.step import progress
from continuation.step.progress import Progress

from ..util import Terminal

LINE = continuation.from_functions(lambda y, lam: y - lam, start=([1.0], 1.0))
FOLD = continuation.from_functions(lambda y, lam: y**2 + lam - 1.0, start=([-1.0], 0.0), target=-0.5)


def shown(monkeypatch, homotopy, stream, seconds=0.0):
    monkeypatch.setattr(progress, "PLAIN_SECONDS", seconds)
    monkeypatch.setattr(progress, "LIVE_SECONDS", seconds)
    path = continuation.trace(homotopy, direction=1, target=homotopy.target, observers=(Progress(stream, "one"),))
    return path, stream.getvalue()


def test_without_a_terminal_only_the_end_of_a_short_trace_is_shown(monkeypatch):
    path, text = shown(monkeypatch, FOLD, io.StringIO(), 10.0)
    assert text.startswith(f"one: {path.endpoint.index} steps, lam = {path.endpoint.lam:.4g}, {path.status.name} in ")
    assert text.count("\n") == 1


def test_of_a_path_without_points_none_is_shown(monkeypatch):
    nowhere = continuation.from_functions(lambda y, lam: y**2 + 1.0, start=([1.0], 0.0))
    assert shown(monkeypatch, nowhere, io.StringIO())[1].startswith("one: 0 steps, no point, START_NOT_ON_PATH in ")


def test_lines_in_between_when_it_takes_long_count_turning_points(monkeypatch):
    path, text = shown(monkeypatch, FOLD, io.StringIO())
    lines = text.splitlines()
    assert len(lines) == len(path) + 1
    assert lines[0].startswith("one: 0 steps, lam = 0, step length 0")
    turned = [line.endswith(", 1 turning point") for line in lines[:-1]]
    assert turned == [step.index >= path.turning_points[0].step for step in path.steps]


@pytest.mark.parametrize("tqdm", [True, False])
def test_a_terminal_has_one_line_written_over(monkeypatch, tqdm):
    if tqdm:
        pytest.importorskip("tqdm")
    else:
        monkeypatch.setitem(sys.modules, "tqdm", None)
    path, text = shown(monkeypatch, FOLD, Terminal())
    assert f"one: {path.endpoint.index} steps" in text
    assert path.status.name in text
    assert text.count("\r") > 2
    assert text.endswith("\n")
    assert tqdm or text.count("\n") == 1


def test_trace_shows_it_on_stderr_when_asked(capsys):
    for asked in (False, True):
        path = continuation.trace(LINE, progress=asked)
        out, err = capsys.readouterr()
        assert out == ""
        assert (path.status.name in err) == asked
