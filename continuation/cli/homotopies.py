"""``continuation plugins``, ``trace`` and ``check``."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from continuation.arguments import plugins
from continuation.cli.making import homotopy_of, plug_in
from continuation.cli.parser import (
    FAILURE,
    SUCCESS,
    Subparsers,
    above_zero,
    add_command,
    argument,
    paint,
    parsed,
    positive,
)

if TYPE_CHECKING:
    from continuation.path import Path

PRESETS = ("fast", "default", "conservative", "series")


def register(subparsers: Subparsers) -> None:
    """Add the commands."""
    homotopy = (
        argument("name", metavar="NAME", help="as listed by `continuation plugins`, or module:object"),
        argument("options", metavar="KEY=VALUE", nargs="*", help="options of the homotopy"),
    )
    add_command(
        subparsers, _list, "plugins",
        argument("name", metavar="NAME", nargs="?", help="one of them, with its references in full"),
        help="homotopies and scenes that are installed, with their options",
    )  # fmt: skip
    add_command(
        subparsers, _trace, "trace", *homotopy,
        argument("--archive", metavar="FILE", help="write the path to this HDF5 file, which must not exist"),
        argument("--plot", metavar="FILE", help="draw it (.png, .pdf, .svg); needs matplotlib"),
        argument("--progress", action="store_true", help="show the progress on stderr"),
        argument("--preset", choices=PRESETS, default="default", help="predictor, corrector and controller"),
        argument("--target", metavar="LAM", type=_target, default="homotopy", help="where the path is to end, or none"),
        argument("--direction", type=int, choices=(-1, 1), default=0, help="of the parameter's first movement"),
        argument("--tolerance", metavar="EPS", type=above_zero, default=1e-8, help="default: 1e-8"),
        argument("--turning-points", metavar="N", type=positive, help="end at the N-th turning point"),
        argument("--budget-steps", metavar="N", type=positive, help="accepted steps; default: 10000"),
        argument("--budget-seconds", metavar="S", type=above_zero, help="wall-clock time; default: no limit"),
        argument("--json", action="store_true", help="print everything as one JSON object"),
        names={"new": "--archive", "old": "--archive"}, plugin="name",
        help="follow the path of a homotopy by its name",
        description="Exit status: 0 if the path ended at its target, at an event or closed, 1 if not, 2 bad input.",
    )  # fmt: skip
    add_command(
        subparsers, _check, "check", *homotopy,
        argument("--steps", metavar="N", type=positive, help="of the path looked at; default: 60, 12 no target"),
        plugin="name", help="run the conformance suite on a homotopy",
        description="Every check that its capabilities call for. Exit status: 0 if all pass, 1 if not, 2 bad input.",
    )  # fmt: skip


def _list(arguments: argparse.Namespace) -> int:
    scenes = plugins.available(plugins.SCENES)
    known = {**plugins.available(), **scenes}
    if arguments.name is not None:
        described = plugins.describe(
            plug_in(arguments.name, plugins.SCENES if arguments.name in scenes else plugins.GROUP)
        )
        print("\n\n".join((_entry(arguments.name, described, known.get(arguments.name)), *described.references)))
        return SUCCESS
    broken = []
    for name, plugin in known.items():
        try:
            print(_entry(name, plugins.describe(plugin.load()), plugin))
        except plugins.PluginError as error:
            broken.append(f"cannot be used: {error}\n")
    print("".join(broken), end="", file=sys.stderr)
    return SUCCESS


def _entry(name: str, described: plugins.Description, plugin: plugins.Plugin | None) -> str:
    from continuation.citation import key

    said = {
        "options": ", ".join(described.options) or "none",
        "a scene": f"continuation solve scene {name}" if plugin is not None and plugin.kind == "scene" else "",
        "for": described.problem_class,
        "reference": ", ".join(map(key, described.references)),
        "from": name if plugin is None else plugin.origin,
    }
    lines = (f"{word}: {text}" for word, text in said.items() if text)
    return "\n    ".join([name, described.summary, *lines])


def _trace(arguments: argparse.Namespace) -> int:
    from continuation.archive import PathLog
    from continuation.budget import Budget
    from continuation.events import TurningPoint
    from continuation.step import presets
    from continuation.tracing import trace

    homotopy, values = homotopy_of(arguments.name, arguments.options)
    if arguments.plot is not None:
        from continuation.cli.figures import check_picture

        check_picture("--plot", arguments.plot)
    log = None if arguments.archive is None else PathLog(arguments.archive, parameters=values)
    limits = {"steps": arguments.budget_steps, "seconds": arguments.budget_seconds}
    path = trace(
        homotopy,
        archive=log,
        progress=arguments.progress,
        preset=getattr(presets, arguments.preset.upper()),
        target=arguments.target,
        tolerance=arguments.tolerance,
        direction=arguments.direction,
        events=[TurningPoint(terminal=arguments.turning_points)] if arguments.turning_points else [],
        budget=Budget(**{name: value for name, value in limits.items() if value is not None}),
    )
    title = " ".join([arguments.name, *(f"{key}={value}" for key, value in values.items())])
    print(json.dumps(_as_json(title, path)) if arguments.json else "\n".join(_as_text(title, path)))
    if arguments.plot is not None:
        from continuation.cli.figures import save
        from continuation.plot import plot_components

        save(arguments.plot, path, f"{title}: {path.status.name}", lambda axes: plot_components(path, axes))
    return SUCCESS if path.success else FAILURE


def _as_text(title: str, path: Path) -> Iterator[str]:
    yield f"homotopy   {title}"
    yield f"status     {paint(path.status.name, path.success)}"
    yield f"           {path.message}"
    for event in path.events:
        yield f"event      {event.name}: lam = {event.lam:.12g}, arclength {event.arclength:.6g}"
    counts = ", ".join(f"{value} {name}" for name, value in path.counts.as_dict().items())
    yield f"work       {counts}; {path.seconds:.2g} s"
    if path.steps:
        yield f"end        lam = {path.endpoint.lam:.12g}"
        yield f"           y = {', '.join(f'{value:.12g}' for value in path.endpoint.y[:10])}"


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


def _check(arguments: argparse.Namespace) -> int:
    from continuation.testing import run_checks

    homotopy, _ = homotopy_of(arguments.name, arguments.options)
    results = run_checks(homotopy, steps=arguments.steps)
    for result in results:
        outcome = paint(f"{result.outcome:8}", result.outcome == "passed")
        print(f"{outcome} {result.name}" + (f"\n         {result.message}" if result.message else ""))
    failed = sum(result.outcome != "passed" for result in results)
    print(f"\n{len(results) - failed} of {len(results)} checks passed.")
    return FAILURE if failed else SUCCESS


def _target(text: str) -> float | str | None:
    if text.lower() in ("none", "homotopy"):
        return None if text.lower() == "none" else "homotopy"
    return parsed(text, float, math.isfinite, "a finite number or none")
