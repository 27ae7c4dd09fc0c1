"""What a shell's user expects: colours, stdin, a version at once, one line instead of a traceback."""

import io
import json
from unittest.mock import Mock

import numpy as np
import pytest

from continuation.archive import open_archive
from continuation.cli import BAD_INPUT, FAILURE
from continuation.cli.parser import paint

from ...util import Terminal


def test_a_path_of_any_plug_in_is_resumed_by_its_name(run, own):
    run("trace", f"{own}:Own", "slope=3", "n=2", "--archive", "run.h5", "--budget-steps", 2, status=FAILURE)
    page = run("inspect", "run.h5").out
    command = page.splitlines()[-1].partition("`")[2].strip("`.")
    assert command == f"continuation resume run.h5 --homotopy {own}:Own --steps N"
    assert run(*command.replace("N", "50").split()[1:]).out.startswith("REACHED_TARGET")
    with open_archive("run.h5") as archive:
        assert archive.paths["homotopy_slope"].tolist() == [3.0]
    assert "can be resumed" not in run("inspect", "run.h5").out


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("Broken", "KeyError: 'nothing' (own_for_shell.py, line 20)"),
        ("Half", "jacobian: expected a pair (H_y, H_lam) of real numbers"),
        ("Unmade", "RuntimeError: no data (own_for_shell.py, line 30)"),
        ("Gone", "cannot be loaded: AttributeError"),
    ],
)
def test_what_is_wrong_with_a_plug_in_is_one_line(run, own, name, line):
    err = run("trace", f"{own}:{name}", status=FAILURE if "line" in line else BAD_INPUT).err
    assert line in err
    assert err.count("\n") == 1
    assert err.startswith(f"continuation: {own}:{name}: ")


def test_a_picture_that_cannot_be_written_is_told_before_the_work(run, tmp_path, monkeypatch):
    denied = Mock(side_effect=PermissionError(13, "Permission denied"))
    monkeypatch.setattr("continuation.cli.figures.TemporaryFile", denied)
    err = run("trace", "circle", "--plot", tmp_path / "p.png", status=BAD_INPUT).err
    assert "--plot: expected a place to write to" in err


@pytest.mark.parametrize("form", ["json", "npz"])
def test_a_problem_comes_on_stdin(run, monkeypatch, form):
    data = io.BytesIO(json.dumps({"A": [[1, -1], [-1, 1]], "q": [-0.5, 2]}).encode())
    if form == "npz":
        np.savez(data, A=[[1.0, -1.0], [-1.0, 1.0]], q=[-0.5, 2.0])
        data.seek(0)
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(data))
    options = ("--tolerance", "1e-9", "--seed", 3, "--restarts", 2, "--seconds", 60, "--json")
    assert json.loads(run("solve", "-", *options).out)["x"] == pytest.approx([0.5, 0.0], abs=1e-9)


@pytest.mark.parametrize(
    ("text", "good", "stream", "plain", "painted"),
    [
        ("SOLVED", True, Terminal(), "", "\x1b[32mSOLVED\x1b[0m"),
        ("DIVERGED", False, Terminal(), "", "\x1b[31mDIVERGED\x1b[0m"),
        ("SOLVED", True, io.StringIO(), "", "SOLVED"),
        ("SOLVED", True, Terminal(), "1", "SOLVED"),
    ],
)
def test_colours_are_for_terminals(monkeypatch, text, good, stream, plain, painted):
    monkeypatch.setenv("NO_COLOR", plain)
    monkeypatch.setenv("TERM", "xterm")
    assert paint(text, good, stream) == painted
