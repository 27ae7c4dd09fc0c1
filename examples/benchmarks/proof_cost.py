"""The cost of a proof: seconds of the processor over those of the trace, and boxes over points.

    python examples/benchmarks/proof_cost.py [large]

The ten examples of the paper, random LCPs, and problems with known bifurcations; large ones on their own.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from campaign import asked, timed

from continuation import Budget, certify, trace
from problems import paper
from problems.bifurcation import Aircraft, Bratu1D, ExponentialCosine, FreudensteinRoth
from problems.lcp import LCP
from problems.lcp.homotopies import KKTHomotopy


def measured(name: str, homotopy: Any, rounds: int = 1, budget: Budget | None = None) -> None:
    """Print order, seconds of trace and proof, points, boxes, folds, and whether it is complete."""
    path, tracing = timed(partial(trace, homotopy, budget=budget), rounds)
    proof, proving = timed(partial(certify, path, homotopy), rounds)
    print(f"{name:24} N {path.u.shape[1] - 1:4} trace {tracing:7.3f} s, proof {proving:7.3f} s, ratio "
          f"{proving / tracing:5.2f}, points {len(path):4}, boxes {proof.boxes:5}, folds {len(path.turning_points):2}, "
          f"{'complete' if proof.complete else str(proof)[:80]}", flush=True)  # fmt: skip


def random_lcps(*orders: int) -> Iterator[tuple[str, Any]]:
    """Matrices of normal entries: no class, and folds; seed 1 is positive semidefinite."""
    for n in orders:
        for seed in range(3):
            rng = np.random.default_rng(seed)
            A, q = rng.normal(size=(n, n)), rng.normal(size=n)
            yield f"random LCP {n}, {seed}", KKTHomotopy(LCP(A @ A.T / n if seed == 1 else A, q))


if __name__ == "__main__":
    large = "large" in asked()[0]
    small = [
        *((f"example {e.number}", KKTHomotopy(e.problem, e.x0), 3) for e in paper.EXAMPLES),
        ("freudenstein-roth", FreudensteinRoth(), 3),
        ("aircraft", Aircraft(), 3, Budget(steps=60)),
    ]
    for row in [
        *([] if large else small),
        *random_lcps(*((100,) if large else (20, 40))),
        ("bratu", Bratu1D(100 if large else 30), 1, Budget(steps=14)),
        *((f"exponential-cosine {n}", ExponentialCosine(n)) for n in (range(7, 11) if large else range(2, 7))),
    ]:
        measured(*row)
