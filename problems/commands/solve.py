"""``continuation solve FILE``: an LCP, bounded problem, QP, or scene."""

from __future__ import annotations

import argparse
import json
import math
from typing import Any

import numpy as np

from continuation.arguments.plugins import SCENES
from continuation.arrays import Array
from continuation.cli import FAILURE, SUCCESS, Subparsers, UsageError
from continuation.cli.figures import check_picture, save
from continuation.cli.making import homotopy_of
from continuation.cli.parser import above_zero, add_command, argument, paint, parsed
from problems.commands.arguments import PROBLEM_FORMATS, file_of
from problems.lcp.homotopies.registry import HOMOTOPIES

SCENE = "scene"
"""Replaces FILE."""

MOST_ROWS = 60
"""Printed components; --json prints all."""


def register(subparsers: Subparsers) -> None:
    """Add the command."""
    formats = f"{PROBLEM_FORMATS}; - for stdin"
    add_command(
        subparsers, run, "solve",
        argument("file", metavar="FILE", help=formats),
        argument("scene", metavar="NAME KEY=VALUE", nargs="*", help=f"after {SCENE}: which, its parameters"),
        argument("--q", metavar="FILE", help="q in a file of its own"),
        argument("--homotopy", choices=("auto", *HOMOTOPIES), default="auto", help="default: auto"),
        argument("--x0", metavar="FILE", help="the start, x0 > 0; what A x0 + q lacks is relaxed away"),
        argument("--path", action="store_true", help="trace a path even where none is needed"),
        argument("--archive", metavar="FILE", help="write the paths to this new HDF5 file; implies --path"),
        argument("--plot", metavar="FILE", help="draw x against lambda (.png, .pdf, .svg); implies --path"),
        argument("--tolerance", metavar="EPS", type=_tolerance, default=1e-8, help="default: 1e-8"),
        argument("--restarts", metavar="N", type=_counted, help="random starts at most; default: 1000 with auto"),
        argument("--seed", metavar="N", type=_counted, default=0, help="of the random starts; default: 0"),
        argument("--budget-seconds", "--seconds", dest="seconds", metavar="S", type=above_zero,
                 help="wall-clock time; default: work that takes about a minute"),
        argument("--progress", action="store_true", help="show the progress on stderr"),
        argument("--json", action="store_true", help="print everything as one JSON object"),
        names={"path": "FILE", "A": "FILE", "old": "--archive", "new": "--archive",
               **{name: f"--{name}" for name in ("q", "x0", "archive", "homotopy", "seconds")}},
        help="solve a linear complementarity problem, with bounds or not, or a quadratic program",
        description="Find x >= 0 with w = A x + q >= 0 and x_i w_i = 0; with bounds in the file, x between them. "
        "Or minimise 1/2 x'P x + c'x under the constraints in the file. With the word scene for the file: a scene of "
        "`continuation plugins` by its name, and its answer. Exit status: 0 solved, 1 not, 2 bad input.",
    )  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    """Read, solve, print."""
    from continuation.budget import Budget
    from problems import lcp
    from problems.lcp.data.files import read_problem, read_vector

    if arguments.file == SCENE:
        return _run_scene(arguments)
    if arguments.scene:
        raise UsageError("unrecognized arguments", " ".join(arguments.scene))
    if arguments.plot is not None:
        check_picture("--plot", arguments.plot)
    with file_of(arguments.file) as file:
        given = read_problem(file, arguments.q)
        problem = given.problem if isinstance(given, lcp.Program) else given
        x0 = None if arguments.x0 is None else read_vector("x0", arguments.x0, problem.n)
        budget = None if arguments.seconds is None else Budget(math.inf, arguments.seconds)
        solution = lcp.solve(
            given,
            homotopy=arguments.homotopy,
            x0=x0,
            tolerance=arguments.tolerance,
            restarts=arguments.restarts,
            seed=arguments.seed,
            path=arguments.path or arguments.plot is not None,
            archive=arguments.archive,
            budget=budget,
            progress=arguments.progress,
        )
    print(json.dumps(_as_json(arguments, solution)) if arguments.json else _as_text(arguments, problem, solution))
    if arguments.plot is not None:
        _draw(solution, problem.n, arguments.plot)
    return SUCCESS if solution.success else FAILURE


