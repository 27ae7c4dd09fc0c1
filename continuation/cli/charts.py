"""``continuation chart``: ready studies of speed against accuracy, as tables, files and figures; and one path's own."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from continuation.cli.parser import SUCCESS, Subparsers, UsageError

if TYPE_CHECKING:
    from continuation.chart import Row, Study
    from continuation.chart.run import Watch

DEFAULT_OUTPUT = "continuation-chart"
EVERY = "all"


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    parser = subparsers.add_parser(
        "chart",
        help="speed against accuracy: run a ready study",
        description="Run a study, print its table, and write results (CSV, Markdown) and pictures. Without a "
        "name, list the studies.",
    )
    parser.add_argument("name", metavar="NAME", nargs="?", help=f"a study, or {EVERY}")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--smoke", dest="size", action="store_const", const="smoke", help="tiny sizes, in seconds")
    size.add_argument("--full", dest="size", action="store_const", const="full", help="full sizes, in many minutes")
    parser.add_argument("--compare", action="store_true", help="outside solvers too, where they are installed")
    parser.add_argument(
        "--output", metavar="DIR", default=DEFAULT_OUTPUT, help=f"where the files go (default: {DEFAULT_OUTPUT})"
    )
    parser.set_defaults(run=run, size="moderate")


def run(arguments: argparse.Namespace) -> int:
    """Run, print, write."""
    from continuation.chart.catalogue import catalogue, studies

    try:
        names = list(catalogue())
        if arguments.name is None:
            print("\n".join(names))
            return SUCCESS
        if arguments.name not in (EVERY, *names):
            known = ", ".join(names) or "(none installed)"
            raise ValueError(f"expected {EVERY} or one of {known}, found {arguments.name!r}")
    except ValueError as error:
        raise UsageError("NAME", error) from error
    folder = new_folder("--output", arguments.output)
    for name in names if arguments.name == EVERY else [arguments.name]:
        for study in studies(name, arguments.size, arguments.compare):
            _one(study, folder, sys.stdout)
    return SUCCESS


def chart_presets(
    homotopy: Any,
    title: str,
    course: Mapping[str, Any],
    method: Mapping[str, Any],
    rungs: Sequence[float],
    folder: Path,
    out: TextIO,
) -> None:
    """Chart the presets on the path of one homotopy, a ladder of tolerances each, against a reference.

    `course` has the options that belong to the path (target, direction, events), `method` those of every method (the
    budget). Raises `ArithmeticError` if the path at the reference's tolerance does not arrive.
    """
    from continuation import chart
    from continuation.step import presets

    problem = chart.Problem(title, homotopy, chart.reference(homotopy, **course), course)
    turns = problem.truth.turning_points
    errors = (chart.END_POINT, chart.TURNING_POINTS) if turns is not None and len(turns) else (chart.END_POINT,)
    study = chart.Study(
        name=re.sub(r"[^\w.-]+", "-", title),
        title=f"Tolerance against work: {title}",
        problems=[problem],
        methods=[
            chart.traced(preset.name, preset=preset, **method)
            for preset in (presets.FAST, presets.DEFAULT, presets.CONSERVATIVE, presets.SERIES)
        ],
        ladder=chart.tolerances(*rungs),
        errors=errors,
        figures=[chart.Lines(error.name, ("seconds", "factorizations")) for error in errors],
    )
    _one(study, folder, out)


def _one(study: Study, folder: Path, out: TextIO) -> None:
    from continuation.chart import run as run_study
    from continuation.chart.run import report, tables

    results = run_study(study, _watch(study.name))
    for title, table in tables(study, results).items():
        print(f"\n{results.title}: {title}\n{table.text()}", file=out)
    for note in study.notes:
        print(f"\n{results.title}: {note}", file=out)
    print(f"\nWritten: {', '.join(map(str, report(study, results, folder)))}", file=out)


def _watch(name: str) -> Watch | None:
    """On a terminal, a line with the progress of the study; nothing elsewhere."""
    if not sys.stderr.isatty():
        return None

    def show(done: int, whole: int, row: Row) -> None:
        end = "\n" if done == whole else ""
        print(f"\r{name}: {done} of {whole}  {row.problem}, {row.method}"[:100].ljust(100), end=end, file=sys.stderr)

    return show


def new_folder(option: str, name: str) -> Path:
    """The directory that an option names, made if it is not there."""
    folder = Path(name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        complaint = f"expected a directory, or a new one, found {name!r} ({error.strerror})"
        raise UsageError(option, complaint) from error
    return folder
