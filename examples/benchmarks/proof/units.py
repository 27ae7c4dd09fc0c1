"""Proofs in random units: has a path that is complete all its turning points, and is a jump ever proved?

    python examples/benchmarks/proof/units.py [NUMBER] [SEED] [NAME ...]

NUMBER changes of units (default 40) of each acceptance problem. In each the path is traced and proved; and so is one by
a careless tracer, which measures steps as the first continuation codes did, by |du| / (1 + |u|), and is content with
whatever point its corrector finds: in these units it jumps and steps over folds. Which of its steps did so is told by
the path in the problem's own units, traced carefully. A complete proof of such a path is a fault.
"""

import sys
from collections import Counter
from itertools import pairwise
from pathlib import Path as File
from typing import Any

import numpy as np

from continuation import LocatedEvent, Path, Step, certify
from continuation.status import Kind, Status
from continuation.step.presets import DEFAULT

sys.path.insert(0, str(File(__file__).parents[1] / "units"))
from rescaled import Rescaled, plain, rescaled
from run import PROBLEMS, extent_of

FINE = 1000
"""Points of the careful path in each of its steps, against which the others are held."""

ASTRAY = 5e-3
"""Of the path's extent: a point that is farther away is on another branch."""


# --- a careless tracer ------------------------------------------------------------------------------------


def _tangent(homotopy: Rescaled, u: np.ndarray, along: np.ndarray) -> np.ndarray:
    H_y, H_lam = homotopy.jacobian(u[:-1], u[-1])
    matrix = np.vstack([np.column_stack([H_y, H_lam]), along])
    return np.linalg.solve(matrix, np.eye(u.size)[-1])


def _corrected(homotopy: Rescaled, u: np.ndarray, along: np.ndarray) -> np.ndarray | None:
    for _ in range(12):
        H_y, H_lam = homotopy.jacobian(u[:-1], u[-1])
        matrix = np.vstack([np.column_stack([H_y, H_lam]), along])
        step = np.linalg.solve(matrix, np.append(homotopy.residual(u[:-1], u[-1]), 0.0))
        u = u - step
        if not np.isfinite(u).all():
            return None
        if (np.abs(step) <= 1e-9 * (1e-3 * np.abs(along) ** -1 + np.abs(u))).all():
            return u
    return None


def _turn(homotopy: Rescaled, a: np.ndarray, b: np.ndarray, weights: np.ndarray) -> np.ndarray | None:
    """The zero of the parameter's rate between two points, by bisection."""
    along, low, high = weights * (b - a), 0.0, 1.0
    sign = _tangent(homotopy, a, along)[-1]
    u: np.ndarray | None = a
    for _ in range(50):
        middle = 0.5 * (low + high)
        u = _corrected(homotopy, a + middle * (b - a), along)
        if u is None:
            return None
        low, high = (middle, high) if _tangent(homotopy, u, along)[-1] * sign > 0.0 else (low, middle)
    return u


@np.errstate(all="ignore")
def careless(homotopy: Rescaled, extent: np.ndarray, direction: float, steps: int = 60) -> Path:
    """Euler's predictor, Newton's corrector, and steps that grow by a half for as long as that converges."""
    y, lam = homotopy.start()
    u, h = np.append(y, lam), 0.02
    weights = 1.0 / (1.0 + np.abs(u))
    t = _tangent(homotopy, u, np.append(np.zeros(y.size), direction))
    points, tangents, lengths, events = [u], [t], [0.0], []
    for _ in range(20 * steps):
        if (
            len(points) > steps
            or (np.abs(homotopy.original(u)) > 20.0 * (extent + np.abs(homotopy.original(points[0])))).any()
        ):
            break
        unit = t / np.linalg.norm(weights * t)
        try:
            new = _corrected(homotopy, u + h * unit, weights**2 * unit)
            after = None if new is None else _tangent(homotopy, new, weights**2 * unit)
        except np.linalg.LinAlgError:
            new = None
        if new is None or after is None:
            h *= 0.5
            continue
        s = lengths[-1] + float(np.linalg.norm(weights * (new - u)))
        if after[-1] * t[-1] < 0.0:
            turn = _turn(homotopy, u, new, weights**2)
            if turn is not None:
                at = 0.5 * (lengths[-1] + s)
                kind = Kind.TURNING_POINT
                events.append(LocatedEvent("turning point", kind, at, turn, t, 0.0, 0.0, 1, len(points)))
        points, tangents, lengths = [*points, new], [*tangents, after], [*lengths, s]
        u, t, h, weights = new, after, min(1.5 * h, 0.5), 1.0 / (1.0 + np.abs(new))
    return carried(np.array(points), np.array(tangents), np.array(lengths), events)


