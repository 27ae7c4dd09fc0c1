"""Bratu's problem beside other software; what a step costs beyond linear algebra is in `size/step.py`.

    python examples/benchmarks/engine_benchmark.py [--rivals PYTHON]

PYTHON is an interpreter that has `bice` and `pysces` (an environment of its own: neither is needed here). One BLAS
thread; each time is processor time, the least of several runs.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from pathlib import Path

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from rivals import UPPER, measure  # noqa: E402

import continuation  # noqa: E402
from continuation import TargetValue, trace  # noqa: E402
from problems.bifurcation import Bratu1D, Bratu2D  # noqa: E402
from problems.bifurcation.truth import bratu  # noqa: E402


def fastest(function, repeats):
    best = np.inf
    for _ in range(repeats):
        begin = time.process_time()
        function()
        best = min(best, time.process_time() - begin)
    return best


def ours(kind, m, preset):
    homotopy = Bratu1D(m) if kind == "interval" else Bratu2D(m)
    event = TargetValue(UPPER[kind], direction=-1)
    path = trace(homotopy, preset=preset, events=[event])
    return {
        "seconds": fastest(lambda: trace(homotopy, preset=preset, events=[event]), 5),
        "steps": len(path) - 1,
        "factorizations": path.counts.factorizations,
        "residuals": path.counts.residuals,
        "fold": path.turning_points[0].lam,
    }


def theirs(python, name, kind, m):
    """Run a rival in another interpreter; None, with the reason printed, where that fails."""
    command = [python, str(Path(__file__).with_name("rivals.py")), name, kind, str(m)]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
        return json.loads(answer.stdout.splitlines()[-1])
    except (subprocess.SubprocessError, OSError, IndexError, json.JSONDecodeError) as error:
        print(f"  {name} on {kind} {m} gave nothing: {error}", file=sys.stderr)
        return None


def compare(python):
    cases = [("interval", 100, bratu.FOLD_1D[100][0]), ("interval", 1000, bratu.FOLD_1D[1000][0])]
    cases.append(("square", 50, bratu.FOLD_2D[50]))
    print("Bratu's problem through the fold to the upper branch, one thread, times relative to the plain scipy loop")
    print(f"{'problem':>13} {'software':>22} {'time':>9} {'ratio':>6} {'steps':>6} ", end="")
    print(f"{'factor.':>8} {'resid.':>7} {'error':>6}")
    for kind, m, fold in cases:
        rows = {"plain scipy loop": measure("plain", kind, m)}
        for preset in (continuation.FAST, continuation.DEFAULT):
            rows[f"continuation {preset.name}"] = ours(kind, m, preset)
        if python:
            rows["bice"] = theirs(python, "bice", kind, m)
            if m == 100:
                # pysces wraps PITCON for dense matrices, so a larger one would say nothing.
                rows["PITCON dense in pysces"] = theirs(python, "pitcon", kind, m)
        for name, row in rows.items():
            if row is None:
                continue
            ratio = row["seconds"] / rows["plain scipy loop"]["seconds"]
            print(
                f"{kind + ' ' + str(m):>13} {name:>22.22} {1e3 * row['seconds']:7.1f}ms {ratio:6.2f} {row['steps']:6d} "
                f"{row['factorizations']:8d} {row['residuals']:7d} {abs(row['fold'] - fold):6.0e}"
            )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rivals", metavar="PYTHON", help="an interpreter that has bice and pysces")
    options = parser.parse_args()
    compare(options.rivals)
