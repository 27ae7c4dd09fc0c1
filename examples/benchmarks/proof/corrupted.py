"""Corrupted paths by the thousand: is a path that is no path ever proved?

    python examples/benchmarks/proof/corrupted.py 10000

Each corruption makes of traced paths something that they are not: continued on another sheet, points moved off the
curve by more than the radius of their tube, their order changed, a loop left out, turning points dropped or invented.
A complete proof of any of it is a fault. Points left out on one and the same curve are another matter: there the proof
is either complete or has a gap.
"""

from __future__ import annotations

import sys
from collections import Counter
from itertools import pairwise

import numpy as np
from attrs import evolve

from continuation import Budget, certify, trace
from continuation.certificate import Proof
from continuation.path import Path
from continuation.status import Kind, Status
from problems.bifurcation import Cusp, ExponentialCosine, FreudensteinRoth
from problems.lcp import LCP
from problems.lcp.homotopies import KKTHomotopy

DISTANT = 1e-3
"""How far a point is moved at least, in extents of the path."""


def subjects() -> list[tuple[object, Path, Proof]]:
    """Homotopies with their paths and proofs."""
    matrix = np.array([[1.0, -2.0, 0.5], [3.0, 0.2, -1.0], [-0.5, 2.0, 1.0]])
    homotopies = [
        FreudensteinRoth(),
        Cusp(),
        ExponentialCosine(3),
        KKTHomotopy(LCP(matrix, np.array([-1.0, 1.0, -2.0]))),
    ]
    out = []
    for homotopy in homotopies:
        path = trace(homotopy, budget=Budget(steps=60))
        out.append((homotopy, path, certify(path, homotopy)))
    return out


def numbered(path: Path, steps: list, events: list) -> Path:
    """A path of these steps, with arclengths by chords of the same scale."""
    chords = [0.0, *(float(np.linalg.norm(b.u - a.u)) for a, b in pairwise(steps))]
    lengths = np.cumsum(chords)
    scale = float(path.arclength[-1]) / (float(lengths[-1]) or 1.0)
    again = [evolve(s, index=k, arclength=float(lengths[k] * scale)) for k, s in enumerate(steps)]
    return Path(steps=again, events=events, status=path.status, message=path.message)


def moved(path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """One point moved off the curve, by at least twice the radius of the tubes beside it."""
    k = int(rng.integers(1, len(path) - 1))
    step, extent = path.steps[k], np.ptp(path.u, axis=0)
    beside = np.vstack([proof.radius(float(s)) for s in (path.arclength[k] - 1e-9, path.arclength[k] + 1e-9)])
    tube = np.nan_to_num(beside).max(axis=0)
    v = rng.normal(size=step.u.size)
    v -= step.tangent * float(step.tangent @ v) / float(step.tangent @ step.tangent)
    size = np.maximum(2.0 * tube, DISTANT * extent) / np.maximum(np.abs(v), 1e-3 * np.abs(v).max())
    off = v * float(size.max()) * 10.0 ** rng.uniform(0.0, 1.5)
    steps = list(path.steps)
    steps[k] = evolve(step, u=step.u + off)
    return Path(steps=steps, events=path.events, status=path.status)


def swapped(path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """Two points exchanged, or a run of points reversed."""
    i, j = sorted(rng.choice(np.arange(1, len(path) - 1), 2, replace=False).tolist())
    steps = list(path.steps)
    if rng.random() < 0.5:
        steps[i], steps[j] = steps[j], steps[i]
    else:
        steps[i : j + 1] = steps[i : j + 1][::-1]
    return numbered(path, steps, path.events)


def shortcut(path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """A loop left out: all points around one or two turning points, which the chord cuts off, and their events."""
    turns = path.turning_points
    if len(turns) < 2:
        return None
    k = int(rng.integers(0, len(turns) - 1))
    before, after = max(turns[k].step - int(rng.integers(1, 4)), 0), turns[k + 1].step + int(rng.integers(0, 3))
    if after >= len(path) or after - before < 2:
        return None
    steps = [s for s in path.steps if not before < s.index < after]
    events = [e for e in path.events if not before < e.step <= after]
    return numbered(path, steps, events)


def jumped(path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """Continued on another sheet: from some point on the path is that from a far point of the same curve."""
    n = len(path)
    if n < 12:
        return None
    i = int(rng.integers(1, n - 8))
    j = int(rng.integers(i + 6, n - 1))
    if float(np.linalg.norm((path.u[j] - path.u[i]) / np.ptp(path.u, axis=0))) < 0.15:
        return None
    steps = [*path.steps[: i + 1], *path.steps[j:]]
    if sum(i < e.step <= j for e in path.turning_points) == 0:
        return None  # points left out on one branch, which may well be proved
    events = [e for e in path.events if not i < e.step <= j]
    return numbered(path, steps, events)


def unlisted(path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """A turning point dropped."""
    if not path.turning_points:
        return None
    gone = path.turning_points[int(rng.integers(len(path.turning_points)))]
    return Path(steps=path.steps, events=[e for e in path.events if e is not gone], status=path.status)


def invented(path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """A turning point listed at a step of the path, on the curve, where there is none."""
    away = [s for s in path.steps[1:-1] if all(abs(s.arclength - e.arclength) > 0.3 for e in path.turning_points)]
    if not away or not path.events:
        return None
    step = away[int(rng.integers(len(away)))]
    like = path.events[0]
    event = evolve(
        like,
        name="turning point",
        kind=Kind.TURNING_POINT,
        arclength=step.arclength,
        u=step.u,
        tangent=step.tangent,
        step=step.index,
    )
    events = sorted([*path.events, event], key=lambda e: e.arclength)
    return Path(steps=path.steps, events=events, status=path.status)


def elsewhere(path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """An event moved off the curve."""
    if not path.events:
        return None
    k = int(rng.integers(len(path.events)))
    event = path.events[k]
    off = rng.normal(size=event.u.size) * np.ptp(path.u, axis=0) * 10.0 ** rng.uniform(-0.5, 1.0)
    events = list(path.events)
    events[k] = evolve(event, u=event.u + off)
    return Path(steps=path.steps, events=events, status=Status(path.status))


FAULTS = (moved, swapped, shortcut, jumped, unlisted, invented, elsewhere)


def campaign(count: int, seed: int = 0) -> Counter:
    """How many corrupted paths of each kind were refused, and accepted."""
    rng, found, tried = np.random.default_rng(seed), Counter(), subjects()
    assert all(proof.complete for _, _, proof in tried)
    while sum(found.values()) < count:
        fault = FAULTS[int(rng.integers(len(FAULTS)))]
        homotopy, path, proof = tried[int(rng.integers(len(tried)))]
        corrupted = fault(path, proof, rng)
        if corrupted is not None:
            accepted = certify(corrupted, homotopy).complete
            found[fault.__name__, "accepted" if accepted else "refused"] += 1
    return found


def by_parts(count: int, part: int = 500) -> Counter:
    """A long campaign, which says after each part how far it is."""
    found: Counter = Counter()
    for seed in range(-(-count // part)):
        found += campaign(min(part, count - seed * part), seed)
        accepted = sum(number for (_, verdict), number in found.items() if verdict == "accepted")
        print(f"{sum(found.values())} corrupted paths, {accepted} accepted", flush=True)
    return found


if __name__ == "__main__":
    for (kind, verdict), number in sorted(by_parts(int(sys.argv[1]) if len(sys.argv) > 1 else 200).items()):
        print(f"{kind:10} {verdict:9} {number}")
