"""The command line, ``continuation COMMAND ...``; `problems` adds commands."""

from __future__ import annotations

import argparse
import os
import sys
import traceback
from collections.abc import Sequence
from io import TextIOWrapper
from typing import Any

from continuation.arguments import plugins
from continuation.cli import archives, charts, figures, homotopies
from continuation.cli.parser import BAD_INPUT, FAILURE, SUCCESS, Parser, Run, Subparsers, UsageError
from continuation.version import __version__

__all__ = ["BAD_INPUT", "FAILURE", "SUCCESS", "Run", "Subparsers", "UsageError", "main", "register"]

INTERRUPTED = 130
"""The shell's status after Ctrl-C."""


def register(subparsers: Subparsers) -> None:
    """Add every command, the engine's own last.

    An entry point of the group `continuation.commands` takes the subparsers and adds a command. If it cannot be loaded,
    its command gives the reason.

    Parameters
    ----------
    subparsers : Subparsers
    """
    for name, plugin in plugins.available(plugins.COMMANDS).items():
        try:
            plugin.load()(subparsers)
        except plugins.PluginError as error:
            # Without prefix characters, any arguments are accepted.
            broken = subparsers.add_parser(
                name, help="(cannot run; call it to see why)", prefix_chars="\0", add_help=False
            )
            broken.add_argument("rest", nargs="*", help=argparse.SUPPRESS)
            broken.set_defaults(run=_complain, broken=error)
    for group in (homotopies, archives, figures, charts):
        group.register(subparsers)


def _complain(arguments: argparse.Namespace) -> int:
    raise arguments.broken


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
    try:
        sys.stdout.flush()
    except OSError:
        # Python would complain about a closed stdout.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if line:
        print(f"continuation: {' '.join(line.split())}", file=sys.stderr)
    return status


def _ended(error: BaseException, arguments: argparse.Namespace) -> tuple[int, str]:
    if isinstance(error, BrokenPipeError):
        # The reader (head, a pager) has closed.
        return SUCCESS, ""
    if isinstance(error, KeyboardInterrupt):
        kept = getattr(arguments, "archive", None) or getattr(arguments, "grows", None)
        where = f"; what was traced is in {kept}" if kept is not None and os.path.exists(kept) else ""
        return INTERRUPTED, f"{str(error) or 'interrupted'}{where}"
    if isinstance(error, UsageError | plugins.PluginError):
        return BAD_INPUT, str(error)
    from continuation.archive import ArchiveError, ArchiveExistsError

    names, (first, _, complaint) = arguments.names, str(error).partition(":")
    if isinstance(error, ArchiveError):
        typed = names.get("new", "FILE") if isinstance(error, ArchiveExistsError) else names.get("old", "FILE")
        return BAD_INPUT, f"{typed}: {error}"
    if isinstance(error, ValueError | TypeError | OSError) and first in names:
        return BAD_INPUT, f"{names[first]}: {complaint}"
    if isinstance(error, OSError):
        name = error.filename or "the output"
        text = str(error) if error.errno is None else f"{name}: could not be read or written ({error.strerror})"
        return BAD_INPUT, text
    blamed = getattr(arguments, arguments.plugin, None) if arguments.plugin else None
    if blamed is None or not isinstance(error, Exception):
        return BAD_INPUT, _told(error)
    if isinstance(error, TypeError | ValueError) and complaint.startswith(" expected "):
        return BAD_INPUT, f"{blamed}: {error}"
    return FAILURE, f"{blamed}: {_told(error)}"


def _told(error: BaseException) -> str:
    from continuation.step.verdict import sentence

    frames: Any = traceback.extract_tb(error.__traceback__)
    return f"{sentence(error)} ({os.path.basename(frames[-1].filename)}, line {frames[-1].lineno})"
