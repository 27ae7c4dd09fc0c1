"""Corrupted paths by the thousand: is a path that is no path ever proved?

    python examples/benchmarks/proof/corrupted.py 10000

Each corruption makes of traced paths something that they are not: continued on another sheet, points moved off the
curve by more than the radius of their tube, their order changed, a loop left out, turning points dropped or invented;
and those with kinks continued on the wrong piece, turned back, their kinks dropped, invented, moved or called by other
names. A complete proof of any of it is a fault. Points left out on one and the same curve are another matter: there the
proof is either complete or has a gap.
"""

from __future__ import annotations

import sys
from collections import Counter
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation import Budget, certify, trace
from continuation.certificate import Proof
from continuation.certificate.proof import Gap
from continuation.path import Path
from continuation.status import Kind, Status
from problems.bifurcation import Cusp, ExponentialCosine, FreudensteinRoth
from problems.lcp import LCP, UnprovenError, along, prove_path
from problems.lcp.homotopies import KKTHomotopy
from problems.nonlinear import NormalMap, bratu_under_obstacle

DISTANT = 1e-3
"""How far a point is moved at least, in extents of the path."""


@frozen(eq=False)
class Linear:
    """A piecewise linear path, which is proved in rational numbers."""

    problem: LCP
    d: np.ndarray

    def proved(self, path: Path) -> bool:
        """Whether it is."""
        try:
            prove_path(self.problem, self.d, path)
        except (UnprovenError, ValueError):
            return False
        return True


def cubic(seed: int) -> NormalMap:
    """Of three unknowns between bounds, with a force that is no line; kinks where they meet these."""
    rng = np.random.default_rng(seed)
    A, q, d = rng.normal(size=(3, 3)), rng.normal(size=3), rng.choice([-1.0, 1.0], 3)
    return NormalMap(Cubic(A, q, d), x0=d, lam0=-12.0, lower=-1.0, upper=1.0, target=12.0)


@frozen(eq=False)
class Cubic:
    """F(x, lam) = A x + x^3 / 4 + sin(x lam) / 5 + q + lam d."""

    A: np.ndarray
    q: np.ndarray
    d: np.ndarray

    def __call__(self, x: Any, lam: Any) -> Any:
        """The force."""
        return self.A @ x + 0.25 * x**3 + 0.2 * np.sin(x * lam) + self.q + lam * self.d


@cache
def subjects() -> list[tuple[Any, Path, Proof]]:
    """Homotopies with their paths and proofs."""
    matrix = np.array([[1.0, -2.0, 0.5], [3.0, 0.2, -1.0], [-0.5, 2.0, 1.0]])
    homotopies = [
        FreudensteinRoth(),
        Cusp(),
        ExponentialCosine(3),
        KKTHomotopy(LCP(matrix, np.array([-1.0, 1.0, -2.0]))),
        *kinked(),
    ]
    out = []
    for homotopy in homotopies:
        path = trace(homotopy, budget=Budget(steps=60))
        out.append((homotopy, path, certify(path, homotopy)))
    line = along(turning(), np.ones(3), (np.inf, 0.0))
    none = Proof.empty(4, Gap(0.0, 0.0, "proved by rational numbers"))
    return [*out, (Linear(turning(), np.ones(3)), line, none)]


def turning() -> LCP:
    """On the path of Lemke's method for it are six kinks, and in four of them t turns."""
    return LCP(np.array([[2.0, 2.0, 4.0], [-3.0, 0.0, -3.0], [1.0, 3.0, 1.0]]), np.array([-5.0, 1.0, -4.0]))


def kinked() -> list[Any]:
    """Homotopies in pieces: kinks in which the parameter turns, and smooth turning points between kinks."""
    lemke = NormalMap.affine(turning().A, turning().q, np.ones(3), x0=np.zeros(3), lam0=12.0)
    return [bratu_under_obstacle(9, 2.0, target=3.55), lemke, cubic(39)]


def proved(homotopy: Any, path: Path) -> bool:
    """Whether a proof of it is complete."""
    return homotopy.proved(path) if isinstance(homotopy, Linear) else certify(path, homotopy).complete


def numbered(path: Path, steps: list, events: list) -> Path:
    """A path of these steps, with arclengths by chords of the same scale; kinks keep their points."""
    chords = [0.0, *(float(np.linalg.norm(b.u - a.u)) for a, b in pairwise(steps))]
    lengths = np.cumsum(chords)
    scale = float(path.arclength[-1]) / (float(lengths[-1]) or 1.0)
    again = [evolve(s, index=k, arclength=float(lengths[k] * scale)) for k, s in enumerate(steps)]
    places = {s.index: k for k, s in reversed(list(enumerate(steps)))}
    kept = [e for e in events if e.kind is not Kind.KINK]
    kinks = [(e, places[e.step]) for e in events if e.kind is Kind.KINK and e.step in places]
    kept += [evolve(e, step=k, arclength=again[k].arclength) for e, k in kinks]
    kept.sort(key=lambda e: e.arclength)
    return Path(steps=again, events=kept, status=path.status, message=path.message)


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
    n, least = len(path), 2 if path.kinks else 6
    if n < least + 6:
        return None
    i = int(rng.integers(1, n - least - 2))
    j = int(rng.integers(i + least, n - 1))
    if float(np.linalg.norm((path.u[j] - path.u[i]) / np.ptp(path.u, axis=0))) < 0.15:
        return None
    steps = [*path.steps[: i + 1], *path.steps[j:]]
    if not any(i < e.step <= j for e in [*path.turning_points, *path.kinks]):
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


