"""``continuation classify FILE``: matrix classes of the LCP literature."""

from __future__ import annotations

import argparse

from continuation.cli import SUCCESS, Subparsers
from continuation.cli.parser import positive
from problems.commands.arguments import PROBLEM_FORMATS, named


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "classify",
        help="the matrix classes of A, each with its evidence",
        description="Every class test on A in exact arithmetic; floats are taken as the rationals that they are.",
    )
    parser.add_argument("file", metavar="FILE", help=f"A, alone or beside q: {PROBLEM_FORMATS}")
    parser.add_argument("--width", type=positive, default=110, help="longest evidence in characters (default: 110)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the table."""
    from problems.lcp.classes import classify, table
    from problems.lcp.data.files import read_matrix

    with named({"path": "FILE", "A": "FILE"}):
        A = read_matrix(arguments.file)
        classification = classify(A)
    print(table(classification, arguments.width))
    return SUCCESS
