"""Commands in a child process, which is prepared first."""

import os

import pytest

from continuation.cli import main


def forked(folder, words, prepare):
    """The status of a command, and what it says on stderr."""
    process = os.fork()
    if not process:
        status = 99
        try:
            os.chdir(folder)
            os.dup2(os.open("said", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            with open(2, "w", closefd=False) as stderr, pytest.MonkeyPatch.context() as patch:
                patch.setattr("sys.stderr", stderr)
                prepare()
                status = main(words)
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), (folder / "said").read_text()
