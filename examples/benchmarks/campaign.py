"""A campaign is a generator of cases for each family and a judge: one runner counts, prints a table, and ends with 1 if
anything is wrong.

    python FILE [NUMBER] [SEED] [FAMILY ...]

NUMBER cases of each family, from SEED on; all families where none is named.
"""

import argparse
import math
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation import CONSERVATIVE, DEFAULT, FAST, SERIES

PRESETS = {preset.name: preset for preset in (FAST, DEFAULT, CONSERVATIVE, SERIES)}
WRONG = "WRONG"

Verdict = tuple[str, float]
"""The result of a case in words, "" if it is as expected, with WRONG in front if it is a fault; and its cost."""

Cases = Callable[[int, int], Iterable[Any]]
"""A number and a seed to as many cases."""


def drawn(make: Callable[[int, np.random.Generator], Any]) -> Cases:
    """Cases by number, each with a generator of its own."""
    return lambda number, seed: (make(k, np.random.default_rng([seed, k])) for k in range(number))


@frozen
class Campaign:
    """Families of cases, a judge of a case under a way (by default a preset), and the name of the cost."""

    families: Mapping[str, Cases]
    judge: Callable[[Any, Any], Verdict]
    ways: Mapping[str, Any] = field(factory=PRESETS.copy)
    cost: str = "factorisations"

    def run(self, number: int, seed: int = 0, names: Iterable[str] = ()) -> int:
        """Print each family under each way; how many cases are wrong."""
        total = 0
        for name in names or self.families:
            for way, options in self.ways.items():
                found = [self.judge(case, options) for case in self.families[name](number, seed)]
                said = Counter(text for text, _ in found if text)
                first = [k for k, (text, _) in enumerate(found) if text.startswith(WRONG)]
                costs = [cost for _, cost in found if not math.isnan(cost)]
                spent = f"; {self.cost} {np.median(costs):.3g}, most {max(costs):.3g}" if costs else ""
                notes = "".join(f"; {count} {text}" for text, count in said.most_common())
                print(f"{name:22} {way:13} {len(first)} of {len(found)} wrong {first[:8] or ''}{notes}{spent}")
                total += len(first)
        print(f"{total} wrong", flush=True)
        return total

    def main(self, number: int) -> int:
        """Run what the command line asks for; the exit status."""
        names, numbers, _ = asked(number, 0)
        return min(self.run(*numbers, names), 1)


def asked(*numbers: int, **defaults: Any) -> tuple[list[str], list[int], argparse.Namespace]:
    """The command line's names, its numbers or the default ones, and its options, of the types of their defaults."""
    parser = argparse.ArgumentParser()
    parser.add_argument("words", nargs="*", default=[])
    for name, default in defaults.items():
        parser.add_argument(f"--{name}", type=type(default), default=default)
    options = parser.parse_args()
    given = [int(word) for word in options.words if word.isdigit()]
    return [word for word in options.words if not word.isdigit()], [*given, *numbers[len(given) :]], options


def timed(work: Callable[[], Any], rounds: int = 1) -> tuple[Any, float]:
    """The result of `work`, and the least seconds of the processor in so many rounds."""
    least, result = math.inf, None
    for _ in range(rounds):
        began = time.process_time()
        result = work()
        least = min(least, time.process_time() - began)
    return result, least