# --- kinks ------------------------------------------------------------------------------------------------


def changed(path: Path, old: Any, *new: Any) -> Path:
    """The path with other events in the place of one."""
    events = [*(e for e in path.events if e is not old), *new]
    return Path(steps=path.steps, events=sorted(events, key=lambda e: e.arclength), status=path.status)


def drawn(path: Path, rng: np.random.Generator) -> Any:
    """One of the kinks."""
    return path.kinks[int(rng.integers(len(path.kinks)))]


def unkinked(path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """A kink dropped, and half of the times its point too."""
    kink = drawn(path, rng)
    if rng.random() < 0.5:
        return changed(path, kink)
    steps = [s for s in path.steps if s.index != kink.step]
    return numbered(path, steps, [e for e in path.events if e is not kink])


def misplaced(path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """A kink at another point of the path: one more, or the kink itself."""
    kink = drawn(path, rng)
    away = [s for s in path.steps if s.index not in {e.step for e in path.kinks}]
    if not away:
        return None
    step = away[int(rng.integers(len(away)))]
    like = evolve(kink, u=step.u, arclength=step.arclength, step=step.index)
    return changed(path, kink, like, *([kink] if rng.random() < 0.5 else []))


def pushed(path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """A kink moved along the arc before it or after it, on the curve or nearly, with its point."""
    kink = drawn(path, rng)
    k = kink.step
    other = path.u[k + 1] if rng.random() < 0.5 else path.u[k - 1]
    u = kink.u + (other - kink.u) * float(10.0 ** rng.uniform(-3.0, -0.3))
    steps = list(path.steps)
    steps[k] = evolve(steps[k], u=u)
    events = [evolve(e, u=u) if e is kink else e for e in path.events]
    return Path(steps=steps, events=events, status=path.status)


def renamed(path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """A kink in which another switch is said to vanish, or one more, or the parameter to turn where it does not."""
    kink = drawn(path, rng)
    count = path.u.shape[1] - 1
    if rng.random() < 0.4:
        return changed(path, kink, evolve(kink, name="kink" if kink.name == "turning kink" else "turning kink"))
    other = int(rng.choice([j for j in range(count) if j not in kink.switches]))
    switches = (other,) if rng.random() < 0.6 else tuple(sorted((*kink.switches, other)))
    return changed(path, kink, evolve(kink, switches=switches))


def turned_back(path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """From a kink on back on the same way."""
    k = drawn(path, rng).step
    back = [evolve(s, tangent=-s.tangent) for s in path.steps[:k][::-1]]
    whole = numbered(path, [*path.steps[: k + 1], *back], [e for e in path.events if e.step <= k])
    last = whole.steps[-1].arclength
    mirrored = [
        evolve(e, arclength=last - e.arclength, step=2 * k - e.step + (e.kind is not Kind.KINK))
        for e in whole.events
        if e.step != k or e.kind is not Kind.KINK
    ]
    return Path(steps=whole.steps, events=[*whole.events, *mirrored[::-1]], status=Status.STOPPED_AT_EVENT)


def straight_on(path: Path, proof: Proof, rng: np.random.Generator, homotopy: Any = None) -> Path | None:
    """Continued on the wrong piece: past a kink by the equations that held before it."""
    k = drawn(path, rng).step
    if k < 2 or homotopy is None:
        return None
    before = 0.5 * (path.u[k - 1] + path.u[k])
    signs = np.where(homotopy.switches(before[:-1], before[-1]) > 0.0, 1, -1)
    start = (path.steps[k - 1].u, path.steps[k - 1].tangent)
    steps = int(rng.integers(2, 7))
    beyond = trace(homotopy.piece(signs), start=start, target=None, budget=Budget(steps=steps + 1))
    if len(beyond) < 3:
        return None
    kept = [*path.steps[: k + 1], *(s for s in beyond.steps if s.arclength > 1.2 * beyond.steps[1].arclength)]
    if len(kept) < k + 2:
        return None
    known = [e for e in path.events if e.step < k or (e.step == k and rng.random() < 0.5)]
    found = numbered(path, [evolve(s, index=j) for j, s in enumerate(kept)], known)
    return evolve(found, status=Status.STOPPED_AT_EVENT)


FAULTS = (moved, swapped, shortcut, jumped, unlisted, invented, elsewhere)
AT_KINKS = (unkinked, misplaced, pushed, renamed, turned_back, straight_on)


def campaign(count: int, seed: int = 0) -> Counter:
    """How many corrupted paths of each kind were refused, and accepted."""
    rng, found, tried = np.random.default_rng(seed), Counter(), subjects()
    assert all(proved(homotopy, path) for homotopy, path, _ in tried)
    while sum(found.values()) < count:
        homotopy, path, proof = tried[int(rng.integers(len(tried)))]
        faults = (*FAULTS, *AT_KINKS) if path.kinks else FAULTS
        fault = faults[int(rng.integers(len(faults)))]
        linear = isinstance(homotopy, Linear)
        more = {"homotopy": homotopy} if fault is straight_on and not linear else {}
        corrupted = fault(path, proof, rng, **more)
        if corrupted is not None:
            found[fault.__name__, "accepted" if proved(homotopy, corrupted) else "refused"] += 1
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
