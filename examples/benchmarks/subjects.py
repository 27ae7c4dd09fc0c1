"""Traced paths with their proofs, smooth, kinked and piecewise linear, which `corrupted.py` spoils."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from attrs import frozen

from continuation import Budget, certify, from_functions, trace
from continuation.certificate import Proof
from continuation.path import Path
from problems.bifurcation import Cusp, ExponentialCosine, FreudensteinRoth
from problems.lcp import LCP, UnprovenError, along, prove_path
from problems.lcp.homotopies import KKTHomotopy
from problems.nonlinear import NormalMap, bratu_under_obstacle


@frozen(eq=False)
class Linear:
    """A piecewise linear path, (q + t d, A), which is proved in rational numbers."""

    problem: LCP
    d: np.ndarray


def proved(homotopy: Any, path: Path) -> bool:
    """Whether a path's proof is complete."""
    if not isinstance(homotopy, Linear):
        return certify(path, homotopy).complete
    try:
        return prove_path(homotopy.problem, homotopy.d, path) is not None
    except (UnprovenError, ValueError):
        return False


def cubic(seed: int) -> NormalMap:
    """A normal map of three unknowns between bounds, with a nonlinear force; kinks where unknowns meet bounds."""
    rng = np.random.default_rng(seed)
    A, q, d = rng.normal(size=(3, 3)), rng.normal(size=3), rng.choice([-1.0, 1.0], 3)
    return NormalMap(
        lambda x, lam: A @ x + 0.25 * x**3 + 0.2 * np.sin(x * lam) + q + lam * d,
        x0=d, lam0=-12.0, lower=-1.0, upper=1.0, target=12.0,
    )  # fmt: skip


def two_sheets(gap: float) -> Any:
    """y^2 = lam^2 + gap^2: for a small gap each of the two sheets has a sharp bend next to that of the other."""
    return from_functions(lambda y, lam: y**2 - lam**2 - gap**2, start=([np.hypot(1.0, gap)], -1.0), target=1.0)


@cache
def subjects(seed: int = 0) -> list[tuple[Any, Path, Proof]]:
    """Homotopies with their paths and proofs; from seed 1 on random ones among them, those that are proved."""
    rng = np.random.default_rng([seed, 20])
    matrix, q = np.array([[1.0, -2.0, 0.5], [3.0, 0.2, -1.0], [-0.5, 2.0, 1.0]]), np.array([-1.0, 1.0, -2.0])
    drawn_ones = [LCP(rng.normal(size=(n, n)), rng.normal(size=n)) for n in rng.integers(2, 5, 4)] if seed else []
    homotopies = [
        FreudensteinRoth(),
        Cusp(),
        ExponentialCosine(3),
        KKTHomotopy(LCP(matrix, q)),
        *kinked(),
        *([two_sheets(10.0 ** rng.uniform(-4.0, -1.0))] if seed else []),
        *map(KKTHomotopy, drawn_ones),
        *([cubic(int(rng.integers(1000)))] if seed else []),
    ]
    paths = [trace(homotopy, budget=Budget(steps=60)) for homotopy in homotopies]
    out = [(homotopy, path, certify(path, homotopy)) for homotopy, path in zip(homotopies, paths)]
    for line in (Linear(problem, np.ones(problem.n)) for problem in (turning(), *drawn_ones)):
        path = along(line.problem, line.d, (np.inf, 0.0))
        if proved(line, path):
            out.append((line, path, Proof.empty(line.problem.n + 1)))
    return [one for one in out if len(one[1]) > 4 and one[2].complete]


def turning() -> LCP:
    """On the path of Lemke's method for it are six kinks, and in four of them t turns."""
    return LCP(np.array([[2.0, 2.0, 4.0], [-3.0, 0.0, -3.0], [1.0, 3.0, 1.0]]), np.array([-5.0, 1.0, -4.0]))


def kinked() -> list[Any]:
    """Homotopies in pieces: kinks in which the parameter turns, and smooth turning points between kinks."""
    lemke = NormalMap.affine(turning().A, turning().q, np.ones(3), x0=np.zeros(3), lam0=12.0)
    return [bratu_under_obstacle(9, 2.0, target=3.55), lemke, cubic(39)]
