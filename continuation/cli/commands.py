"""The engine's commands and those of installed packages."""

from __future__ import annotations

import argparse

from continuation.arguments import plugins
from continuation.cli import archives, charts, figures, homotopies
from continuation.cli.parser import Subparsers, UsageError


def register(subparsers: Subparsers) -> None:
    """Add every command, the engine's own last.

    An entry point of the group `continuation.commands` takes the subparsers and adds a command. If it cannot be loaded,
    its command gives the reason.
    """
    for name, plugin in plugins.available(plugins.COMMANDS).items():
        try:
            plugin.load()(subparsers)
        except plugins.PluginError as error:
            _broken(subparsers, name, str(error).removeprefix(f"{name}: "))
    for group in (homotopies, archives, figures, charts):
        group.register(subparsers)


def _broken(subparsers: Subparsers, name: str, reason: str) -> None:
    def complain(arguments: argparse.Namespace) -> int:
        raise UsageError(name, reason)

    # Without prefix characters, any arguments are accepted.
    parser = subparsers.add_parser(name, help="(cannot run; call it to see why)", prefix_chars="\0", add_help=False)
    parser.add_argument("rest", nargs="*", help=argparse.SUPPRESS)
    parser.set_defaults(run=complain)
