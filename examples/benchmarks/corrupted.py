"""Corrupted paths by the thousand: is a path that is no path ever proved?

    python examples/benchmarks/corrupted.py 10000 [SEED]

Each corruption makes of traced paths something that they are not: continued on another sheet, points moved off the
curve by more than the radius of their tube, their order changed, a loop left out, turning points dropped or invented or
elsewhere; and those with kinks continued on the wrong piece, their kinks dropped, invented, moved or
called by other names. A complete proof of any of it is a fault. Points left out on one and the same curve are another
matter: there the proof is either complete, and holds them, or has a gap. From seed 1 on the paths are others for each
part of 250.
"""

import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
from attrs import evolve
from campaign import WRONG, Campaign, Verdict
from subjects import Linear, proved, subjects

from continuation import Budget, trace
from continuation.certificate import Proof
from continuation.path import LocatedEvent, Path
from continuation.status import Kind, Status

PART = 250


def one_of(among: Any, rng: np.random.Generator) -> Any:
    """One of some, at random."""
    return among[int(rng.integers(len(among)))]


def numbered(path: Path, steps: list, events: list) -> Path:
    """A path of these steps, as far apart as their arclengths; kinks keep their points, other events their arcs."""
    old = np.array([s.arclength for s in steps])
    new = old[0] + np.cumsum([0.0, *np.abs(np.diff(old))])
    again = [evolve(s, index=k, arclength=float(new[k])) for k, s in enumerate(steps)]
    kept = []
    for event in events:
        later = [(s.index, k) for k, s in enumerate(steps) if s.index >= event.step]
        index, k = min(later, default=(0, 0))
        if k and (event.kind is not Kind.KINK or index == event.step):
            share = np.clip((event.arclength - old[k - 1]) / (old[k] - old[k - 1]), 0.0, 1.0)
            at = new[k] if event.kind is Kind.KINK else new[k - 1] + share * (new[k] - new[k - 1])
            kept.append(evolve(event, step=k, arclength=float(at)))
    kept.sort(key=lambda e: e.arclength)
    return evolve(path, steps=again, events=kept)


