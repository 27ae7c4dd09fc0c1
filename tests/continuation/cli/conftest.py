"""The command line as a function."""

import pytest

from continuation.cli import BAD_INPUT, main


@pytest.fixture
def run(capsys):
    """main(argv) -> (status, stdout, stderr); bad input is always exactly one line on stderr."""

    def call(*argv):
        status = main([str(argument) for argument in argv])
        captured = capsys.readouterr()
        if status == BAD_INPUT:
            assert captured.out == ""
            assert captured.err.count("\n") == 1
        return status, captured.out, captured.err

    return call
