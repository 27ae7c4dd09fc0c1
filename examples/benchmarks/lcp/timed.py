"""Outcome and processor seconds of each of some LCPs, as JSON: the child of `outside.py`, in whatever checkout it runs.

python examples/benchmarks/lcp/timed.py FILE LIMIT [HOMOTOPY]

The limit is one of processor time, so that it is the same on a busy machine.
"""

import json
import math
import pickle
import signal
import sys
import time
from pathlib import Path

import numpy as np

from continuation import Budget
from problems import lcp

AGAIN = 0.05
"""Seconds below which a problem is solved three times, of which the least counts."""


def late(*_: object) -> None:
    """Ends a solve at the limit."""
    raise TimeoutError


def main() -> None:
    """Time the problems of a file."""
    problems, limit = pickle.loads(Path(sys.argv[1]).read_bytes()), float(sys.argv[2])
    homotopy = sys.argv[3] if len(sys.argv) > 3 else "auto"
    signal.signal(signal.SIGPROF, late)
    lcp.solve(lcp.LCP(np.eye(2), -np.ones(2)))
    # One matrix and many q are the steps of a simulation, which begin with what the last one found.
    steps = len(problems) > 1 and problems[0][0] is problems[1][0] and hasattr(lcp, "Solver")
    runs = []
    for _ in range(3 if steps else 1):
        solver, rows = lcp.Solver(problems[0][0]) if steps else None, []
        for A, q in problems:
            best, outcome = math.inf, ""
            for _ in range(1 if steps else 3):
                budget = Budget(steps=math.inf)
                began = time.thread_time()
                signal.setitimer(signal.ITIMER_PROF, limit)
                try:
                    found = lcp.solve(lcp.LCP(A, q), homotopy, budget=budget) if solver is None else solver.solve(q)
                    outcome = found.outcome.name
                except TimeoutError:
                    outcome = "NOT_FOUND"
                signal.setitimer(signal.ITIMER_PROF, 0.0)
                best = min(best, time.thread_time() - began)
                if best > AGAIN:
                    break
            rows.append((outcome, best))
        runs.append(rows)
    print(json.dumps([(row[0][0], min(seconds for _, seconds in row)) for row in zip(*runs)]))


if __name__ == "__main__":
    main()
