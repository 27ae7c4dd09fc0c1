"""``continuation paper``: the ten examples as table, archive, figures."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from continuation.cli import FAILURE, SUCCESS, Subparsers, UsageError
from continuation.cli.parser import add_command, argument, new_folder

if TYPE_CHECKING:
    from problems.paper_report import Row

DEFAULT_OUTPUT = "continuation-paper"


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    add_command(
        subparsers, run, "paper",
        argument("--output", metavar="DIR", default=DEFAULT_OUTPUT,
                 help=f"where the files go (default: {DEFAULT_OUTPUT})"),
        argument("--methods", metavar="all|NAME,...", help="compare other methods too, in a second table"),
        help="the ten examples of Dutta, Das and Jana: a table, an archive, figures",
        description="Trace the KKT path of each example from the paper's start, with the paper's own algorithm beside "
        "it. Exit status: 0 if all ten end at a solution.",
    )  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    """Trace, print, write."""
    from problems.paper import EXAMPLES
    from problems.paper_report import remarks, run_examples, table

    methods = _methods(arguments.methods)
    folder = new_folder("--output", arguments.output)
    archive = folder / "paths.h5"
    # This command owns the folder: replace the last run's archive.
    archive.unlink(missing_ok=True)
    rows = run_examples(EXAMPLES, archive)
    text = "\n".join([table(rows), *remarks(rows)])
    print(text)
    (folder / "table.txt").write_text(f"{text}\n", encoding="utf-8")
    written = [archive, folder / "table.txt"]
    if methods:
        from continuation.chart import write
        from problems.paper_methods import LEGEND, compare, matrix

        results = compare(EXAMPLES, methods)
        print(f"\n{matrix(results)}\n{LEGEND}")
        written.append(write(results, folder / "methods.json"))
    figure = _figure(folder, rows)
    print(f"\nWritten: {', '.join(map(str, written))}{figure}")
    return SUCCESS if all(row.solved for row in rows) else FAILURE


def _methods(value: str | None) -> list[str]:
    if value is None:
        return []
    from problems.paper_methods import METHODS

    names = list(METHODS) if value == "all" else value.split(",")
    unknown = [name for name in names if name not in METHODS]
    if unknown:
        raise UsageError("--methods", f"expected all or some of {', '.join(METHODS)}, found {unknown[0]!r}")
    return names


def _figure(folder: Path, rows: Sequence[Row]) -> str:
    from problems.paper_figures import draw_examples

    try:
        figure = draw_examples([row.example for row in rows], [row.path for row in rows])
    except ImportError as error:
        return f". No figures: {error}."
    file = folder / "paths.png"
    figure.savefig(file, dpi=150)
    return f", {file}"
