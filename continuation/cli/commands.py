"""The commands: those of the engine, and those that installed packages add through entry points."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from importlib.metadata import EntryPoint, entry_points

from continuation.arguments.plugins import grouped, owners
from continuation.cli import archives, charts, figures, homotopies
from continuation.cli.parser import Subparsers, UsageError

GROUP = "continuation.commands"
"""Entry points of this group are functions that take the subparsers and add one command, named as the entry point."""

Register = Callable[[Subparsers], None]


def register(subparsers: Subparsers) -> None:
    """Add every command, the engine's own last.

    An entry point that cannot be loaded hides no other: its command stays in the list and says why it cannot run.
    """
    for name, points in grouped(entry_points(group=GROUP)).items():
        _loaded(name, points)(subparsers)
    homotopies.register(subparsers)
    archives.register(subparsers)
    figures.register(subparsers)
    charts.register(subparsers)


def _loaded(name: str, points: Sequence[EntryPoint]) -> Register:
    if len(points) > 1:
        return _broken(name, f"expected one package that provides it, found {owners(points)}")
    try:
        loaded: Register = points[0].load()
    except (Exception, SystemExit) as error:  # Anything may be raised by the import of a foreign module.
        return _broken(name, f"{points[0].value} cannot be loaded: {type(error).__name__}: {error}")
    return loaded


def _broken(name: str, reason: str) -> Register:
    def complain(arguments: argparse.Namespace) -> int:
        raise UsageError(name, reason)

    def add(subparsers: Subparsers) -> None:
        # No prefix character, so that any arguments are accepted and the reason is shown.
        parser = subparsers.add_parser(name, help="(cannot run; call it to see why)", prefix_chars="\0", add_help=False)
        parser.add_argument("rest", nargs="*", help=argparse.SUPPRESS)
        parser.set_defaults(run=complain)

    return add
