"""The command line, ``continuation COMMAND ...``: one file a group of commands; `problems` adds its own."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence

from continuation.cli.commands import register
from continuation.cli.parser import BAD_INPUT, FAILURE, SUCCESS, Parser, Run, Subparsers, UsageError
from continuation.version import __version__

__all__ = ["BAD_INPUT", "FAILURE", "SUCCESS", "Run", "Subparsers", "UsageError", "main"]

INTERRUPTED = 130
"""The shell's status for a process that Ctrl-C ended."""

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)
"""What the machine says of a file that has no place; any other error of the system may be a defect, and is shown."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    argv : sequence of str, optional
        The arguments without the program's name; those of the process by default.

    Returns
    -------
    int
        0 done (solved), 1 not solved, 2 bad input, after one line on stderr that names the argument.
    """
    parser = Parser(prog="continuation", description="Trace paths of solutions; inspect, plot and resume them.")
    parser.add_argument("--version", action="version", version=f"continuation {__version__}")
    register(parser.add_subparsers(title="commands", metavar="COMMAND", required=True))
    try:
        arguments = parser.parse_args(argv)
    except SystemExit as end:
        return int(end.code or 0)
    run: Run = arguments.run
    try:
        status = run(arguments)
        sys.stdout.flush()
    except UsageError as error:
        print(f"continuation: {error}", file=sys.stderr)
        return error.status
    except BrokenPipeError:
        # The reader (head, a pager) has enough; without this, Python complains once more while it shuts down.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return SUCCESS
    except KeyboardInterrupt as interrupt:
        kept = getattr(arguments, "archive", None) or getattr(arguments, "grows", None)
        where = f"; what was traced is in {kept}" if kept is not None and os.path.exists(kept) else ""
        print(f"continuation: {str(interrupt) or 'interrupted'}{where}", file=sys.stderr)
        return INTERRUPTED
    except OSError as error:
        from continuation.archive.errors import ArchiveError

        if not isinstance(error, ArchiveError) and error.errno not in NO_ROOM:
            raise
        name = error.filename or "the output"
        what = error if error.errno is None else f"{name}: could not be written ({os.strerror(error.errno)})"
        print(f"continuation: {what}", file=sys.stderr)
        return BAD_INPUT
    return status
