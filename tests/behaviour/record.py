"""What the engine and the LCP solver do today, written down: status, events, ends and counts of about 300 runs.

    python tests/behaviour/record.py            compare with the record beside this file; exit 1 if anything differs
    python tests/behaviour/record.py --counts   the same, and the counts must lie in the recorded range itself
    python tests/behaviour/record.py --write    write the record anew, and say in the commit why it changed

Statuses, events and ends must agree to 1e-10 on every machine. Counts depend on the last bits of the BLAS: `--write`
records their range over the kernels of OpenBLAS, and a run must stay within it and a margin. The arclength of an event
is not compared: it is measured in steps whose ends differ. An LCP with several solutions may give any of them.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path as File
from typing import Any

import numpy as np

import continuation
from problems import lcp
from problems.bifurcation import (
    Aircraft,
    Bratu1D,
    Bratu2D,
    Circle,
    Cusp,
    ExponentialCosine,
    FreudensteinRoth,
    Pitchfork,
)
from problems.nonlinear import brown, fixed_point
from problems.paper import EXAMPLES

RECORD = File(__file__).with_name("record.json")
PRESETS = (continuation.FAST, continuation.DEFAULT, continuation.CONSERVATIVE, continuation.SERIES)
KERNELS = ("Prescott", "Sandybridge", "Haswell", "SkylakeX")
"""Kernels of OpenBLAS that sum in different orders; one that the processor lacks is left out."""

SIGNIFICANT = 1e-10
MARGIN, FEW = 0.1, 3
"""Counts of other processors may lie a tenth, or so few, outside the range of these kernels."""
PROBLEMS = 200


def paths() -> dict[str, tuple[Callable[[], Any], dict[str, Any]]]:
    """The acceptance problems and the ten examples, each with the options of its trace."""
    Turn, Stop = continuation.TurningPoint, continuation.TargetValue
    F = brown(10)
    found: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {
        "circle": (Circle, {}),
        "cusp": (Cusp, {}),
        "pitchfork": (Pitchfork, {}),
        "freudenstein-roth": (FreudensteinRoth, {}),
        "bratu-1d": (lambda: Bratu1D(100), {"events": [Turn(), Stop(1.0, terminal=2)]}),
        "bratu-2d": (lambda: Bratu2D(12), {"events": [Turn(), Stop(2.0, terminal=2)]}),
        "aircraft": (lambda: Aircraft(-0.008), {"events": [Turn(terminal=3)], "direction": -1}),
        "brown": (lambda: fixed_point(F, np.zeros(10), F.jacobian), {}),
    }
    for n in range(2, 7):
        found[f"exponential-cosine-{n}"] = (lambda n=n: ExponentialCosine(n), {})
    for example in EXAMPLES:
        found[f"example-{example.number}"] = (lambda e=example: lcp.KKTHomotopy(e.problem, e.x0, e.z1, e.z2), {})
    return found


def traced(name: str, preset: continuation.Preset) -> dict[str, Any]:
    """One path, in numbers."""
    make, options = paths()[name]
    path = continuation.trace(make(), preset=preset, **options)
    return {
        "status": path.status.name,
        "end": path.endpoint.u.tolist()[-4:],
        "events": [[e.name, *e.u.tolist()[-4:]] for e in path.events],
        "counts": path.counts.as_dict(),
    }


def problem(k: int) -> lcp.LCP:
    """The k-th generated LCP: five kinds, n = 2 .. 12, integer data, two thirds with a planted solution."""
    r = np.random.default_rng([14, k])
    n = int(r.integers(2, 13))
    A = r.integers(-9, 10, (n, n)).astype(float)
    kind = k % 5
    if kind == 1:
        A = A @ A.T
    elif kind == 2:
        A = np.triu(A, 1) - np.triu(A, 1).T + np.diag(r.integers(0, 3, n))
    elif kind == 3:
        A = np.diag(r.integers(1, 40, n)) - np.abs(A) * (1 - np.eye(n))
    elif kind == 4:
        A = np.abs(A)
    q = r.integers(-9, 10, n).astype(float)
    if k % 3:
        x = np.where(r.random(n) < 0.5, r.integers(0, 5, n), 0)
        q = np.where(x > 0, 0, r.integers(0, 5, n)) - A @ x
    return lcp.LCP(A, q)


def solved(k: int) -> dict[str, Any]:
    """The answer to the k-th LCP, in numbers; a budget of work, so that no clock decides."""
    solution = lcp.solve(problem(k), restarts=3, budget=continuation.Budget(steps=2000))
    return {
        "status": solution.outcome.name,
        "end": [] if solution.x is None else solution.x.tolist(),
        "events": [],
        "counts": solution.counts.as_dict(),
    }


def runs() -> Iterator[tuple[str, Callable[[], dict[str, Any]]]]:
    """Every run by name."""
    for name in paths():
        for preset in PRESETS:
            yield f"{name} {preset.name}", lambda name=name, preset=preset: traced(name, preset)
    for k in range(PROBLEMS):
        yield f"lcp {k}", lambda k=k: solved(k)


def same_numbers(found: list[Any], expected: list[Any]) -> bool:
    """Whether names are equal, and numbers to 1e-10 of the largest beside them."""
    if len(found) != len(expected):
        return False
    numbers = [value for value in expected if isinstance(value, float)]
    scale = SIGNIFICANT * max([1.0, *map(abs, numbers)])
    return all(abs(a - b) <= scale if isinstance(b, float) else a == b for a, b in zip(found, expected, strict=True))


def differences(name: str, found: dict[str, Any], expected: dict[str, Any], exactly: bool) -> list[str]:
    """What of a run is not as recorded; `exactly` allows counts no margin."""
    said = []
    if found["status"] != expected["status"]:
        said.append(f"{name}: status {found['status']}, recorded {expected['status']}")
    if expected["end"] and not same_numbers(found["end"], expected["end"]):
        said.append(f"{name}: end {found['end']}, recorded {expected['end']}")
    events = found["events"], expected["events"]
    if len(events[0]) != len(events[1]) or not all(map(same_numbers, *events)):
        said.append(f"{name}: events {found['events']}, recorded {expected['events']}")
    for count, (least, most) in expected["counts"].items():
        n, margin = found["counts"][count], 0 if exactly else max(MARGIN * most, FEW)
        if not least - margin <= n <= most + margin:
            said.append(f"{name}: {n} {count}, recorded {least} to {most}")
    return said


def compare(names: set[str] | None = None, exactly: bool = False) -> list[str]:
    """All differences from the record, of the runs named or of all."""
    record = json.loads(RECORD.read_text())
    chosen = [(name, run) for name, run in runs() if names is None or name in names]
    return [line for name, run in chosen for line in differences(name, run(), record[name], exactly)]


def written() -> dict[str, Any]:
    """The record: this process's runs, and the range of their counts under every kernel."""
    everywhere = [{name: run() for name, run in runs()}]
    for kernel in KERNELS:
        environment = {**os.environ, "OPENBLAS_CORETYPE": kernel}
        process = subprocess.run([sys.executable, __file__, "--print"], env=environment, capture_output=True)
        if process.returncode != -signal.SIGILL:
            everywhere.append(json.loads(process.stdout))
    record = everywhere[0]
    for k in range(PROBLEMS):
        if len(lcp.solve_by_enumeration(problem(k)).solutions) != 1:
            record[f"lcp {k}"]["end"] = []
    for name, entry in record.items():
        counts = [other[name]["counts"] for other in everywhere]
        entry["counts"] = {key: [min(c[key] for c in counts), max(c[key] for c in counts)] for key in counts[0]}
    return record


if __name__ == "__main__":
    if "--print" in sys.argv:
        print(json.dumps({name: run() for name, run in runs()}))
    elif "--write" in sys.argv:
        lines = [f"{json.dumps(name)}: {json.dumps(entry)}" for name, entry in written().items()]
        RECORD.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    else:
        lines = compare(exactly="--counts" in sys.argv)
        print("\n".join(lines) or "as recorded")
        sys.exit(bool(lines))
