"""A command: a function, its arguments, and the names of these in complaints.

Whatever is raised, `main` prints one line, beginning with the argument as typed. A complaint names a Python argument; a
command's `names` say what was typed for it, and what for the archive that is read ("old") or written ("new").
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NoReturn, TextIO, TypeAlias, TypeVar

T = TypeVar("T")

SUCCESS, FAILURE, BAD_INPUT = 0, 1, 2
"""Exit statuses."""

Run = Callable[[argparse.Namespace], int]

Argument = tuple[tuple[str, ...], dict[str, Any]]


class UsageError(ValueError):
    """A bad argument, as typed (``FILE``, ``--x0``): one line, and exit status 2."""

    def __init__(self, argument: str, complaint: object) -> None:
        super().__init__(f"{argument}: {' '.join(str(complaint).split())}")


class Parser(argparse.ArgumentParser):
    """A parser with one-line error messages."""

    def error(self, message: str) -> NoReturn:
        """Write the message and exit with status 2."""
        self.exit(BAD_INPUT, f"{self.prog}: {message.removeprefix('argument ')}\n")


Subparsers: TypeAlias = "argparse._SubParsersAction[Any]"


def argument(*names: str, **options: Any) -> Argument:
    """An argument for `add_command`."""
    return names, options


def add_command(
    subparsers: Subparsers,
    run: Run,
    name: str,
    *arguments: Argument,
    names: Mapping[str, str] | None = None,
    plugin: str = "",
    **options: Any,
) -> argparse.ArgumentParser:
    """Add a command; `plugin`: the argument that names foreign code, to which its exceptions are attributed."""
    parser: argparse.ArgumentParser = subparsers.add_parser(name, **options)
    for typed, about in arguments:
        parser.add_argument(*typed, **about)
    parser.set_defaults(run=run, names=names or {}, plugin=plugin)
    return parser


def paint(text: str, good: bool, stream: TextIO | None = None) -> str:
    """The text, green or red on a terminal unless NO_COLOR is set (no-color.org)."""
    stream = sys.stdout if stream is None else stream
    if not stream.isatty() or os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb":
        return text
    return f"\x1b[{32 if good else 31}m{text}\x1b[0m"


def parsed(text: str, convert: Callable[[str], T], fine: Callable[[T], bool], expected: str) -> T:
    """An argument's value."""
    try:
        value = convert(text)
        if fine(value):
            return value
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(f"expected {expected}, found {text!r}")


def above_zero(text: str) -> float:
    """A positive number."""
    return parsed(text, float, lambda value: 0.0 < value < math.inf, "a positive number")


def positive(text: str) -> int:
    """A positive integer."""
    return parsed(text, int, lambda value: value >= 1, "a positive integer")


def new_folder(option: str, name: str) -> Path:
    """The directory that an option names, created if missing."""
    folder = Path(name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        complaint = f"expected a directory, or a new one, found {name!r} ({error.strerror})"
        raise UsageError(option, complaint) from error
    return folder
