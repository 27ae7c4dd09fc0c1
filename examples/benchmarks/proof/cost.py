"""What a proof costs: seconds of the processor over those of the trace, and boxes over points.

    python examples/benchmarks/proof/cost.py [FILE.png | large]

The ten examples of the paper, random LCPs, and problems with known bifurcations; large ones on their own.
"""

import sys
from time import process_time

import numpy as np

from continuation import Budget, certify, trace
from problems import paper
from problems.bifurcation import Aircraft, Bratu1D, ExponentialCosine, FreudensteinRoth
from problems.lcp import LCP
from problems.lcp.homotopies import KKTHomotopy


def timed(work, repeat: int) -> tuple[float, object]:
    """The least time of a few runs, and the result."""
    best, result = np.inf, None
    for _ in range(repeat):
        begin = process_time()
        result = work()
        best = min(best, process_time() - begin)
    return best, result


def measured(name: str, homotopy, repeat: int = 3, **options) -> tuple[str, int, float, float, int, int, bool]:
    """Name, order, seconds of trace and proof, points, boxes, folds, and whether it is complete."""
    tracing, path = timed(lambda: trace(homotopy, **options), repeat)
    proving, proof = timed(lambda: certify(path, homotopy), repeat)
    row = name, path.u.shape[1] - 1, tracing, proving, len(path), proof.boxes, len(path.turning_points), proof.complete
    print(
        "{:24} N {:4} trace {:7.3f} s, proof {:7.3f} s, ratio {:5.2f}, points {:4}, boxes {:5}, folds {:2}, {}".format(
            *row[:3], row[3], row[3] / row[2], *row[4:7], "complete" if row[7] else str(proof)[:80]
        ),
        flush=True,
    )
    return row


def random_lcp(n: int, seed: int) -> LCP:
    """A matrix of normal entries: no class, and folds; seed 1 is positive semidefinite."""
    rng = np.random.default_rng(seed)
    matrix, q = rng.normal(size=(n, n)), rng.normal(size=n)
    return LCP(matrix @ matrix.T / n if seed == 1 else matrix, q)


def rows(quick: bool = False) -> list:
    """All measurements."""
    found = [measured(f"example {k + 1}", KKTHomotopy(e.problem, e.x0)) for k, e in enumerate(paper.EXAMPLES)]
    orders = (20,) if quick else (20, 40)
    found += [
        measured(f"random LCP {n}, {seed}", KKTHomotopy(random_lcp(n, seed)), 1) for n in orders for seed in (0, 1, 2)
    ]
    found.append(measured("freudenstein-roth", FreudensteinRoth()))
    found.append(measured("aircraft", Aircraft(), budget=Budget(steps=60)))
    found.append(measured("bratu", Bratu1D(30), 1, budget=Budget(steps=14)))
    found += [measured(f"exponential-cosine {n}", ExponentialCosine(n), 1) for n in range(2, 5 if quick else 7)]
    return found


def large() -> list:
    """What takes minutes."""
    found = [measured(f"exponential-cosine {n}", ExponentialCosine(n), 1) for n in range(7, 11)]
    found.append(measured("bratu", Bratu1D(100), 1, budget=Budget(steps=14)))
    return found + [measured(f"random LCP 100, {seed}", KKTHomotopy(random_lcp(100, seed)), 1) for seed in (0, 1, 2)]


def by_tolerance() -> list[tuple[float, int, int]]:
    """Points and boxes of one path traced to several tolerances."""
    homotopy = FreudensteinRoth()
    out = []
    for tolerance in (1e-4, 1e-6, 1e-8, 1e-10, 1e-12):
        path = trace(homotopy, tolerance=tolerance)
        out.append((tolerance, len(path), certify(path, homotopy).boxes))
    return out


def picture(file: str, found: list) -> None:
    """Proof time over trace time against folds, and boxes against tolerance."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    groups = {"quadratic (LCP)": lambda r: r[0].startswith(("example", "random")), "others": lambda r: True}
    left_over = list(found)
    for label, belongs in groups.items():
        mine = [r for r in left_over if belongs(r)]
        left_over = [r for r in left_over if r not in mine]
        left.plot([r[6] for r in mine], [r[3] / r[2] for r in mine], "o", label=label, alpha=0.7)
    left.set_yscale("log")
    left.axhline(1.0, color="gray", linewidth=0.8)
    left.set_xlabel("turning points of the path")
    left.set_ylabel("time of the proof / of the trace")
    left.legend()
    table = by_tolerance()
    right.plot([t[0] for t in table], [t[1] for t in table], "s-", label="points")
    right.plot([t[0] for t in table], [t[2] for t in table], "o-", label="boxes")
    right.set_xscale("log")
    right.set_ylim(0.0, 1.3 * max(t[2] for t in table))
    right.set_xlabel("tolerance of the trace")
    right.set_ylabel("number (Freudenstein and Roth)")
    right.legend()
    figure.savefig(file, dpi=110)


if __name__ == "__main__":
    asked = sys.argv[1] if len(sys.argv) > 1 else ""
    result = large() if asked == "large" else rows()
    if asked.endswith(".png"):
        picture(asked, result)
