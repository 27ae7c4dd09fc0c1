"""Progress on stderr: lines where there is no terminal, one live line where there is."""

import io
import sys

import pytest

import continuation
from continuation.step import progress
from continuation.step.progress import Progress


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


def trace(**options):
    homotopy = continuation.from_functions(lambda y, lam: y - lam, start=([1.0], 1.0))
    return continuation.trace(homotopy, **options)


def test_without_a_terminal_only_the_end_of_a_short_trace_is_shown():
    stream = io.StringIO()
    path = trace(observers=(Progress(stream, "line"),))
    (line,) = stream.getvalue().splitlines()
    assert line.startswith(f"line: {path.endpoint.index} steps, lam = 0, REACHED_TARGET in ")


def test_lines_in_between_when_it_takes_long(monkeypatch):
    monkeypatch.setattr(progress, "PLAIN_SECONDS", 0.0)
    stream = io.StringIO()
    path = trace(observers=(Progress(stream),))
    lines = stream.getvalue().splitlines()
    assert len(lines) == len(path) + 1
    assert lines[0].startswith("path: 0 steps, lam = 1, step length 0")


def test_without_tqdm_a_terminal_has_one_line_written_over(monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm", None)
    monkeypatch.setattr(progress, "LIVE_SECONDS", 0.0)
    stream = Terminal()
    trace(observers=(Progress(stream),))
    text = stream.getvalue()
    assert text.count("\n") == 1
    assert text.count("\r") > 2
    assert "REACHED_TARGET" in text


def test_with_tqdm_the_bar_is_closed_at_the_end(monkeypatch):
    pytest.importorskip("tqdm")
    monkeypatch.setattr(progress, "LIVE_SECONDS", 0.0)
    stream = Terminal()
    path = trace(observers=(Progress(stream),))
    text = stream.getvalue()
    assert f"path: {path.endpoint.index} steps" in text
    assert "REACHED_TARGET" in text
    assert text.endswith("\n")


def test_turning_points_are_counted(monkeypatch):
    monkeypatch.setattr(progress, "PLAIN_SECONDS", 0.0)
    stream = io.StringIO()
    fold = continuation.from_functions(lambda y, lam: y**2 + lam - 1.0, start=([-1.0], 0.0), target=None)
    continuation.trace(
        fold, direction=1, events=[continuation.TargetValue(0.9, component=0)], observers=(Progress(stream),)
    )
    assert "1 turning point\n" in stream.getvalue()


def test_trace_shows_it_on_stderr_when_asked(capsys):
    trace(progress=True)
    captured = capsys.readouterr()
    assert "REACHED_TARGET" in captured.err
    assert captured.out == ""
    trace()
    assert capsys.readouterr().err == ""
