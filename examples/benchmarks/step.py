"""The cost of a step: time, calls, factorisations, on the problems of the record of behaviour; and the time of a path
over that with `examine=False`.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/step.py [NAME ...]

Beside another checkout: the same with that in PYTHONPATH, in turns. Calls of functions, Python's and numpy's, are
counted exactly, whatever else runs.
"""

import sys
from collections.abc import Callable
from cProfile import Profile
from importlib import import_module
from pathlib import Path as File
from typing import Any

from campaign import asked, timed

import continuation

sys.path.insert(0, str(File(__file__).parents[2] / "tests" / "behaviour"))
PROBLEMS = import_module("record").paths()


def calls(work: Callable[[], Any]) -> int:
    """How many functions are called, in Python and in C."""
    profile = Profile()
    profile.runcall(work)
    return sum(entry.callcount for entry in profile.getstats())


def measured(name: str, rounds: int = 20) -> dict[str, float]:
    """A path in numbers."""
    make, options = PROBLEMS[name]
    homotopy = make()
    plain = {**options, "examine": False}
    path, seconds = timed(lambda: continuation.trace(homotopy, **options), rounds)
    _, least = timed(lambda: continuation.trace(homotopy, **plain), rounds)
    steps = path.counts.accepted + path.counts.rejected
    return {
        "steps": steps,
        **path.counts.as_dict(),
        "calls a step": calls(lambda: continuation.trace(homotopy, **options)) / steps,
        "us a step": 1e6 * seconds / steps,
        "times unexamined": seconds / least,
    }


if __name__ == "__main__":
    for name in asked()[0] or PROBLEMS:
        print(name, {key: float(f"{value:.3g}") for key, value in measured(name).items()}, flush=True)
