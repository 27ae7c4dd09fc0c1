"""Compare LCP methods: homotopies, predictors, finish, Lemke, modulus, min-Newton."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import continuation
from continuation.arrays import Array
from continuation.chart import Answer, Method, Problem, Profile, Study
from continuation.chart.model import answer_of
from continuation.chart.study import Size
from continuation.counts import Counts
from problems import lcp
from problems.charts import rivals
from problems.charts.families import planted
from problems.lcp import LCP
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.lcp.reference import min_newton, modulus
from problems.paper import EXAMPLES
from problems.scenes.rivals import Found, by_piqp, by_quantecon, by_tables

SOLVED_TO = 1e-6
"""Residual bound (`Certificate.solves`) for success, about as accurate as example 7 of the paper."""

RESIDUAL = {"natural_residual": "natural residual max |min(x, Ax + q)|, over 1 + max |q|"}

BUDGET = continuation.Budget(steps=200)
"""Budget of a path, or of `lcp.solve`: paths that arrive take half as many steps."""


def path(name: str, make: Callable[..., Any], **options: Any) -> Method:
    """Trace a homotopy from ``options['x0']`` or its own start, without finish."""

    def run(problem: Problem, rung: float) -> Answer:
        x0 = problem.options.get("x0")
        homotopy = make(problem.subject) if x0 is None else make(problem.subject, x0)
        answer = answer_of(continuation.trace(homotopy, **{"budget": BUDGET, **options, "tolerance": rung}))
        if answer.end is None:
            return answer
        return judged(problem.subject, answer.end[: problem.n], answer.counts, path=answer.path, message=answer.message)

    return Method(name, run)


def solver(name: str, **options: Any) -> Method:
    """`problems.lcp.solve`, with active-set finish."""

    def run(problem: Problem, rung: float) -> Answer:
        solution = lcp.solve(problem.subject, x0=problem.options.get("x0"), **{"budget": BUDGET, **options})
        if solution.x is None:
            return Answer(solution.counts, failure="stopped", message=solution.message)
        return judged(problem.subject, solution.x, solution.counts, message=solution.message)

    return Method(name, run)


def direct(name: str, solve: Callable[[Any], Found], cost: Callable[[int, int], Counts]) -> Method:
    """A solver without tolerance ladder; `cost` estimates its counts."""

    def run(problem: Problem, rung: float) -> Answer:
        try:
            x, iterations = solve(problem.subject)
        except ArithmeticError as error:
            return Answer(Counts(), failure="stopped", message=str(error))
        return judged(problem.subject, x, cost(iterations, problem.n))

    return Method(name, run, outside=True)


def pivots(k: int, n: int) -> Counts:
    """Lemke's pivots, 4 n^2 operations each, as factorisations of equal work."""
    return Counts(factorizations=-(-6 * k // n), solves=k, accepted=k)


def interior(k: int, n: int) -> Counts:
    """One factorisation, predictor and corrector solves per iteration."""
    return Counts(factorizations=k, solves=2 * k, accepted=k)


DIRECT = {
    "Lemke": ("", by_tables, pivots),
    "modulus": ("", modulus, lambda k, n: Counts(factorizations=1, solves=k, accepted=k)),
    "min-Newton": ("", min_newton, lambda k, n: Counts(factorizations=k, solves=k, accepted=k)),
    "quantecon Lemke": ("quantecon", by_quantecon, pivots),
    "PIQP": ("piqp", by_piqp, interior),
}
"""Required module, solver, cost of iterations."""


def direct_methods(compare: bool) -> list[Method]:
    """References, and installed outside solvers if `compare`."""
    taken = {name: one for name, one in DIRECT.items() if not one[0] or (compare and rivals.installed(one[0]))}
    for _, solve, _ in taken.values():
        # Warm up libraries that compile at first call.
        solve(LCP(np.eye(1), -np.ones(1)))
    return [direct(name, solve, cost) for name, (_, solve, cost) in taken.items()]


def judged(problem: LCP, x: Array, counts: Counts, **more: Any) -> Answer:
    """Answer with natural residual; fails if x is no solution."""
    size = 1.0 + float(np.abs(problem.q).max())
    residual = problem.natural_residual(x) / size if np.isfinite(x).all() else np.inf
    solved = np.isfinite(residual) and lcp.certify(problem, x).solves(SOLVED_TO)
    message, traced = more.pop("message", ""), more.get("path")
    unfinished = traced is not None and traced.status is not continuation.Status.REACHED_TARGET
    return Answer(
        counts,
        end=x,
        observed={"natural_residual": residual},
        failure="" if solved or unfinished else "wrong end",
        message=message if solved else f"natural residual {residual:.1e}; {message}",
        **more,
    )


def studies(size: Size, compare: bool) -> Sequence[Study]:
    """The ten examples."""
    rungs = {"smoke": (1e-6,), "moderate": (1e-4, 1e-8), "full": (1e-3, 1e-5, 1e-7, 1e-9)}[size]
    quick = (HOMOTOPIES["kkt"], HOMOTOPIES["wang"])
    examples = EXAMPLES[:3] if size == "smoke" else EXAMPLES
    return [
        Study(
            name="lcp-paper",
            title="The ten examples of Dutta, Das and Jana",
            problems=[
                Problem(f"example {e.number}", e.problem, options={"x0": e.x0}, family="ten examples") for e in examples
            ],
            methods=[
                *(path(one.title, one.make) for one in HOMOTOPIES.values()),
                *(path(f"{one.title}, series", one.make, preset=continuation.SERIES) for one in quick),
                solver("KKT, finish", homotopy="kkt"),
                solver("solve, auto"),
                *direct_methods(compare),
            ],
            ladder=rungs,
            errors=RESIDUAL,
            work=("factorizations", "solves"),
            figures=[Profile("factorizations")],
            repeats=0,
        )
    ]


def problem(family: str, n: int, seed: int) -> Problem:
    """Draw a study's problem."""
    subject = planted(family, n, seed)
    return Problem(f"{family}, n = {n}, seed {seed}", subject, family=family)
