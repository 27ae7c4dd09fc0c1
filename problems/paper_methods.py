"""Every method on the ten examples, from the paper's starts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from continuation.chart import Answer, Method, Problem, Results, Row, Study, run
from continuation.chart.table import Cell, Table
from continuation.counts import Counts
from problems.charts.lcp import DIRECT, RESIDUAL, direct, path
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.literal import run_literally
from problems.paper import Example


def _literal(problem: Problem, rung: float) -> Answer:
    x0, z = problem.options["x0"], problem.options["z"]
    done = run_literally(problem.subject, x0, z, z)
    failure = "" if done.solved else "wrong end" if done.claims_solution else "stopped"
    observed = {"natural_residual": done.residual}
    return Answer(Counts(accepted=done.iterations), observed=observed, failure=failure, message=done.ended_by)


METHODS: Mapping[str, Method] = {
    **{name: path(name, one.make) for name, one in HOMOTOPIES.items()},
    "literal": Method("literal", _literal, outside=True),
    **{name: direct(name, *DIRECT[title][1:]) for name, title in
       (("lemke", "Lemke"), ("modulus", "modulus"), ("min-newton", "min-Newton"))},
}  # fmt: skip
"""Methods by command-line name."""


def compare(examples: Iterable[Example], names: Sequence[str]) -> Results:
    """Run named `METHODS` on all examples."""
    problems = [
        Problem(str(one.number), one.problem, options={"x0": one.x0, "z": one.z1}, family="ten examples")
        for one in examples
    ]
    return run(
        Study(
            name="methods",
            problems=problems,
            methods=[METHODS[name] for name in names],
            ladder=(1e-6,),
            errors=RESIDUAL,
            repeats=0,
        )
    )


def matrix(results: Results) -> str:
    """Table of methods by examples: work, or reason of failure."""
    lines = [(method, *map(_cell, results.of(method=method))) for method in results.methods]
    return Table(("example", *results.problems), lines).text()


_SHORT = {
    "wrong end": "stat.", "diverged": "div.", "stopped": "-", "step too small": "small",
    "turned back": "back", "singular start": "sing.",
}  # fmt: skip

LEGEND = (
    "A number: solved with so many factorisations (homotopies), iterations or pivots. stat.: ends at a KKT point that "
    "solves nothing. div.: runs off to infinity. back: comes back to lambda = 1. -: no solution found."
)


def _cell(row: Row) -> Cell:
    if row.failed:
        return _SHORT.get(row.failure, row.failure)
    return row.counts.accepted if row.outside else row.counts.factorizations
