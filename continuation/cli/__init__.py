"""The command line, ``continuation COMMAND ...``; `problems` adds commands."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper

from continuation.cli.commands import register
from continuation.cli.parser import BAD_INPUT, FAILURE, SUCCESS, Parser, Run, Subparsers, UsageError, told
from continuation.version import __version__

__all__ = ["BAD_INPUT", "FAILURE", "SUCCESS", "Run", "Subparsers", "UsageError", "main"]

INTERRUPTED = 130
"""The shell's status after Ctrl-C."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; exceptions become one line on stderr.

    Parameters
    ----------
    argv : sequence of str, optional
        Default: the process's arguments.

    Returns
    -------
    int
        0 done (solved), 1 not solved, 2 bad input.
    """
    if sys.stdout is None:
        print("continuation: stdout: is closed, expected a place for what the command says", file=sys.stderr)
        return BAD_INPUT
    if isinstance(sys.stdout, TextIOWrapper):
        # Keep file names that are no UTF-8.
        sys.stdout.reconfigure(errors="surrogateescape")
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
        return status
    except BaseException as error:
        status, line = _ended(error, arguments)
    _let_go()
    if line:
        print(f"continuation: {' '.join(line.split())}", file=sys.stderr)
    return status


def _ended(error: BaseException, arguments: object) -> tuple[int, str]:
    if isinstance(error, UsageError):
        return error.status, str(error)
    if isinstance(error, BrokenPipeError):
        # The reader (head, a pager) has closed.
        return SUCCESS, ""
    if isinstance(error, KeyboardInterrupt):
        kept = getattr(arguments, "archive", None) or getattr(arguments, "grows", None)
        where = f"; what was traced is in {kept}" if kept is not None and os.path.exists(kept) else ""
        return INTERRUPTED, f"{str(error) or 'interrupted'}{where}"
    if isinstance(error, OSError):
        name = error.filename or "the output"
        text = str(error) if error.errno is None else f"{name}: could not be read or written ({error.strerror})"
        return BAD_INPUT, text
    if isinstance(error, SystemExit):
        return BAD_INPUT, f"a plug-in wanted to end the process: {told(error)}"
    return BAD_INPUT, told(error)


def _let_go() -> None:
    """Redirect a closed stdout, about which Python would complain."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
