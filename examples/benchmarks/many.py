"""Many small LCPs: `lcp.solve_many` beside a loop over quantecon's Lemke, and whether it agrees with `lcp.solve`.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/many.py [NUMBER] [KIND ...]

quantecon (numba) is compared with where it is installed. Times are processor seconds.
"""

import math
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import claims
import numpy as np
from campaign import WRONG, Campaign, Cases, Verdict, asked, timed

from problems import lcp
from problems.lcp import LCP, Outcome

Kind = Callable[[int, int, np.random.Generator], claims.Data]


def stacked(kind: Callable[[int, np.random.Generator], claims.Data], units: float = 0.0) -> Kind:
    """So many problems of a kind of `claims.py`, with rows and columns in units of 10^-units to 10^units."""

    def draw(k: int, n: int, r: np.random.Generator) -> claims.Data:
        A, q = (np.array(part) for part in zip(*(kind(n, r) for _ in range(k))))
        rows, columns = 10.0 ** r.uniform(-units, units, (2, k, n))
        return rows[:, :, None] * A * columns[:, None, :], rows * q

    return draw


KINDS: dict[str, Kind] = {
    "p_matrices": stacked(claims.KINDS["monotone"]), "semidefinite": stacked(claims.KINDS["semidefinite"]),
    "indefinite": stacked(claims.KINDS["nonmonotone"]), "unsolvable": stacked(claims.KINDS["infeasible"]),
    "degenerate": stacked(claims.KINDS["integer"]), "badly_scaled": stacked(claims.KINDS["monotone"], 6.0),
}  # fmt: skip


def together(n: int, k: int) -> str:
    """Microseconds each, certified, beside a loop over quantecon's Lemke, which certifies nothing."""
    A, q = KINDS["p_matrices"](k, n, np.random.default_rng(n))
    found, ours = timed(lambda: lcp.solve_many(A, q))
    line = f"n = {n}, {k} problems: {1e6 * ours / k:.1f} us each, {found.solved.sum()} certified, " \
           f"{found.singly.size} one by one, relative residual {found.relative_residual.max():.0e}"  # fmt: skip
    if find_spec("quantecon"):
        lemke = import_module("quantecon.optimize").lcp_lemke
        lemke(A[0], q[0])
        _, theirs = timed(lambda: [lemke(*one) for one in zip(A, q)])
        line += f"; quantecon's Lemke {1e6 * theirs / k:.1f} us, ratio {ours / theirs:.2f}"
    sample = min(k, 300)
    _, singly = timed(lambda: [lcp.solve(LCP(*one)) for one in zip(A[:sample], q)])
    return f"{line}; `solve` {1e6 * singly / sample:.0f} us"


def agreeing(make: Kind) -> Cases:
    """Problems of a kind, n = 1 to 8, each with the outcome that `solve_many` says."""

    def draw(number: int, seed: int) -> Iterator[tuple[LCP, Outcome]]:
        for n in range(1, 9):
            A, q = make(max(number // 8, 1), n, np.random.default_rng([n, seed]))
            yield from zip(map(LCP, A, q), map(Outcome, lcp.solve_many(A, q).outcome))

    return draw


def judge(case: tuple[LCP, Outcome], way: Any) -> Verdict:
    """Whether `solve` says the same."""
    outcome, one = case[1], lcp.solve(case[0]).outcome
    return outcome.name if one is outcome else f"{WRONG}: {outcome.name}, `solve` {one.name}", math.nan


CAMPAIGN = Campaign({name: agreeing(kind) for name, kind in KINDS.items()}, judge, {"": None})

if __name__ == "__main__":
    names, (number,), _ = asked(100_000)
    for n, k in ((5, number), (10, number // 4), (20, number // 10)):
        print(together(n, k), flush=True)
    sys.exit(min(CAMPAIGN.run(max(number // 100, 8), 1, names), 1))