def _tolerance(text: str) -> float:
    return parsed(text, float, lambda value: 0.0 < value < 1.0, "a number between 0 and 1")


def _counted(text: str) -> int:
    return parsed(text, int, lambda value: value >= 0, "an integer, at least 0")


def _as_json(arguments: argparse.Namespace, solution: Any) -> dict[str, Any]:
    named = {name: _numbers(values) for name, values in solution.named.items()}
    program = {} if solution.program is None else {"objective": _number(solution.objective), "named": named}
    return {
        "file": arguments.file,
        "homotopy": arguments.homotopy,
        "outcome": solution.outcome.name,
        "message": solution.message,
        **program,
        "x": _numbers(solution.x),
        "w": _numbers(solution.w),
        "residual": _number(solution.residual),
        "relative_residual": _number(solution.relative_residual),
        "paths": len(solution.paths),
        "counts": solution.counts.as_dict(),
        "seconds": solution.seconds,
    }


def _numbers(vector: Array | None) -> list[float | None] | None:
    return None if vector is None else [_number(value) for value in vector]


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _as_text(arguments: argparse.Namespace, problem: Any, solution: Any) -> str:
    counts = ", ".join(f"{value} {name}" for name, value in solution.counts.as_dict().items())
    lines = [
        f"problem    {arguments.file}, n = {problem.n}, {'sparse' if problem.sparse else 'dense'}",
        f"homotopy   {arguments.homotopy}",
        f"outcome    {paint(solution.outcome.name, solution.success)}",
        f"           {solution.message}",
        f"residual   {solution.residual:.2e}, relative {solution.relative_residual:.2e}",
        f"work       {len(solution.paths)} paths, {counts}; {solution.seconds:.2g} s",
    ]
    if solution.program is not None and solution.x is not None:
        lines.insert(4, f"objective  {solution.objective:.15g}")
        for name, values in solution.named.items():
            lines += ["", f"{'i':>6}  {name:>22}"]
            lines += [f"{i:>6}  {value:>22.15g}" for i, value in enumerate(values[:MOST_ROWS])]
    elif solution.x is not None:
        lines += ["", f"{'i':>6}  {'x':>22}  {'w':>22}"]
        lines += [
            f"{i:>6}  {x:>22.15g}  {w:>22.15g}"
            for i, (x, w) in enumerate(zip(solution.x[:MOST_ROWS], solution.w[:MOST_ROWS]))
        ]
        if problem.n > MOST_ROWS:
            lines.append(f"{'...':>6}  {problem.n - MOST_ROWS} more; --json prints all")
    return "\n".join(lines)


def _draw(solution: Any, n: int, file: str) -> None:
    from continuation.plot import MOST_COMPONENTS, plot_components

    components = range(min(n, MOST_COMPONENTS))
    names = [f"$x_{{{i}}}$" for i in components]

    path = solution.path
    save(file, path, "", lambda axes: plot_components(path, axes, names=names, components=components))


def _run_scene(arguments: argparse.Namespace) -> int:
    if not arguments.scene:
        raise UsageError("NAME", "expected the name of a scene, found none; `continuation plugins` lists them")
    for option in ("q", "x0", "archive", "restarts"):
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
        print("\n".join(_scene_as_text(title, scene, order(problem), well, answer)))
    if arguments.plot is not None and well:
        save(arguments.plot, None, title, lambda axes: scene.draw(solution, axes))
    return SUCCESS if well else FAILURE


def _scene_as_text(title: str, scene: Any, unknowns: int, well: bool, answer: Any) -> list[str]:
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
