"""``continuation solve scene NAME KEY=VALUE``."""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np

from continuation.arguments.plugins import SCENES
from continuation.cli import FAILURE, SUCCESS, UsageError
from continuation.cli.figures import check_picture, save
from continuation.cli.making import homotopy_of
from continuation.cli.parser import paint

WORD = "scene"
"""Replaces FILE."""

_NOT_FOR_SCENES = ("q", "x0", "archive", "restarts")


def run(arguments: argparse.Namespace) -> int:
    """Solve the scene and print its answer."""
    if not arguments.scene:
        raise UsageError("NAME", "expected the name of a scene, found none; `continuation plugins` lists them")
    for option in _NOT_FOR_SCENES:
        if getattr(arguments, option) is not None:
            raise UsageError(f"--{option}", "expected a problem in a file, found a scene")
    name, *texts = arguments.scene
    if arguments.plot is not None:
        check_picture("--plot", arguments.plot)
    scene, values = homotopy_of(name, texts, group=SCENES)
    title = " ".join([name, *(f"{key}={value}" for key, value in values.items())])
    from problems.scenes import order, solve

    arguments.plugin, arguments.name = "name", name
    problem = scene.problem()
    solution = solve(scene)
    # A scene's own path may end on a ray (collapse), which `answer` interprets.
    well = getattr(scene, "solve", None) is not None or bool(solution.success)
    answer = scene.answer(solution) if well else {}
    if arguments.json:
        found = {key: np.asarray(value, dtype=float).tolist() for key, value in answer.items()}
        print(json.dumps({"scene": title, "unknowns": order(problem), "solved": well, "answer": found}))
    else:
        print("\n".join(_as_text(title, scene, order(problem), well, answer)))
    if arguments.plot is not None and well:
        save(arguments.plot, None, title, lambda axes: scene.draw(solution, axes))
    return SUCCESS if well else FAILURE


def _as_text(title: str, scene: Any, unknowns: int, well: bool, answer: Any) -> list[str]:
    lines = [f"scene      {title}", f"outcome    {paint('solved' if well else 'not solved', well)}"]
    lines.append(f"unknowns   {unknowns}")
    lines += [f"           {kind.count} {kind.name}: {kind.why}" for kind in scene.unknowns]
    lines.append("")
    wide = max((len(name) for name in answer), default=0)
    for name, value in answer.items():
        values = np.atleast_1d(np.asarray(value, dtype=float)).ravel()
        shown = ", ".join(f"{v:.10g}" for v in values[:10]) + (", ..." if values.size > 10 else "")
        lines.append(f"{name:{wide}}  {shown or 'none'} {scene.units.get(name, '')}".rstrip())
    return lines
