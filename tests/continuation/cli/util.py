"""Commands in a child process, which is prepared first."""

import os
from contextlib import redirect_stderr

from continuation.cli import main

from ..archive.util import child


def forked(words, prepare):
    """The status of a command, and what it says on stderr."""

    def work():
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        with open(2, "w", closefd=False) as stderr, redirect_stderr(stderr):
            prepare()
            return main(words)

    done = child(work)
    return done.answer, done.said
