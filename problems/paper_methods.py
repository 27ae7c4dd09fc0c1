"""Who solves what: every method of the library on the ten examples, each from the paper's start where it takes one."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path as File

from attrs import asdict, field, frozen

import continuation
from continuation.chart.table import Cell, Table
from problems.lcp.data.problem import LCP
from problems.lcp.homotopies.registry import HOMOTOPIES, Registered
from problems.lcp.proof.certificate import certify
from problems.lcp.reference import ReferenceResult, lemke, min_newton, modulus
from problems.literal import run_literally
from problems.paper import Example
from problems.paper_report import SOLVED_TO


@frozen
class Result:
    """What one method did on one example.

    Attributes
    ----------
    example : int
    method, outcome : str
        SOLVED, STATIONARY (lambda = 0 reached at a point that does not solve the LCP), the status of a path that did
        not arrive, or NOT_FOUND.
    residual : float
        The natural residual of the last x; infinite without one.
    work : int
        Factorisations of a homotopy; iterations or pivots of the others.
    turns : int
        Turning points in lambda.
    message : str
    """

    example: int
    method: str
    outcome: str
    residual: float
    work: int
    turns: int = 0
    message: str = field(default="")

    @property
    def solved(self) -> bool:
        """Whether the certificate holds."""
        return self.outcome == "SOLVED"


Method = Callable[[Example], Result]


def _homotopy(homotopy: Registered) -> Method:
    def run(example: Example) -> Result:
        path = continuation.trace(homotopy.make(example.problem, example.x0))
        x = path.endpoint.y[: example.q.size]
        outcome = path.status.name
        if certify(example.problem, x).solves(SOLVED_TO):
            outcome = "SOLVED"
        elif path.status is continuation.Status.REACHED_TARGET:
            outcome = "STATIONARY"
        residual = example.problem.natural_residual(x)
        turns = len(path.turning_points)
        return Result(example.number, homotopy.name, outcome, residual, path.counts.factorizations, turns, path.message)

    return run


def _literal(example: Example) -> Result:
    run = run_literally(example.problem, example.x0, example.z1, example.z2)
    outcome = "SOLVED" if run.solved else "STATIONARY" if run.claims_solution else "NOT_FOUND"
    return Result(example.number, "literal", outcome, run.residual, run.iterations, 0, run.ended_by)


def _reference(name: str, solve: Callable[[LCP], ReferenceResult]) -> Method:
    def run(example: Example) -> Result:
        result = solve(example.problem)
        outcome = "SOLVED" if result.solved else "NOT_FOUND"
        return Result(example.number, name, outcome, result.residual, result.iterations, 0, result.message)

    return run


METHODS: Mapping[str, Method] = {
    **{name: _homotopy(homotopy) for name, homotopy in HOMOTOPIES.items()},
    "literal": _literal,
    "lemke": _reference("lemke", lemke),
    "modulus": _reference("modulus", modulus),
    "min-newton": _reference("min-newton", min_newton),
}
"""By the name that the command line takes."""


def compare(examples: Iterable[Example], names: Sequence[str]) -> list[Result]:
    """Every named method on every example; the names are of `METHODS`."""
    return [METHODS[name](example) for example in examples for name in names]


def matrix(results: Sequence[Result]) -> str:
    """A line a method, a column an example: the work of those that solve it, in words why the others do not."""
    numbers = sorted({result.example for result in results})
    names = list(dict.fromkeys(result.method for result in results))
    cell = {(result.method, result.example): _cell(result) for result in results}
    lines = [(name, *(cell[name, number] for number in numbers)) for name in names]
    return Table(("example", *map(str, numbers)), lines).text()


_SHORT = {
    "STATIONARY": "stat.", "DIVERGED": "div.", "NOT_FOUND": "-", "STEP_TOO_SMALL": "small", "TURNED_BACK": "back",
    "BUDGET_EXHAUSTED": "budget", "SINGULAR_START": "sing.",
}  # fmt: skip

LEGEND = (
    "A number: solved with so many factorisations (homotopies), iterations or pivots. stat.: ends at a KKT point that "
    "solves nothing. div.: runs off to infinity. back: comes back to lambda = 1. -: no solution found."
)


def _cell(result: Result) -> Cell:
    return result.work if result.solved else _SHORT.get(result.outcome, result.outcome.lower())


def write_csv(results: Iterable[Result], file: str | PathLike[str]) -> None:
    """All of it, one line a result."""
    lines = [asdict(result) for result in results]
    with File(file).open("w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, lines[0])
        writer.writeheader()
        writer.writerows(lines)
