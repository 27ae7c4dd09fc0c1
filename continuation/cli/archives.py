"""``continuation inspect``, ``resume``, ``recheck``, ``recover``, ``export`` and ``merge``."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from continuation.arguments import plugins
from continuation.cli.making import homotopy_of, plug_in
from continuation.cli.parser import (
    FAILURE,
    SUCCESS,
    Subparsers,
    UsageError,
    add_command,
    argument,
    positive,
)

if TYPE_CHECKING:
    from continuation.step.options import Options


def register(subparsers: Subparsers) -> None:
    """Add the commands."""
    trust = argument(
        "--trust",
        action="append",
        default=[],
        type=_named,
        metavar="MODULE:NAME",
        help="a class or function that may be made, besides what is installed; can be given again",
    )
    add_command(
        subparsers, _inspect, "inspect",
        argument("file", metavar="FILE", help="an archive; may still be growing"),
        help="what an archive holds: what ran, how it ended, at what cost",
    )  # fmt: skip
    add_command(
        subparsers, _resume, "resume",
        argument("file", metavar="FILE", help="an archive whose last path has not reached its end"),
        argument("options", metavar="KEY=VALUE", nargs="*", help="of the homotopy; the file's own by default"),
        argument("--homotopy", metavar="NAME", help="a name of `continuation plugins`, or module:object"),
        argument("--archive", metavar="NEW", help="write to a new file instead of going on in FILE"),
        argument("--steps", type=positive, metavar="N", help="a new budget: accepted steps"),
        trust,
        argument("--progress", action="store_true", help="show the progress on stderr"),
        names={"new": "--archive", "homotopy": "FILE"}, plugin="homotopy",
        help="go on with a path that was interrupted",
    )  # fmt: skip
    add_command(
        subparsers, _recheck, "recheck", argument("file", metavar="FILE", help="an archive with certificates"), trust,
        help="check the proofs of an archive again, without tracing",
    )  # fmt: skip
    add_command(
        subparsers, _recover, "recover",
        argument("file", metavar="FILE", help="replaced by a copy of all that was committed"),
        help="make whole what a killed writer left",
    )  # fmt: skip
    add_command(
        subparsers, _export, "export",
        argument("file", metavar="FILE", help="an archive"),
        argument("target", metavar="TARGET", help="a new .nc file, or .csv or .csv.gz for two tables"),
        names={"new": "TARGET", "target": "TARGET"},
        help="write an archive as netCDF-4 or as tables of text",
    )  # fmt: skip
    add_command(
        subparsers, _merge, "merge",
        argument("target", metavar="OUT", help="a new archive"),
        argument("files", metavar="FILE", nargs="+", help="archives with the same number of unknowns"),
        names={"new": "OUT"}, help="many archives as one",
    )  # fmt: skip


def _inspect(arguments: argparse.Namespace) -> int:
    from continuation.archive import describe, open_archive

    with open_archive(arguments.file) as archive:
        print(describe(archive), end="")
    return SUCCESS


def _resume(arguments: argparse.Namespace) -> int:
    from continuation.archive import open_archive, resume
    from continuation.archive.provenance import stored_parameters
    from continuation.budget import Budget
    from continuation.step.progress import Progress

    options: Options = {"budget": Budget(steps=arguments.steps)} if arguments.steps else {}
    homotopy = None
    if arguments.homotopy is not None:
        with open_archive(arguments.file) as archive:
            stored = stored_parameters(archive.attributes)
        homotopy, _ = homotopy_of(arguments.homotopy, arguments.options, stored)
    elif arguments.options:
        raise UsageError("KEY=VALUE", "expected no options without --homotopy")
    arguments.grows = arguments.file
    path = resume(
        arguments.file,
        homotopy,
        archive=arguments.archive,
        observers=(Progress(),) if arguments.progress else (),
        trust=arguments.trust,
        **options,
    )
    print(f"{path.status.name}: {path.message}")
    print(f"{len(path)} points, lam = {path.endpoint.lam:.6g}")
    return SUCCESS if path.success else FAILURE


def _named(path: str) -> Any:
    from continuation.archive.codec import registry

    try:
        trusted = plug_in(path)
        registry([trusted])
    except (TypeError, ValueError, plugins.PluginError) as error:
        reason = str(error).removeprefix("trust: ")
        expected = "expected module:name of a class or function"
        raise argparse.ArgumentTypeError(f"{expected}, found {path!r} ({reason})") from None
    return trusted


def _recheck(arguments: argparse.Namespace) -> int:
    from continuation.archive import recheck

    proofs = recheck(arguments.file, trust=arguments.trust)
    for number, proof in enumerate(proofs):
        print(f"path {number}: {proof}")
    return SUCCESS if proofs and all(proof.complete for proof in proofs) else FAILURE


def _recover(arguments: argparse.Namespace) -> int:
    from continuation.archive import open_archive, recover

    file = recover(arguments.file)
    with open_archive(file) as archive:
        print(f"{file}: {len(archive)} paths, {archive.points.size} points")
    return SUCCESS


def _export(arguments: argparse.Namespace) -> int:
    from continuation.archive import export

    print(*export(arguments.file, arguments.target), sep="\n")
    return SUCCESS


def _merge(arguments: argparse.Namespace) -> int:
    from continuation.archive import merge

    print(merge(arguments.files, arguments.target))
    return SUCCESS
