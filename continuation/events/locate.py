"""Zeros of a function on an accepted arc, for events, targets, faces and switches.

The arc's guide models the function without evaluations of H. An arc has no zero if the model keeps the ends' sign and
half of the smaller end value. It has one if the ends differ in sign and the model changes sign once: secants find it on
the path. Other arcs are divided.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from attrs import evolve, frozen
from scipy.optimize import brentq, minimize_scalar

from continuation.arrays import ROOT_OF_ROUND_OFF, SIX_DIGITS, Array, largest
from continuation.contraction import HALVING
from continuation.evaluation.errors import EvaluationError
from continuation.point.arc import Arc
from continuation.point.linearization import Linearization
from continuation.point.projection import PathSolver
from continuation.point.segment import CUBIC, Segment, hermite

Function = Callable[[Array, Array], float]
"""A function of point and tangent, continuous along the path."""

THREE_DIGITS = math.sqrt(SIX_DIGITS)
"""Digits of a model: relative step of its difference quotient; a bracket that closes on a larger value, relative to its
first ones, holds a jump."""

MONITOR_PLACES = 17
"""Samples of the model; a cubic turns at most twice."""

CONVERGES = 8.0
"""Least fall of the model's error at half the length; a cubic's falls sixteenfold. Without it functions like a
determinant beside a fold, which cubics model badly, cost 256 divisions of an arc."""

DIVISIONS = 8
"""Most divisions of an arc."""

PASSES = 60
"""Most evaluations of `root`: every other one bisects, down to round-off."""


def zero_between(function: Callable[[float], float], low: float, high: float, **options: float) -> float | None:
    """A zero of a cheap function by `scipy.optimize.brentq`; None for NaN."""
    try:
        return float(brentq(function, low, high, disp=False, **options))
    except ValueError:
        return None


def may_vanish(function: Function, arc: Arc, ga: float, gb: float) -> bool:
    """Whether samples of a function, or parabolas through them, change sign or fall below half of both end values."""
    if gb == 0.0 or ga * gb < 0.0:
        return True
    sign = math.copysign(1.0, ga)
    values = [sign * ga, *(sign * function(u, v) for u, v in arc.samples), sign * gb]
    return _least((0.0, *arc.guide.inside, 1.0), values) < 0.5 * min(abs(ga), abs(gb))


def _least(places: Sequence[float], values: Sequence[float]) -> float:
    """Least of values and of parabolas through neighbours."""
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
    """A part of an arc, with the function's end values and its model from `low` to `high`.

    `error`: of the model of twice the length. `known`: whether errors shrink at least eightfold.
    """

    a: Linearization
    b: Linearization
    ga: float
    gb: float
    model: Segment
    low: float = 0.0
    high: float = 1.0
    depth: int = 0
    error: float = math.inf
    known: bool = False

    def divided(self, point: Linearization, g: float, t: float, border: Array, expected: float) -> tuple[_Part, _Part]:
        """Divide at a point, where the model gave `expected`; a cubic becomes two."""
        parts, error = [], abs(g - expected)
        for a, b, ga, gb, low, high in (
            (self.a, point, self.ga, g, self.low, t),
            (point, self.b, g, self.gb, t, self.high),
        ):
            series = len(self.model.inside) > CUBIC
            model = (self.model, low, high) if series else (hermite(a.u, a.tangent, b.u, b.tangent, border), 0.0, 1.0)
            parts.append(_Part(a, b, ga, gb, *model, self.depth + 1, error, error <= self.error / CONVERGES))
        return parts[0], parts[1]

    def undecided(self, along: Callable[[float], float]) -> float | None:
        """The parameter of a division, or None if the ends decide."""
        sign = math.copysign(1.0, self.ga)
        places = np.linspace(self.low, self.high, MONITOR_PLACES).tolist()
        room = self.error / CONVERGES if self.known and self.ga * self.gb > 0.0 else 0.0
        values = [sign * self.ga, *(sign * along(t) + room for t in places[1:-1]), sign * self.gb]
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
    """Zeros of a function on the arc, in order, to round-off.

    `ga`, `gb`: values at the ends; ga is not zero. `noise`: round-off of values. `direction`: +1 rising only, -1
    falling only.
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
        if t is not None and SIX_DIGITS < (t - low) / (high - low) < 1.0 - SIX_DIGITS:
            g = value(part, known, t)
            if abs(g) <= noise:
                g = math.copysign(noise, part.ga)
            parts += part.divided(known[t], g, t, arc.border, model(t))[::-1]
        elif part.ga * part.gb <= 0.0 and np.sign(part.ga) * direction <= 0:
            guess, slope = zero_between(model, low, high), math.nan
            if guess is not None:
                slope = (model(guess + THREE_DIGITS * (high - low)) - model(guess)) / (THREE_DIGITS * (high - low))
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
    """A zero between a and b = (parameter, value); None if the function jumps.

    `enough`: accuracy. `guess`, `slope`: of a model.
    """
    scale = max(abs(a[1]), abs(b[1]))
    if 0.0 in (a[1], b[1]):
        return a[0] if a[1] == 0.0 else b[0]
    # The arc before may have had its zero at an end, to round-off.
    best = (a[0], scale)
    last, stalled = None, 0
    chord = (b[1] - a[1]) / (b[0] - a[0])
    t = a[0] - a[1] / chord if guess is None else guess
    for _ in range(PASSES):
        if stalled % 2 or not a[0] < t < b[0]:
            t = 0.5 * (a[0] + b[0])
        if not a[0] < t < b[0]:
            break  # adjacent floats
        now = t, function(t)
        stalled = stalled + 1 if abs(now[1]) > HALVING * abs(best[1]) else 0
        a, b = (now, b) if a[1] * now[1] > 0.0 else (a, now)
        best = min(best, now, key=lambda place: abs(place[1]))
        if last is not None and now[0] != last[0]:
            slope = (now[1] - last[1]) / (now[0] - last[0])
        elif not slope * chord > 0.0:
            slope = chord
        step = -now[1] / slope if slope else math.inf
        # Half of the digits are enough if a pass did not halve the value; at a slope below half the chord's, where the
        # zero may be double, if two did not.
        small = abs(best[1]) <= ROOT_OF_ROUND_OFF * scale and stalled > (abs(slope) < HALVING * abs(chord))
        if now[1] == 0.0 or small or abs(step) <= enough or b[0] - a[0] <= enough:
            break
        last, t = now, t + step
    return None if abs(best[1]) > THREE_DIGITS * scale and b[0] - a[0] > enough else best[0]


def on_value(solver: PathSolver, point: Linearization, component: int, value: float) -> Linearization:
    """Put a component exactly on a value, if the path is transversal."""
    if abs(point.tangent[component]) <= SIX_DIGITS * largest(point.tangent):
        return point
    unit, guess = np.zeros_like(point.u), point.u.copy()
    unit[component], guess[component] = 1.0, value
    try:
        u, _ = solver.project(point, guess, unit)
    except EvaluationError:
        return point
    u[component] = value
    return evolve(point, u=u)
