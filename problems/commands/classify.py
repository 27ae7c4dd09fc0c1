"""``continuation classify FILE``: matrix classes of the LCP literature."""

from __future__ import annotations

import argparse

from continuation.cli import SUCCESS, Subparsers
from continuation.cli.parser import add_command, argument, positive
from problems.commands.arguments import PROBLEM_FORMATS


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    add_command(
        subparsers, run, "classify",
        argument("file", metavar="FILE", help=f"A, alone or beside q: {PROBLEM_FORMATS}"),
        argument("--width", type=positive, default=110, help="longest evidence in characters (default: 110)"),
        names={"path": "FILE", "A": "FILE"}, help="the matrix classes of A, each with its evidence",
        description="Every class test on A in exact arithmetic; floats are taken as the rationals that they are.",
    )  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    """Print the table."""
    from problems.lcp.classes import classify, table
    from problems.lcp.data.files import read_matrix

    print(table(classify(read_matrix(arguments.file)), arguments.width))
    return SUCCESS
