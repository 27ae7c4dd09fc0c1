"""Methods for the LCP beside each other: homotopies, predictors, the finish, and Lemke, modulus, min-Newton."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import continuation
from continuation.arrays import Array
from continuation.chart import Answer, Failure, Method, Problem, Profile, Rung, Study, observed, tolerances
from continuation.chart.catalogue import Size
from continuation.chart.model import answer_of
from continuation.counts import Counts
from problems import lcp
from problems.charts import rivals
from problems.charts.families import planted
from problems.charts.rivals import Solved, Solver
from problems.lcp import LCP
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.reference import ReferenceResult, lemke, min_newton, modulus
from problems.paper import EXAMPLES

SOLVED_TO = 1e-6
"""What `Certificate.solves` is asked of an end before the run counts as a success."""

RESIDUAL = observed("natural_residual", "natural residual max |min(x, Ax + q)|, over 1 + max |q|")

BUDGET = continuation.Budget(steps=200)
"""Of one path."""

WHOLE_BUDGET = continuation.Budget(steps=400)
"""Of `lcp.solve`, all paths together."""

WORK = ("factorizations", "solves", "seconds")


def path(name: str, make: Callable[..., Any], **options: Any) -> Method:
    """A homotopy of the problem, from the problem's start (`options['x0']`) or its own, traced without a finish."""

    def run(problem: Problem, rung: Rung) -> Answer:
        x0 = problem.options.get("x0")
        homotopy = make(problem.subject) if x0 is None else make(problem.subject, x0)
        traced = continuation.trace(homotopy, **rung.apply({"budget": BUDGET, **options}))
        answer = answer_of(traced)
        if not traced.steps:
            return answer
        x = traced.endpoint.y[: problem.n]
        return judged(problem.subject, x, answer.counts, path=traced, message=answer.message)

    return Method(name, run)


def solver(name: str, **options: Any) -> Method:
    """`problems.lcp.solve`: the active-set finish before the path and along it."""

    def run(problem: Problem, rung: Rung) -> Answer:
        solution = lcp.solve(problem.subject, x0=problem.options.get("x0"), **{"budget": WHOLE_BUDGET, **options})
        if solution.x is None:
            return Answer(solution.counts, failure=Failure.STOPPED, message=solution.message)
        return judged(problem.subject, solution.x, solution.counts, message=solution.message)

    return Method(name, run, laddered=False)


def direct(name: str, solve: Solver) -> Method:
    """A solver that the ladder does not concern."""

    def run(problem: Problem, rung: Rung) -> Answer:
        x, counts, message = solve(problem.subject)
        if x is None:
            return Answer(counts, failure=Failure.STOPPED, message=message)
        return judged(problem.subject, x, counts, message=message)

    return Method(name, run, laddered=False, outside=True)


def references() -> list[Method]:
    """Lemke, modulus and min-Newton; a pivot of Lemke's tableau, 4 n^2 operations, counts as 6/n factorisations."""

    def counted(solve: Callable[[LCP], ReferenceResult], pivots: bool = False) -> Solver:
        def run(problem: LCP) -> Solved:
            result = solve(problem)
            work = -(-6 * result.iterations // problem.n) if pivots else result.factorizations
            counts = Counts(factorizations=work, solves=result.iterations, accepted=result.iterations)
            return result.x, counts, result.message

        return run

    return [
        direct("Lemke", counted(lemke, pivots=True)),
        direct("modulus", counted(modulus)),
        direct("min-Newton", counted(min_newton)),
    ]


def outside(compare: bool) -> list[Method]:
    """The installed solvers of other packages, if they are asked for."""
    return [direct(name, solve) for name, solve in rivals.lcp_solvers().items()] if compare else []


def judged(problem: LCP, x: Array, counts: Counts, **more: Any) -> Answer:
    """An answer with its natural residual, and a failure where x does not solve the problem."""
    size = 1.0 + float(np.abs(problem.q).max())
    residual = problem.natural_residual(x) / size if np.isfinite(x).all() else np.inf
    solved = np.isfinite(residual) and lcp.certify(problem, x).solves(SOLVED_TO)
    message, traced = more.pop("message", ""), more.get("path")
    # Where the path did not arrive, its status says so already.
    unfinished = traced is not None and traced.status is not continuation.Status.REACHED_TARGET
    return Answer(
        counts,
        end=x,
        observed={"natural_residual": residual},
        failure=Failure.NONE if solved or unfinished else Failure.WRONG_END,
        message=message if solved else f"natural residual {residual:.1e}; {message}",
        **more,
    )


def studies(size: Size, compare: bool) -> Sequence[Study]:
    """The ten examples, and generated families over sizes."""
    rungs = {"smoke": (1e-6,), "moderate": (1e-4, 1e-8), "full": (1e-3, 1e-5, 1e-7, 1e-9)}[size]
    homotopies = [path(one.title, one.make) for one in HOMOTOPIES.values()]
    quick = (HOMOTOPIES["kkt"], HOMOTOPIES["wang"])
    series = [path(f"{one.title}, series", one.make, preset=continuation.SERIES) for one in quick]
    whole = [solver("KKT, finish", homotopy="kkt"), solver("solve, auto")]
    common: dict[str, Any] = {
        "methods": [*homotopies, *series, *whole, *references(), *outside(compare)],
        "ladder": tolerances(*rungs),
        "errors": (RESIDUAL,),
        "work": WORK if size == "full" else WORK[:2],
        "repeats": 3 if size == "full" else 0,
        "notes": rivals.lcp_notes(compare),
    }
    examples = EXAMPLES[:3] if size == "smoke" else EXAMPLES
    paper = [Problem(f"example {e.number}", e.problem, options={"x0": e.x0}, family="ten examples") for e in examples]
    orders = {"smoke": (5,), "moderate": (10, 100), "full": (5, 10, 50, 100, 200, 500, 1000)}[size]
    families = ("semidefinite",) if size == "smoke" else ("semidefinite", "scaled P", "copositive")
    generated = [problem(family, n, 0) for family in families for n in orders]
    return [
        Study(name="lcp-paper", title="The ten examples of Dutta, Das and Jana", problems=paper,
              figures=[Profile("factorizations")], **common),
        Study(name="lcp-generated", title="Generated problems", problems=generated, give_up=True, **common),
    ]  # fmt: skip


def problem(family: str, n: int, seed: int) -> Problem:
    """A generated problem of a study."""
    subject = planted(family, n, seed)
    return Problem(f"{family}, n = {n}, seed {seed}", subject, family=family, seed=seed)
