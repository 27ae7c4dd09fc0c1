"""What a step costs: time, calls, factorisations.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/size/step.py [NAME ...]

Beside another checkout: the same with that in PYTHONPATH, in turns. Calls of functions, Python's and numpy's, are
counted exactly, whatever else runs.
"""

import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

PROBLEMS = (
    "circle", "cusp", "freudenstein-roth", "bratu-1d", "aircraft", "brown", "exponential-cosine-3",
    "exponential-cosine-10", "example-1", "example-10",
)  # fmt: skip


def problem(name: str) -> tuple[Any, dict[str, Any]]:
    """An acceptance problem, and the options of its trace."""
    import continuation
    from problems import bifurcation, lcp, nonlinear
    from problems.paper import EXAMPLES

    kind, _, number = name.rpartition("-")
    if kind == "exponential-cosine":
        return bifurcation.ExponentialCosine(int(number)), {}
    if kind == "example":
        example = EXAMPLES[int(number) - 1]
        return lcp.KKTHomotopy(example.problem, example.x0, example.z1, example.z2), {}
    if name == "brown":
        F = nonlinear.brown(10)
        return nonlinear.fixed_point(F, np.zeros(10), F.jacobian), {}
    if name == "bratu-1d":
        return bifurcation.Bratu1D(100), {"events": [continuation.TurningPoint(), continuation.TargetValue(1.0, 2)]}
    if name == "aircraft":
        return bifurcation.Aircraft(-0.008), {"events": [continuation.TurningPoint(terminal=3)], "direction": -1}
    simple = {
        "circle": bifurcation.Circle, "cusp": bifurcation.Cusp, "freudenstein-roth": bifurcation.FreudensteinRoth,
    }  # fmt: skip
    return simple[name](), {}


def best(work: Callable[[], Any], seconds: float) -> float:
    """The least processor time of a call, of as many as fit."""
    found, until = np.inf, time.perf_counter() + seconds
    while time.perf_counter() < until:
        began = time.process_time()
        work()
        found = min(found, time.process_time() - began)
    return found


def calls(work: Callable[[], Any]) -> int:
    """How many functions are called, in Python and in C."""
    number = 0

    def count(_frame: Any, event: str, _argument: Any) -> None:
        nonlocal number
        number += event in ("call", "c_call")

    sys.setprofile(count)
    try:
        work()
    finally:
        sys.setprofile(None)
    return number


def measured(name: str) -> dict[str, float]:
    """A path in numbers."""
    import continuation

    homotopy, options = problem(name)

    def work() -> Any:
        return continuation.trace(homotopy, **options)

    counts = work().counts
    found = {"steps": counts.accepted + counts.rejected, "factorizations": counts.factorizations}
    found |= {"solves": counts.solves, "residuals": counts.residuals}
    return found | {"calls": calls(work), "seconds": best(work, 0.2)}


def main() -> None:
    """Print a line a problem."""
    for name in sys.argv[1:] or PROBLEMS:
        one = measured(name)
        steps = one["steps"]
        print(
            f"{name}: {steps:.0f} steps, {one['factorizations']:.0f} factorisations, {one['solves']:.0f} solves, "
            f"{one['residuals']:.0f} residuals, a step {1e6 * one['seconds'] / steps:.0f} us, "
            f"{one['calls'] / steps:.0f} calls", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    main()
