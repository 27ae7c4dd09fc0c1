"""A residual alone beside the same with its Jacobian: Bratu in one and two dimensions, Swift-Hohenberg, and others.

    OPENBLAS_NUM_THREADS=1 python examples/benchmarks/no_jacobian.py [NAME ...] [--rounds 5] [--preset FAST]

Processor seconds, the least of several rounds. "differences" is the same residual as compiled code would give it, which
neither jets nor complex numbers pass; "known" has the pattern as `sparsity`; "stability" is the own Jacobian, with what
`Stability` costs.
"""

from functools import partial

import numpy as np
import scipy.sparse as sp
from campaign import asked, timed
from five import brusselator
from five import ways as written
from scipy.sparse.linalg import LaplacianNd

import continuation
from continuation.linear import Banded
from problems.bifurcation import Bratu1D, Bratu2D
from problems.bifurcation.bratu_2d import five_point


def swift_hohenberg(n):
    """r u - (1 + d^2/dx^2)^2 u + 2 u^2 - u^3 = 0 on (0, 40), mirrored at both ends: from a pattern in the middle."""
    x, g = (np.arange(n) + 0.5) * 40.0 / n, (n / 40.0) ** 2
    L = sp.eye_array(n) + g * LaplacianNd((n,), boundary_conditions="neumann", dtype=float).tosparse()
    square = sp.dia_array(-(L @ L))

    def once(u):
        mirrored = np.concatenate((u[:1], u, u[-1:]))
        return u + (mirrored[:-2] - 2.0 * u + mirrored[2:]) * g

    def jacobian(y, lam):
        band = np.zeros((5, n))
        band[2 - square.offsets] = square.data
        band[2] += lam + 4.0 * y - 3.0 * y * y
        return Banded(band, 2, 2), y.copy()

    start = 1.5 * np.cos(x) / np.cosh(0.25 * x), -0.4
    return continuation.from_functions(
        lambda y, lam: (lam + 2.0 * y - y * y) * y - once(once(y)), jacobian, start=start
    )


def allen_cahn(m):
    """Laplacian(u) + lam (u - u^3) = 0 on the unit square, u = 0 on its edge: along u = 0 through branch points."""
    A, h2 = five_point(m), (m + 1.0) ** -2

    def residual(y, lam):
        u = np.pad(y.reshape(m, m), 1)
        bent = u[2:, 1:-1] + u[:-2, 1:-1] + u[1:-1, 2:] + u[1:-1, :-2] - 4.0 * u[1:-1, 1:-1]
        return bent.ravel() + lam * h2 * (y - y**3)

    def jacobian(y, lam):
        return sp.csc_array(A + sp.diags_array(lam * h2 * (1.0 - 3.0 * y * y))), h2 * (y - y**3)

    return continuation.from_functions(residual, jacobian, start=(np.zeros(m * m), 10.0), target=60.0)


OPTIONS = {
    # Bratu's paths go through the fold, and end where lam falls below a value.
    Bratu1D: {"events": [continuation.TargetValue(1.0, direction=-1)]},
    Bratu2D: {"events": [continuation.TargetValue(2.0, direction=-1)]},
    swift_hohenberg: {"budget": continuation.Budget(steps=30), "direction": 1, "tolerance": 1e-6},
}

PROBLEMS = {
    f"{name}-{size}": partial(kind, size)
    for name, kind, sizes in (
        ("bratu-1d", Bratu1D, (100, 1000, 10_000)), ("bratu-2d", Bratu2D, (20, 50, 200)),
        ("swift-hohenberg", swift_hohenberg, (300, 3000)), ("allen-cahn", allen_cahn, (40,)),
        ("brusselator", lambda n: written(brusselator(n))["numpy"](), (64, 1000)),
    )
    for size in sizes
}  # fmt: skip


def plain(of, sparsity=None, compiled=False):
    """The residual of another homotopy alone, or as compiled code gives it."""

    def floats(y, lam):
        return of.residual(np.asarray(y, dtype=float), float(lam))

    residual = floats if compiled else of.residual
    return continuation.from_functions(residual, start=of.start(), target=of.target, sparsity=sparsity)


def options(kind, preset):
    """The options of a trace, by kind of problem."""
    return {"preset": getattr(continuation, preset), **OPTIONS.get(kind, {})}


def ways(homotopy):
    """By name: with its Jacobian, and without; and with it and the eigenvalues along the path."""
    slope = homotopy.jacobian(*homotopy.start())[0]
    pattern = slope.tosparse() if isinstance(slope, Banded) else slope
    return {
        "own": homotopy,
        "alone": plain(homotopy),
        "known": plain(homotopy, sparsity=pattern != 0),
        "differences": plain(homotopy, compiled=True),
        "stability": homotopy,
    }


def measured(name, rounds, preset="FAST", which=None):
    """By way: the path, and its processor seconds."""
    homotopy = PROBLEMS[name]()
    given, forms, found = options(PROBLEMS[name].func, preset), ways(homotopy), {}
    for way in which or forms:
        more = {"observers": [continuation.Stability()]} if way == "stability" else {}
        found[way] = timed(partial(continuation.trace, forms[way], **given, **more), rounds)
    return found


def folds_apart(path, other):
    """How far the folds of two paths are apart, relative; inf where there are not as many."""
    one, two = (np.array([point.lam for point in each.turning_points]) for each in (path, other))
    return np.inf if one.shape != two.shape else float((np.abs(one - two) / np.abs(one + two)).max(initial=0.0))


if __name__ == "__main__":
    names, _, given = asked(rounds=5, preset="FAST")
    for name in names or PROBLEMS:
        found = measured(name, given.rounds, given.preset)
        own, least = found["own"]
        for way, (path, seconds) in found.items():
            print(f"{name:22} {way:12} {1e3 * seconds:9.1f} ms {seconds / least:7.2f}  {path.status.name}, {len(path)} "
                  f"points, folds apart {folds_apart(path, own):.0e}, {path.counts}", flush=True)  # fmt: skip