def moved(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """Up to three points in a row moved off the curve, by twice the radius of the tubes beside the first at least.

    And by a thousandth of the path's extent at least.
    """
    k = int(rng.integers(0, len(path)))
    step, extent = path.steps[k], np.ptp(path.u, axis=0)
    beside = np.vstack([proof.radius(float(s)) for s in (path.arclength[k] - 1e-9, path.arclength[k] + 1e-9)])
    tube = np.nan_to_num(beside).max(axis=0)
    v = rng.normal(size=step.u.size)
    v -= step.tangent * float(step.tangent @ v) / float(step.tangent @ step.tangent)
    size = np.maximum(2.0 * tube, 1e-3 * extent) / np.maximum(np.abs(v), 1e-3 * np.abs(v).max())
    off = v * float(size.max()) * 10.0 ** rng.uniform(0.0, 1.5)
    last = k + int(rng.integers(3))
    return evolve(path, steps=[evolve(s, u=s.u + off) if k <= s.index <= last else s for s in path.steps])


def swapped(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """Two points exchanged, or a run of points reversed, with its tangents or not."""
    i, j = sorted(rng.choice(np.arange(1, len(path) - 1), 2, replace=False).tolist())
    steps = list(path.steps)
    if rng.random() < 0.3:
        steps[i], steps[j] = steps[j], steps[i]
    else:
        sign = rng.choice([-1.0, 1.0])
        steps[i : j + 1] = [evolve(s, tangent=sign * s.tangent) for s in steps[i : j + 1][::-1]]
    return numbered(path, steps, path.events)


def jumped(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
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


def elsewhere(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """An event moved off the curve."""
    event = one_of(path.events, rng)
    off = rng.normal(size=event.u.size) * np.ptp(path.u, axis=0) * 10.0 ** rng.uniform(-2.0, 1.0)
    return changed(path, event, evolve(event, u=event.u + off))


def left_out(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """Points left out on one and the same curve: no fault, but the tubes are then to hold them."""
    kinks = {e.step for e in path.kinks}
    inner = [s for s in path.steps[1:-1] if s.index not in kinks]
    if not inner:
        return None
    share = rng.uniform(0.1, 0.9)
    gone = {s.index for s in inner if rng.random() < share} or {inner[0].index}
    return numbered(path, [s for s in path.steps if s.index not in gone], path.events)


# --- kinks ------------------------------------------------------------------------------------------------


def changed(path: Path, old: Any, *new: Any) -> Path:
    """The path with other events in the place of one."""
    events = [*(e for e in path.events if e is not old), *new]
    return evolve(path, events=sorted(events, key=lambda e: e.arclength))


def drawn(path: Path, rng: np.random.Generator) -> Any:
    """One of the kinks; of a smooth path, of its turning points."""
    return one_of(path.kinks or path.turning_points, rng)


def unlisted(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """A kink dropped, half of the times with its point; or a turning point dropped, or listed twice."""
    twice = rng.random() < 0.5
    event = one_of([*path.kinks, *path.turning_points], rng)
    if event.kind is not Kind.KINK:
        return changed(path, event, *([event, event] if twice else []))
    steps = [s for s in path.steps if twice or s.index != event.step]
    return numbered(path, steps, [e for e in path.events if e is not event])


def misplaced(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """A kink or turning point at another point of the path: one more, or the event itself."""
    kink = drawn(path, rng)
    away = [s for s in path.steps if not {s.index, s.index + 1} & {e.step for e in path.events}]
    if not away:
        return None
    step = one_of(away, rng)
    like = evolve(kink, u=step.u, arclength=step.arclength, step=step.index)
    return changed(path, kink, like, *([kink] if rng.random() < 0.5 else []))


def pushed(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """A kink moved along the arc before it or after it, on the curve or nearly, with its point."""
    kink = drawn(path, rng)
    other = path.u[kink.step + (1 if rng.random() < 0.5 else -1)]
    u = kink.u + (other - kink.u) * float(10.0 ** rng.uniform(-3.0, -0.3))
    steps = [evolve(s, u=u) if s.index == kink.step else s for s in path.steps]
    return changed(evolve(path, steps=steps), kink, evolve(kink, u=u))


def renamed(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path:
    """A kink in which another switch is said to vanish, or one more, or the parameter to turn where it does not."""
    kink = drawn(path, rng)
    count = path.u.shape[1] - 1
    if rng.random() < 0.2:  # of a path that ends there
        known = [event for event in path.events if event.step <= kink.step]
        steps = path.steps[: kink.step + 1]
        path = evolve(path, steps=steps, events=known, status=Status.STOPPED_AT_EVENT)
    if rng.random() < 0.4:
        return changed(path, kink, evolve(kink, name="kink" if kink.name == "turning kink" else "turning kink"))
    other = int(rng.choice([j for j in range(count) if j not in kink.switches]))
    switches = (other,) if rng.random() < 0.6 else tuple(sorted((*kink.switches, other)))
    return changed(path, kink, evolve(kink, switches=switches))


def straight_on(homotopy: Any, path: Path, proof: Proof, rng: np.random.Generator) -> Path | None:
    """Continued on the wrong piece: past a kink by the equations that held before it."""
    k = drawn(path, rng).step
    if k < 2 or isinstance(homotopy, Linear):
        return None
    before = 0.5 * (path.u[k - 1] + path.u[k])
    signs = np.where(homotopy.switches(before[:-1], before[-1]) > 0.0, 1, -1)
    start = (path.steps[k - 1].u, path.steps[k - 1].tangent)
    steps = int(rng.integers(2, 7))
    beyond = trace(homotopy.piece(signs), start=start, target=None, budget=Budget(steps=steps + 1))
    least = 1.2 * beyond.arclength[:2].max()
    kept = [*path.steps[: k + 1], *(s for s in beyond.steps if s.arclength > least)]
    if len(kept) < k + 2:
        return None
    known = [e for e in path.events if e.step < k or (e.step == k and rng.random() < 0.5)]
    found = numbered(path, [evolve(s, index=j) for j, s in enumerate(kept)], known)
    return evolve(found, status=Status.STOPPED_AT_EVENT)


AT_KINKS = (unlisted, misplaced, pushed, renamed, straight_on)


def faults(path: Path) -> list[Any]:
    """The faults that suit a path."""
    found = [moved, swapped, jumped, left_out]
    found += AT_KINKS if path.kinks else (unlisted, misplaced) if path.turning_points else ()
    return [*found, *([elsewhere] if path.events else [])]


def cases(number: int, seed: int) -> Iterator[tuple[Any, Path, Any, Path]]:
    """Homotopy, path, fault, and the corrupted path; the paths are others from PART to PART."""
    for part in range(-(-number // PART)):
        rng, tried, left = np.random.default_rng(seed + part), subjects(seed + part), min(PART, number - part * PART)
        while left:
            homotopy, path, proof = one_of(tried, rng)
            fault = rng.choice(faults(path))
            corrupted = fault(homotopy, path, proof, rng)
            if corrupted is not None:
                left -= 1
                yield homotopy, path, fault, corrupted


def judge(case: tuple[Any, Path, Any, Path], way: Any) -> Verdict:
    """Whether a corrupted path is refused; one with points left out may be proved."""
    homotopy, path, fault, corrupted = case
    if not proved(homotopy, corrupted):
        return f"{fault.__name__} refused", np.nan
    if fault is left_out:
        kept = {s.u.tobytes() for s in corrupted.steps}
        gone = [
            LocatedEvent("on the path", Kind.EVENT, s.arclength, s.u, s.tangent, 0.0, 0.0, 1, s.index)
            for s in path.steps
            if s.u.tobytes() not in kept
        ]
        holding = numbered(path, [s for s in path.steps if s.u.tobytes() in kept], [*path.events, *gone])
        # Rational proofs are of the lines themselves, and take no event that is no kink.
        if isinstance(homotopy, Linear) or proved(homotopy, holding):
            return f"{fault.__name__} proved", np.nan
    return f"{WRONG}: {fault.__name__} accepted", np.nan


CAMPAIGN = Campaign({"corrupted paths": cases}, judge, {"": None})

if __name__ == "__main__":
    sys.exit(CAMPAIGN.main(200))
