"""Ends that numbers mislead about, in random units: is each what it is, and at what cost beside textbook scaling?

    python examples/benchmarks/ends/run.py [NUMBER] [SEED]

NUMBER paths (default 100) of each family of `families.py` under each preset, in units of 10^-UNITS to 10^UNITS. One is
wrong if its status is none that it may have, or if it has folds that are none. What it costs is compared with the same
path in its own units under the Euclidean metric, where that ends rightly, too.
"""

import sys
from pathlib import Path as File

import numpy as np

import continuation

sys.path.insert(0, str(File(__file__).parent))
from families import FAMILIES, Case

PRESETS = (continuation.FAST, continuation.DEFAULT, continuation.CONSERVATIVE, continuation.SERIES)
UNITS = 4.0
STEPS = 2000


def wrong(path: continuation.Path, case: Case) -> str:
    """What is wrong with a path; "" if nothing is."""
    if path.status not in case.ends:
        return path.status.name
    return "" if len(path.turning_points) == case.folds else f"{len(path.turning_points)} folds"


def compare(name: str, preset: continuation.Preset, number: int, seed: int) -> tuple[list[str], list[float]]:
    """What is wrong with each wrong path, and factorisations beside those of the Euclidean metric."""
    found, ratios = [], []
    for k in range(number):
        generator = np.random.default_rng([seed, k, len(name)])
        case = FAMILIES[name](generator)
        units = 10.0 ** generator.uniform(-UNITS, UNITS, 3)
        budget = continuation.Budget(steps=STEPS, factorizations=3 * STEPS)
        path = continuation.trace(case.homotopy(*units), preset=preset, budget=budget)
        if failure := wrong(path, case):
            found.append(f"{failure} ({k})")
        plain = continuation.trace(case.homotopy(), preset=preset, budget=budget, metric=continuation.Euclidean())
        if not failure and not wrong(plain, case):
            ratios.append(path.counts.factorizations / plain.counts.factorizations)
    return found, ratios


def main(number: int, seed: int) -> int:
    """Print a line a family and preset; how many paths end wrongly."""
    total = 0
    for name in FAMILIES:
        for preset in PRESETS:
            found, ratios = compare(name, preset, number, seed)
            total += len(found)
            cost = f"{np.median(ratios):.2f} ({max(ratios):.2f} at most)" if ratios else "-"
            print(
                f"{name:17s} {preset.name:13s} {len(found):3d} of {number} wrong {found[:3]}; cost {cost}", flush=True
            )
    print(f"{total} of {number * len(FAMILIES) * len(PRESETS)} wrong")
    return total


if __name__ == "__main__":
    arguments = [int(value) for value in sys.argv[1:]]
    sys.exit(min(main(*(arguments + [100, 0][len(arguments) :])), 1))
