"""What a step costs beside another version of the library: time, calls, factorisations; and beyond its linear algebra.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/size/step.py [--against CHECKOUT] [--rounds 20]

The versions take turns in processes of their own, so that a machine with other work to do slows both; the least time
counts. Calls of functions, Python's and numpy's, are counted exactly, whatever else runs.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path as File
from typing import Any

import numpy as np

HERE = str(File(__file__).resolve().parents[3])
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


def linear_algebra(homotopy: Any, counts: Any) -> float:
    """Seconds that a path's evaluations, factorisations and solves take by themselves, dense."""
    from scipy.linalg.lapack import dgetrf, dgetrs

    y, lam = homotopy.start()
    n = np.size(y) + 1
    matrix, right = np.eye(n) + 1e-3 * np.arange(n), np.ones(n)
    factors, pivots, _ = dgetrf(matrix)
    parts = (
        (counts.residuals, lambda: homotopy.residual(y, lam)),
        (counts.jacobians, lambda: homotopy.jacobian(y, lam)),
        (counts.factorizations, lambda: dgetrf(matrix)),
        (counts.solves, lambda: dgetrs(factors, pivots, right)),
    )
    return sum(count * best(work, 0.01) for count, work in parts)


def measured(name: str) -> dict[str, float]:
    """A path in numbers."""
    import continuation

    homotopy, options = problem(name)

    def work() -> Any:
        return continuation.trace(homotopy, **options)

    counts = work().counts
    found = {"steps": counts.accepted + counts.rejected, "factorizations": counts.factorizations}
    found |= {"solves": counts.solves, "residuals": counts.residuals}
    found |= {"calls": calls(work), "seconds": best(work, 0.2), "algebra": np.nan}
    dense = not hasattr(homotopy, "bordered") and isinstance(homotopy.jacobian(*homotopy.start())[0], np.ndarray)
    if dense:
        found["algebra"] = linear_algebra(homotopy, counts)
    return found


def asked(checkout: str, name: str) -> dict[str, float]:
    """The same of another version, in a process of its own."""
    environment = os.environ | {"PYTHONPATH": checkout, "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, __file__, "--measure", name]
    answer = subprocess.run(command, env=environment, cwd=checkout, capture_output=True, text=True, check=True)
    found: dict[str, float] = json.loads(answer.stdout)
    return found


def main() -> None:
    """Print a line a problem."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--against", help="another checkout")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    parser.add_argument("names", nargs="*", default=list(PROBLEMS))
    arguments = parser.parse_args()
    if arguments.measure:
        print(json.dumps(measured(arguments.measure)))
        return
    versions = [HERE, *([arguments.against] if arguments.against else [])]
    for name in arguments.names:
        found: dict[str, dict[str, float]] = {}
        for _ in range(arguments.rounds):
            for version in versions:
                new = asked(version, name)
                old = found.get(version, new)
                found[version] = new | {key: min(old[key], new[key]) for key in ("seconds", "algebra")}
        lines = []
        for one in found.values():
            steps, seconds = one["steps"], one["seconds"]
            lines.append(
                f"{steps:.0f} steps, {one['factorizations']:.0f} factorisations, {one['solves']:.0f} solves, "
                f"{one['residuals']:.0f} residuals, a step {1e6 * seconds / steps:.0f} us "
                f"({1e6 * (seconds - one['algebra']) / steps:.0f} beyond), {one['calls'] / steps:.0f} calls"
            )
        ratio = ""
        if len(found) == 2:
            new, old = found.values()
            a_path = new["seconds"] / old["seconds"]
            ratio = f"; ratio a step {a_path * old['steps'] / new['steps']:.2f}, a path {a_path:.2f}"
        print(f"{name}: {' | '.join(lines)}{ratio}", flush=True)


if __name__ == "__main__":
    main()
