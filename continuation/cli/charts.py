"""``continuation chart``: ready studies of speed against accuracy."""

from __future__ import annotations

import argparse
from itertools import chain

from continuation.arguments import plugins
from continuation.cli.making import plug_in
from continuation.cli.parser import SUCCESS, Subparsers, add_command, argument, new_folder

DEFAULT_OUTPUT = "continuation-chart"
EVERY = "all"


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    parser = add_command(
        subparsers, run, "chart",
        argument("name", metavar="NAME", nargs="?", help=f"a study, or {EVERY}; or module:function of your own"),
        argument("--compare", action="store_true", help="outside solvers too, where they are installed"),
        argument("--output", metavar="DIR", default=DEFAULT_OUTPUT,
                 help=f"where the files go (default: {DEFAULT_OUTPUT})"),
        help="speed against accuracy: run a ready study",
        description="Run a study, print its table, and write results (JSON) and pictures. Without a "
        "name, list the studies.",
    )  # fmt: skip
    size = parser.add_mutually_exclusive_group()
    for name, said in (("smoke", "tiny sizes, in seconds"), ("full", "full sizes, in many minutes")):
        size.add_argument(f"--{name}", dest="size", action="store_const", const=name, default="moderate", help=said)


def run(arguments: argparse.Namespace) -> int:
    """Run, print, write."""
    from continuation.chart import run as run_study
    from continuation.chart.run import report, tables

    names = list(plugins.available(plugins.STUDIES))
    if arguments.name is None:
        print("\n".join(names))
        return SUCCESS
    chosen = names if arguments.name == EVERY else [arguments.name]
    makers = [plug_in(name, plugins.STUDIES) for name in chosen]
    folder = new_folder("--output", arguments.output)
    for study in chain.from_iterable(make(arguments.size, arguments.compare) for make in makers):
        results = run_study(study)
        for title, table in tables(results).items():
            print(f"\n{results.title}: {title}\n{table.text()}")
        print(f"\nWritten: {', '.join(map(str, report(study, results, folder)))}")
    return SUCCESS
