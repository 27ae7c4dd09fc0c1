"""Where on an accepted arc a function of its points vanishes: one scanner for events, targets, faces and switches.

The arc's guide is a model of the function, and costs no evaluation of H. An arc has no zero where the model keeps the
sign that the function has at both ends, and comes down to no less than half of what it is there. It has one zero where
the ends have two signs and the model changes its sign once: there a secant converges, on points of the path. Any other
arc is divided by a point of the path, where the model is lowest or has come through zero, and both parts are asked
again.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from attrs import evolve, frozen
from scipy.optimize import brentq, minimize_scalar

from continuation.arrays import Array, largest
from continuation.contraction import HALVING
from continuation.evaluation.errors import EvaluationError
from continuation.point.arc import Arc
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.point.segment import CUBIC, Segment, hermite

Function = Callable[[Array, Array], float]
"""Of a point and its tangent; continuous along the path."""

JUMP = 1e-3
"""A bracket that has closed round more than this, relative to where it began, holds a jump and no zero."""

MONITOR_PLACES = 17
"""Places where a function is looked at before its lowest value is sought: a cubic has two turns at most."""

DIVISIONS, INSIDE_ARC = 8, 1e-6
"""An arc is divided so often in a row at most, so far inside of it."""

PASSES, NEARLY_ZERO = 60, 1e-10
"""A bisection in every other pass narrows a bracket to round-off in these. A value that small, beside those at the
ends, will do where the last two have not halved it."""

SLOPE = 1e-3
"""Of a part: the difference that shows the slope of its model, to three digits as the model itself."""

TRANSVERSAL = 1e-6
"""The least component of a tangent, relative to its largest, along which a point is put on a value exactly."""


def zero_between(function: Callable[[float], float], low: float, high: float, **options: float) -> float | None:
    """A zero, by Brent's method, of a function that costs little and has different signs at two places.

    None where it is NaN on the way. The options are those of `scipy.optimize.brentq`.
    """
    try:
        return float(brentq(function, low, high, disp=False, **options))
    except ValueError:
        return None


def may_vanish(function: Function, arc: Arc, ga: float, gb: float) -> bool:
    """Whether a function may vanish on an arc, judged by its values at the ends and its least value inside.

    Ends of one sign may hide a pair of zeros where it has the other sign there, or dips to less than half of both.
    """
    if gb == 0.0 or ga * gb < 0.0:
        return True
    sign = math.copysign(1.0, ga)
    values = [sign * ga, *(sign * function(u, v) for u, v in arc.samples), sign * gb]
    return _least((0.0, *arc.guide.inside, 1.0), values) < 0.5 * min(abs(ga), abs(gb))


def _least(places: Sequence[float], values: Sequence[float]) -> float:
    """The least of some values and of the parabolas through each three neighbours between them.

    For the parameter's component of a cubic's tangent that is the least of all.
    """
    least = min(values)
    slopes = [(b - a) / (q - p) for p, q, a, b in zip(places, places[1:], values, values[1:])]
    for p, q, r, a, left, right in zip(places, places[1:], places[2:], values, slopes, slopes[1:]):
        bend = (right - left) / (r - p)
        if bend > 0.0:
            lowest = 0.5 * (p + q - left / bend)
            if p < lowest < r:
                least = min(least, a + (lowest - p) * (left + bend * (lowest - q)))
    return least


@frozen(eq=False)
class _Part:
    """A part of an arc between two points of the path, the function there, and its model from `low` to `high`."""

    a: Linearization
    b: Linearization
    ga: float
    gb: float
    model: Segment
    low: float = 0.0
    high: float = 1.0
    depth: int = 0

    def divided(self, point: Linearization, g: float, t: float, border: Array) -> tuple[_Part, _Part]:
        """The two parts on either side of a point. A series stays their model, a cubic gives way to two."""
        parts = []
        for a, b, ga, gb, low, high in (
            (self.a, point, self.ga, g, self.low, t),
            (point, self.b, g, self.gb, t, self.high),
        ):
            series = len(self.model.inside) > CUBIC
            model = (self.model, low, high) if series else (hermite(a.u, a.tangent, b.u, b.tangent, border), 0.0, 1.0)
            parts.append(_Part(a, b, ga, gb, *model, depth=self.depth + 1))
        return parts[0], parts[1]

    def undecided(self, along: Callable[[float], float]) -> float | None:
        """Where to divide it, with the function `along` its model; None if its ends say what is on it."""
        sign = math.copysign(1.0, self.ga)
        places = np.linspace(self.low, self.high, MONITOR_PLACES).tolist()
        values = [sign * self.ga, *(sign * along(t) for t in places[1:-1]), sign * self.gb]
        turns = [k for k, (p, q) in enumerate(itertools.pairwise(values)) if p > 0.0 > q or p < 0.0 < q]
        if self.gb * self.ga <= 0.0:
            if len(turns) <= (self.gb != 0.0):
                return None
            m = max(len(turns) // 2 - 1, 0)
            between = range(turns[m] + 1, turns[m + 1] + 1 if m + 1 < len(turns) else len(values) - 1)
            return float(places[max(between, key=lambda k: abs(values[k]), default=turns[m])])
        if not turns and _least(places, values) >= 0.5 * min(abs(self.ga), abs(self.gb)):
            return None
        k = min(range(len(values)), key=values.__getitem__)
        around = places[max(k - 1, 0)], places[min(k + 1, len(places) - 1)]
        lowest = minimize_scalar(lambda t: sign * along(t), bounds=around, method="bounded", options={"xatol": 1e-9})
        return float(lowest.x)


def zeros(
    solver: PathSolver, function: Function, arc: Arc, ga: float, gb: float, noise: float = 0.0, direction: int = 0
) -> Iterator[Linearization]:
    """The zeros of a function on the arc, in order, each on the path to round-off.

    Parameters
    ----------
    solver : PathSolver
    function : callable
        (u, v) -> float
    arc : Arc
    ga, gb : float
        The function at the ends; ga is not zero.
    noise : float
        Values inside of the arc up to this are round-off, and change no sign.
    direction : int
        +1 only where it rises, -1 only where it falls.
    """

    def along(part: _Part, t: float) -> float:
        return function(part.model.at(t), part.model.derivative(t) / arc.length)

    def value(part: _Part, known: dict[float, Linearization], t: float) -> float:
        before, after = max(p for p in known if p < t), min(p for p in known if p > t)
        a, b, nearer = known[before], known[after], before if t - before < after - t else after
        segment, s = part.model, t
        if len(known) > 2:
            segment, s = hermite(a.u, a.tangent, b.u, b.tangent, arc.border), (t - before) / (after - before)
        known[t] = solver.project_and_linearize(known[nearer], segment.at(s), arc.border, segment.derivative(s))
        return function(known[t].u, known[t].tangent)

    parts = [_Part(arc.a, arc.b, ga, gb, arc.guide)]
    while parts:
        part = parts.pop()
        if part.ga == 0.0:
            continue
        low, high, model = part.low, part.high, partial(along, part)
        known = {low: part.a, high: part.b}
        t = part.undecided(model) if part.depth < DIVISIONS else None
        if t is not None and INSIDE_ARC < (t - low) / (high - low) < 1.0 - INSIDE_ARC:
            g = value(part, known, t)
            if abs(g) <= noise:
                g = math.copysign(noise, part.ga)
            parts += part.divided(known[t], g, t, arc.border)[::-1]
        elif part.ga * part.gb <= 0.0 and np.sign(part.ga) * direction <= 0:
            guess, slope = zero_between(model, low, high), math.nan
            if guess is not None:
                slope = (model(guess + SLOPE * (high - low)) - model(guess)) / (SLOPE * (high - low))
            enough = solver.noise(part.a) / arc.length
            found = root(partial(value, part, known), (low, part.ga), (high, part.gb), enough, guess, slope)
            if found is not None:
                yield known[found]


def root(
    function: Callable[[float], float],
    a: tuple[float, float],
    b: tuple[float, float],
    enough: float,
    guess: float | None = None,
    slope: float = math.nan,
) -> float | None:
    """Where a function vanishes between two places; None where it jumps through zero instead, as a tangent may.

    By the secant method. A bisection follows where that leaves the bracket, or has not halved the value.

    Parameters
    ----------
    function : callable
        Asked for the zero last or as one of the last.
    a, b : (place, value)
        Of different signs.
    enough : float
        How near a place is known.
    guess, slope : float
        Of a model of the function: its zero, and the slope there.
    """
    scale, best = max(abs(a[1]), abs(b[1])), min(a, b, key=lambda place: abs(place[1]))
    if best[1] == 0.0:
        return best[0]
    last, stalled = None, 0
    chord = (b[1] - a[1]) / (b[0] - a[0])
    t = a[0] - a[1] / chord if guess is None else guess
    for _ in range(PASSES):
        if stalled % 2 or not a[0] < t < b[0]:
            t = 0.5 * (a[0] + b[0])
        now = t, function(t)
        stalled = stalled + 1 if abs(now[1]) > HALVING * abs(best[1]) else 0
        a, b = (now, b) if a[1] * now[1] > 0.0 else (a, now)
        best = min(best, now, key=lambda place: abs(place[1]))
        if last is not None and now[0] != last[0]:
            slope = (now[1] - last[1]) / (now[0] - last[0])
        elif not slope * chord > 0.0:
            slope = chord
        step = -now[1] / slope if slope else math.inf
        small = abs(best[1]) <= NEARLY_ZERO * scale and stalled > 1
        if now[1] == 0.0 or small or abs(step) <= enough or b[0] - a[0] <= enough:
            break
        last, t = now, t + step
    return None if abs(best[1]) > JUMP * scale and b[0] - a[0] > enough else best[0]


def on_value(solver: PathSolver, point: Linearization, component: int, value: float) -> Linearization:
    """The point with a component put exactly on a value next to it, if the path is transversal to that there."""
    if abs(point.tangent[component]) <= TRANSVERSAL * largest(point.tangent):
        return point
    unit, guess = np.zeros_like(point.u), point.u.copy()
    unit[component], guess[component] = 1.0, value
    try:
        u, _ = solver.project(point, guess, unit)
    except EvaluationError:
        return point
    u[component] = value
    return evolve(point, u=u)
