"""``continuation chart``: ready studies of speed against accuracy."""

from __future__ import annotations

import argparse

from continuation.arguments import plugins
from continuation.cli.making import plug_in
from continuation.cli.parser import SUCCESS, Subparsers, add_command, argument, new_folder


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    parser = add_command(
        subparsers, run, "chart",
        argument("name", metavar="NAME", nargs="?", help="a study; or module:function of your own"),
        argument("--compare", action="store_true", help="outside solvers too, where they are installed"),
        argument("--output", metavar="DIR", default="continuation-chart",
                 help="where the files go (default: continuation-chart)"),
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

    if arguments.name is None:
        print("\n".join(plugins.available(plugins.STUDIES)))
        return SUCCESS
    make = plug_in(arguments.name, plugins.STUDIES)
    folder = new_folder("--output", arguments.output)
    for study in make(arguments.size, arguments.compare):
        results = run_study(study)
        for title, table in tables(results).items():
            print(f"\n{results.title}: {title}\n{table.text()}")
        print(f"\nWritten: {', '.join(map(str, report(study, results, folder)))}")
    return SUCCESS