def carried(points: Any, tangents: Any, lengths: Any, events: list[LocatedEvent]) -> Path:
    """Points of any tracer as a path."""
    steps = [Step(k, u, t, arclength=float(s)) for k, (u, t, s) in enumerate(zip(points, tangents, lengths))]
    return Path(steps=steps, events=events, status=Status.TRACING)


# --- what it is held against ------------------------------------------------------------------------------


def faults(path: Path, units: Rescaled, reference: Path) -> tuple[bool, int]:
    """Whether a path in these units jumped, or left the careful one; and how many turns up to there it missed.

    Steps beyond the end of the careful path are not judged; where it closes they go round it again.
    """
    fine = np.unique(np.concatenate([np.linspace(a, b, FINE) for a, b in pairwise(reference.arclength.tolist())]))
    extent = extent_of(reference)
    dense = reference(fine) / extent
    closed, round_ = reference.status is Status.CLOSED, float(fine[-1])
    before, jumped = 0.0, False
    for step in path.steps[1:]:
        far = np.linalg.norm(dense - units.original(step.u) / extent, axis=1)
        place = int(np.argmin(far))
        # The next point of the way, not the nearest one: ways may close, or come by again.
        ahead = (fine - before) % round_ if closed else fine - before
        near = far <= max(2.0 * far[place], 0.1 * ASTRAY)
        later = ahead[near & (ahead >= -1e-12 * round_) & (ahead < (0.5 * round_ if closed else np.inf))]
        if far[place] > ASTRAY and place == len(fine) - 1:
            break
        if far[place] > ASTRAY or not len(later):
            jumped = True
            break
        before += max(float(later.min()), 0.0)
    turns = [e.u / extent for e in reference.turning_points if e.arclength < before - ASTRAY * fine[-1]]
    found = [units.original(e.u) / extent for e in path.turning_points]
    missed = sum(all(np.linalg.norm(a - b) > ASTRAY for b in found) for a in turns)
    return jumped, missed


def campaign(name: str, number: int, seed: int = 0) -> Counter:
    """Verdicts on the traced paths and on the careless ones of one problem."""
    problem, generator = PROBLEMS[name], np.random.default_rng([seed, len(name)])
    homotopy = problem.make()
    reference = problem.trace(plain(homotopy), DEFAULT)
    direction = float(np.sign(reference.steps[0].tangent[-1])) or 1.0
    found: Counter = Counter()
    for _ in range(number):
        units = rescaled(homotopy, extent_of(reference), generator)
        path = problem.trace(units, DEFAULT)
        proof, whole = certify(path, units), len(path.turning_points) == len(reference.turning_points)
        found["complete" if proof.complete else "gap", "all turns" if whole else "TURNS MISSED"] += 1
        path = careless(units, extent_of(reference), direction)
        jumped, missed = faults(path, units, reference)
        kind = "careless, jumped" if jumped else "careless, turns missed" if missed else "careless, none seen"
        found["complete" if len(path) > 1 and certify(path, units).complete else "gap", kind] += 1
    return found


if __name__ == "__main__":
    numbers = [int(text) for text in sys.argv[1:] if text.isdigit()]
    asked, first = numbers + [40, 0][len(numbers) :]
    for which in [text for text in sys.argv[1:] if not text.isdigit()] or PROBLEMS:
        for part in range(-(-asked // 5)):
            told = campaign(which, min(5, asked - 5 * part), first + part)
            print(which, first + part, {" / ".join(key): value for key, value in sorted(told.items())}, flush=True)
