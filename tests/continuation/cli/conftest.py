"""The command line as a function."""

import sys

import pytest

from continuation.cli import BAD_INPUT, SUCCESS, main


@pytest.fixture
def run(capsys):
    """main(argv) -> (stdout, stderr), with the status expected; bad input is always exactly one line on stderr."""

    def call(*argv, status=SUCCESS):
        found, captured = main([str(argument) for argument in argv]), capsys.readouterr()
        assert found == status, captured.err
        if status == BAD_INPUT:
            assert captured.out == ""
            assert captured.err.count("\n") == 1
        return captured

    return call


OWN = """
import numpy as np


class Own:
    target = 1.0

    def __init__(self, n=3, slope=2.0):
        self.n, self.slope = n, slope

    def start(self):
        return np.zeros(self.n), 0.0

    def residual(self, y, lam):
        return y - self.slope * lam + 0.2 * y**3


class Broken(Own):
    def residual(self, y, lam):
        return {}["nothing"]


class Half(Own):
    def jacobian(self, y, lam):
        return np.eye(self.n)


class Unmade(Own):
    def __init__(self):
        raise RuntimeError("no data")


class Table(Own):
    def residual(self, y, lam):
        if lam > 0.5:
            raise ValueError("the table ends")
        return y - lam


class Wrong(Own):
    def jacobian(self, y, lam):
        return 2 * np.eye(self.n), np.full(self.n, -self.slope)
"""


@pytest.fixture
def own(tmp_path, monkeypatch):
    (tmp_path / "own_for_shell.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    yield "own_for_shell"
    sys.modules.pop("own_for_shell", None)
