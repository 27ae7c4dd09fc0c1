"""``continuation plot``, and pictures of other commands."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

from continuation.cli.parser import SUCCESS, Subparsers, UsageError, add_command, argument, parsed

SUFFIXES = (".png", ".pdf", ".svg")


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    add_command(
        subparsers, run, "plot",
        argument("file", metavar="FILE", help="an archive"),
        argument("--output", metavar="FILE", help="the picture (.png, .pdf, .svg); default: as FILE, .png"),
        argument("--path", type=int, default=0, metavar="N", help="which path, counted from 0 (default: 0)"),
        argument(
            "--against", choices=("lam", "arclength"), default="lam", help="the horizontal axis (default: lam)"
        ),
        argument(
            "--components", type=_numbers, metavar="I,J,...", help="components of y, from 0; default: at most seven"
        ),
        argument(
            "--diagram", action="store_true", help="draw the maximum norm of y (or the one component) against lambda"
        ),
        names={"components": "--components", "path": "FILE"},
        help="draw a path of an archive",
        description="Components of y, or the bifurcation diagram, with turning points marked, above the step sizes.",
    )  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    """Read, draw, print the name."""
    from continuation.archive import open_archive

    with open_archive(arguments.file) as archive:
        if not 0 <= arguments.path < len(archive):
            raise UsageError("--path", f"expected a number below {len(archive)}, found {arguments.path}")
        path = archive.path(arguments.path)
    output = str(Path(arguments.file).with_suffix(".png")) if arguments.output is None else arguments.output
    check_picture("--output", output)
    name = "".join(c if c.isprintable() else "?" for c in Path(arguments.file).name)
    save(output, path, f"{name}, path {arguments.path}: {path.status.name}", partial(_draw, path, arguments))
    print(output)
    return SUCCESS


def check_picture(option: str, file: str) -> None:
    """Raise `UsageError` early if the `file` of an `option` cannot be written."""
    from continuation.plot import require_matplotlib

    path = Path(file)
    if path.suffix.lower() not in SUFFIXES:
        raise UsageError(option, f"expected a name in {', '.join(SUFFIXES)}, found {file!r}")
    try:
        require_matplotlib()
        # Permissions do not show full or read-only disks.
        TemporaryFile(dir=path.parent).close()
    except OSError as error:
        raise UsageError(option, f"expected a place to write to, found {file!r} ({error.strerror})") from error


def save(file: str, path: Any, title: str, draw: Callable[[Any], object]) -> None:
    """Save the axes that `draw` fills, above step sizes if a path is given."""
    from matplotlib.figure import Figure

    from continuation.archive.atomic import beside, publish
    from continuation.plot import plot_steps

    figure = Figure(figsize=(6.5, 4.0) if path is None else (7.0, 6.0), layout="constrained")
    figure.suptitle(title, fontsize="medium")
    grid = figure.add_gridspec(1 if path is None else 2, 1, height_ratios=[1] if path is None else [3, 1])
    draw(figure.add_subplot(grid[0]))
    if path is not None:
        plot_steps(path, figure.add_subplot(grid[1]))
    picture = BytesIO()
    figure.savefig(picture, format=Path(file).suffix[1:].lower(), dpi=150)
    # A full disk must not destroy the old file.
    with beside(Path(file)) as part:
        part.write_bytes(picture.getvalue())
        publish(part, Path(file), replace=True)


def _draw(path: Any, arguments: argparse.Namespace, axes: Any) -> None:
    from continuation.plot import plot_bifurcation, plot_components

    chosen = arguments.components
    if arguments.diagram:
        plot_bifurcation(path, axes, None if chosen is None else chosen[0])
    else:
        plot_components(path, axes, arguments.against, components=chosen)


def _numbers(text: str) -> list[int]:
    return parsed(text, lambda text: [int(part) for part in text.split(",")], bool, "numbers like 0,2,3")
