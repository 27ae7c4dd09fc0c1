"""``continuation plugins``, ``trace`` and ``check``: homotopies by name, from any installed package."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from continuation.arguments import plugins
from continuation.cli.archives import complaints
from continuation.cli.making import homotopy_of, refused, unknown
from continuation.cli.parser import FAILURE, SUCCESS, Subparsers, above_zero, paint, parsed, positive

if TYPE_CHECKING:
    from continuation.budget import Budget
    from continuation.path import Path
    from continuation.testing import Result

PRESETS = ("fast", "default", "conservative", "series")

MOST_PRINTED = 10
"""Unknowns printed; --json prints all."""


def register(subparsers: Subparsers) -> None:
    """Add the commands."""
    parser = subparsers.add_parser("plugins", help="homotopies and scenes that are installed, with their options")
    parser.add_argument("name", metavar="NAME", nargs="?", help="one of them, with its references in full")
    parser.set_defaults(run=_list)

    parser = subparsers.add_parser(
        "trace",
        help="follow the path of a homotopy by its name",
        description="Exit status: 0 if the path ended at its target, at an event or closed, 1 if not, 2 bad input.",
    )
    _add_homotopy(parser)
    parser.add_argument("--archive", metavar="FILE", help="write the path to this HDF5 file, which must not exist")
    parser.add_argument("--plot", metavar="FILE", help="draw it (.png, .pdf, .svg); needs matplotlib")
    parser.add_argument("--progress", action="store_true", help="show the progress on stderr")
    parser.add_argument("--preset", choices=PRESETS, default="default", help="predictor, corrector and controller")
    parser.add_argument("--target", metavar="LAM", type=_number_or_none, help="where the path is to end, or none")
    parser.add_argument("--direction", type=int, choices=(-1, 1), help="of the parameter's first movement")
    parser.add_argument("--tolerance", metavar="EPS", type=above_zero, default=1e-8, help="default: 1e-8")
    parser.add_argument("--turning-points", metavar="N", type=positive, help="end at the N-th turning point")
    parser.add_argument("--budget-steps", metavar="N", type=positive, help="accepted steps; default: 10000")
    parser.add_argument("--budget-seconds", metavar="S", type=above_zero, help="wall-clock time; default: no limit")
    parser.add_argument("--json", action="store_true", help="print everything as one JSON object")
    parser.add_argument("--cite", action="store_true", help="print BibTeX for what the run used as well")
    parser.set_defaults(run=_trace)

    parser = subparsers.add_parser(
        "check",
        help="run the conformance suite on a homotopy",
        description="Every check that its capabilities call for. Exit status: 0 if all pass, 1 if not, 2 bad input.",
    )
    _add_homotopy(parser)
    parser.add_argument("--steps", metavar="N", type=positive, help="of the path looked at; default: 60, 12 no target")
    parser.set_defaults(run=_check)


def _add_homotopy(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("name", metavar="NAME", help="as listed by `continuation plugins`, or module:object")
    parser.add_argument("options", metavar="KEY=VALUE", nargs="*", help="options of the homotopy")


# -- plugins --------------------------------------------------------------------------------------------------


def _list(arguments: argparse.Namespace) -> int:
    scenes = plugins.available(plugins.SCENES)
    known = {**plugins.available(), **scenes}
    if arguments.name is not None:
        with unknown(arguments.name):
            factory = plugins.find(arguments.name, plugins.SCENES if arguments.name in scenes else plugins.GROUP)
        described = plugins.describe(factory)
        origin = known[arguments.name].origin if arguments.name in known else arguments.name
        kind = known[arguments.name].kind if arguments.name in known else ""
        references = (f"\n{entry}" for entry in described.references)
        print("\n".join([*_entry(arguments.name, described, origin, kind), *references]))
        return SUCCESS
    broken = []
    for name, plugin in known.items():
        try:
            print("\n".join(_entry(name, plugins.describe(plugin.load()), plugin.origin, plugin.kind)))
        except plugins.PluginError as error:
            broken.append(str(error))
    for complaint in broken:
        print(f"cannot be used: {complaint}", file=sys.stderr)
    return SUCCESS


def _entry(name: str, described: plugins.Description, origin: str, kind: str) -> list[str]:
    options = ", ".join(map(str, described.options)) or "none"
    lines = [f"{name}", f"    {described.summary}", f"    options: {options}"]
    if kind == "scene":
        lines.append(f"    a scene: continuation solve scene {name}")
    if described.problem_class:
        lines.append(f"    for: {described.problem_class}")
    if described.references:
        from continuation.citation import short

        lines.append(f"    reference: {'; '.join(map(short, described.references))}")
    return [*lines, f"    from: {origin}"]


# -- trace ----------------------------------------------------------------------------------------------------


def _trace(arguments: argparse.Namespace) -> int:
    from continuation.archive import PathLog
    from continuation.step import presets
    from continuation.tracing import trace

    homotopy, values = homotopy_of(arguments.name, arguments.options)
    if arguments.plot is not None:
        from continuation.cli.figures import check_picture

        check_picture("--plot", arguments.plot)
    with complaints("--archive", new="--archive"):
        log = None if arguments.archive is None else PathLog(arguments.archive, parameters=values)
    preset = getattr(presets, arguments.preset.upper())
    with refused(arguments.name), complaints("--archive", new="--archive"):
        path = trace(
            homotopy,
            archive=log,
            progress=arguments.progress,
            preset=preset,
            tolerance=arguments.tolerance,
            budget=_budget(arguments),
            **_course(arguments),
        )
    title = " ".join([arguments.name, *(f"{key}={value}" for key, value in values.items())])
    print(json.dumps(_as_json(title, path)) if arguments.json else "\n".join(_as_text(title, path)))
    if arguments.cite:
        from continuation.citation import cite

        # The one JSON object has stdout for itself.
        print(f"\n{cite(path)}", file=sys.stderr if arguments.json else sys.stdout)
    if arguments.plot is not None:
        from continuation.cli.figures import save
        from continuation.plot import plot_components

        save(arguments.plot, path, f"{title}: {path.status.name}", lambda axes: plot_components(path, axes))
    return SUCCESS if path.success else FAILURE


def _course(arguments: argparse.Namespace) -> dict[str, Any]:
    """Which path: the options of `continuation.trace` that say where it goes and ends."""
    from continuation.events import TurningPoint

    course: dict[str, Any] = {"direction": arguments.direction or 0}
    if arguments.target is not None:
        course["target"] = None if math.isnan(arguments.target) else arguments.target
    if arguments.turning_points is not None:
        course["events"] = [TurningPoint(terminal=arguments.turning_points)]
    return course


def _budget(arguments: argparse.Namespace) -> Budget:
    from continuation.budget import Budget

    given = {"steps": arguments.budget_steps, "seconds": arguments.budget_seconds}
    return Budget(**{name: value for name, value in given.items() if value is not None})


def _as_text(title: str, path: Path) -> Iterator[str]:
    yield f"homotopy   {title}"
    yield f"status     {paint(path.status.name, path.success)}"
    yield f"           {path.message}"
    for event in path.events:
        yield f"event      {event.name}: lam = {event.lam:.12g}, arclength {event.arclength:.6g}"
    counts = ", ".join(f"{value} {name}" for name, value in path.counts.as_dict().items())
    yield f"work       {counts}; {path.seconds:.2g} s"
    if path.steps:
        y = path.endpoint.y
        shown = ", ".join(f"{value:.12g}" for value in y[:MOST_PRINTED])
        more = f", ... ({y.size - MOST_PRINTED} more; --json prints all)" if y.size > MOST_PRINTED else ""
        yield f"end        lam = {path.endpoint.lam:.12g}"
        yield f"           y = {shown}{more}"


def _as_json(title: str, path: Path) -> dict[str, Any]:
    end = path.endpoint if path.steps else None
    return {
        "homotopy": title,
        "status": path.status.name,
        "message": path.message,
        "points": len(path),
        "lam": None if end is None else end.lam,
        "y": None if end is None else end.y.tolist(),
        "events": [{"name": e.name, "lam": e.lam, "arclength": e.arclength, "y": e.y.tolist()} for e in path.events],
        "counts": path.counts.as_dict(),
        "seconds": path.seconds,
    }


# -- check ----------------------------------------------------------------------------------------------------


def _check(arguments: argparse.Namespace) -> int:
    from continuation.testing import run_checks

    homotopy, _ = homotopy_of(arguments.name, arguments.options)
    with refused(arguments.name):
        results = run_checks(homotopy, steps=arguments.steps)
    for result in results:
        print(_line(result))
    failed = sum(result.outcome != "passed" for result in results)
    print(f"\n{len(results) - failed} of {len(results)} checks passed.")
    return FAILURE if failed else SUCCESS


def _line(result: Result) -> str:
    outcome = paint(f"{result.outcome:8}", result.outcome == "passed")
    return f"{outcome} {result.name}" + (f"\n         {result.message}" if result.message else "")


def _number_or_none(text: str) -> float:
    """A number; NaN stands for no target, so that it differs from an option not given."""
    if text.lower() == "none":
        return math.nan
    return parsed(text, float, math.isfinite, "a finite number or none")
