"""Random problems on whose path branches cross at known places: transversal, pitchforks, transcritical ones.

In x and s, one unknown obeys p(x_0, s) = 0 with crossings in closed form, the others follow it smoothly. The tracer
gets unknowns and equations that are mixed and in random units: y = D T x + c, lam = a s + b, H = E (...).
"""

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import frozen
from scipy.optimize import brentq

from continuation import from_functions
from continuation.arrays import Array


@frozen(eq=False)
class Crossed:
    """A homotopy with known crossings.

    Attributes
    ----------
    homotopy : Homotopy
    original : callable
        (y, lam) to (x, s).
    curve : callable
        s to the point (x_0, s) of the path.
    crossings : list of (x_0, s)
        On the way, in order.
    resolution : float
        The error of a crossing's place by round-off: in y, if zero is far off, and in the matrix products of H'.
        It grows where branches nearly touch.
    """

    homotopy: Any
    original: Callable[[Any, Any], tuple[Any, Any]]
    curve: Callable[[float], tuple[float, float]]
    crossings: list[tuple[float, float]]
    resolution: float


def _dressed(
    rng: np.random.Generator,
    n: int,
    units: float,
    scalar: Callable[[Any, Any], Any],
    curve: Callable[[float], tuple[float, float]],
    crossings: list[tuple[float, float]],
    begin: float,
    end: float,
    angle: float = 1.0,
) -> Crossed:
    """p = `scalar` with followers, mixed and in units; the path is `curve` from s = begin to end.

    `angle` is the least difference of slopes at a crossing.
    """
    mix, equations = (np.eye(n) + rng.normal(0.0, 0.5 / np.sqrt(n), (n, n)) for _ in range(2))
    D = 10.0 ** rng.uniform(-units, units, n + 1)
    shift = D * rng.normal(0.0, 1.0, n + 1) * 10.0 ** rng.uniform(0.0, 3.0 * min(units, 1.0), n + 1)
    E = 10.0 ** rng.uniform(-units, units, n)
    equations = E[:, None] * equations
    shape = rng.normal(0.0, 0.5, (n, 4))
    unmix = np.linalg.inv(mix)

    def follow(x0: Any, s: Any) -> Any:
        a, b, c, d = shape[1:].T
        return a * np.sin(b * s + c) + d * x0 * s

    def original(y: Any, lam: Any) -> tuple[Any, Any]:
        return unmix @ ((y - shift[:-1]) / D[:-1]), (lam - shift[-1]) / D[-1]

    def point(x0: float, s: float) -> tuple[Array, float]:
        return D[:-1] * (mix @ np.append(x0, follow(x0, s))) + shift[:-1], float(D[-1] * s + shift[-1])

    def residual(y: Any, lam: Any) -> Any:
        x, s = original(y, lam)
        return equations @ np.concatenate([np.stack([scalar(x[0], s)]), x[1:] - follow(x[0], s)])

    def rounding(x0: float, s: float) -> float:
        size = np.abs(np.append(*point(x0, s))) / D
        inner = np.eye(n)
        inner[1:, 0] = null = -shape[1:, 3] * s
        products = np.abs(unmix) @ np.abs(mix @ np.append(1.0, -null))
        products = np.abs(np.linalg.inv(equations)[0]) @ (np.abs(equations) @ (np.abs(inner) @ products))
        return float(np.abs(unmix[0]) @ size[:-1] + size[-1] + products)

    # The kernels of OpenBLAS give up to 420 of these units: a product of n terms is rounded n times.
    worst = 1000.0 * float(np.finfo(float).eps) * max(rounding(*at) for at in crossings) / angle
    homotopy = from_functions(residual, start=point(*curve(begin)), target=point(*curve(end))[1])
    return Crossed(homotopy, original, curve, crossings, worst)


def _graph(k: Array, s: Any) -> Any:
    return k[0] * s + k[1] * s**2 / 2.0 + k[2] * 0.3 * (np.sin(2.0 * s) - 2.0 * s)


def _slope(k: Array, s: Any) -> Any:
    return k[0] + k[1] * s + k[2] * 0.6 * (np.cos(2.0 * s) - 1.0)


def _roots(k: Array, s: Array) -> list[float]:
    """The zeros at which a graph changes its sign in a table."""
    value = _graph(k, s)
    after = np.flatnonzero(value[:-1] * value[1:] < 0.0)
    return [float(brentq(partial(_graph, k), s[i], s[i + 1], xtol=1e-15)) for i in after]


def transversal(rng: np.random.Generator, n: int, units: float, near: bool = True) -> Crossed:
    """Two graphs x_0 = f(s), g(s) that differ by 10^-2..1, if `near`, and cross at most three times; the path is f."""
    while True:
        a = rng.normal(0.0, 1.0, 3)
        b = a + rng.normal(0.0, 1.0, 3) * (10.0 ** rng.uniform(-2.0, 0.0) if near else 1.0)
        begin = float(-2.0 + rng.uniform(-0.3, 0.3))
        roots, size = _roots(a - b, np.linspace(begin, 2.0, 4002)), np.abs(a - b).max()
        # Crossings that touch, or lie at the ends, are not simple or not on the way. All cross at 0: where the table
        # shows no change of sign there, a second one is next to it.
        if (
            any(abs(t) < 1e-9 for t in roots)
            and all(abs(_slope(a - b, t)) > 0.05 * size for t in roots)
            and min(abs(_graph(a - b, begin)), abs(_graph(a - b, 2.0))) > 1e-2 * size
            and all(begin < t < 2.0 for t in roots)
            and all(abs(t - u) > 0.05 for t, u in pairwise(roots))
        ):
            break

    return _two(rng, n, units, a, lambda s: (_graph(b - a, s), _slope(b - a, s)), roots, begin)


def pairs(rng: np.random.Generator, n: int, units: float) -> Crossed:
    """Two graphs that cross 0.01 to 0.5 apart, and nowhere else; one path in three is straight."""
    a = rng.normal(0.0, 1.0, 3) * rng.choice([0.0, 1.0, 1.0])
    gap, middle = 10.0 ** rng.uniform(-2.0, -0.3), float(rng.uniform(-1.3, 1.3))
    first, second = roots = [middle - 0.5 * gap, middle + 0.5 * gap]
    c, e = float(10.0 ** rng.uniform(-0.7, 0.7) * rng.choice([-1.0, 1.0])), float(rng.uniform(-0.2, 0.6))

    def difference(s: float) -> tuple[float, float]:
        pair, grows = (s - first) * (s - second), 1.0 + 0.25 * e * s * s
        return c * pair * grows, c * ((2.0 * s - first - second) * grows + 0.5 * e * pair * s)

    return _two(rng, n, units, a, difference, roots, float(-2.0 + rng.uniform(-0.3, 0.3)))


def _two(
    rng: np.random.Generator,
    n: int,
    units: float,
    a: Array,
    difference: Callable[[float], tuple[float, float]],
    roots: list[float],
    begin: float,
) -> Crossed:
    """A graph, and another one that differs from it by a function, given with its derivative."""

    def p(x: Any, s: Any) -> Any:
        above = x - _graph(a, s)
        return above * (above - difference(s)[0])

    return _dressed(
        rng,
        n,
        units,
        scalar=p,
        curve=lambda s: (float(_graph(a, s)), s),
        begin=begin,
        end=2.0,
        crossings=[(float(_graph(a, t)), t) for t in roots],
        angle=min(abs(difference(t)[1]) for t in roots),
    )


def pitchfork(rng: np.random.Generator, n: int, units: float) -> Crossed:
    """x_0 (s - s_0 - k x_0^2) = 0 along the trunk."""
    at, k = float(rng.uniform(-0.9, 0.9)), float(rng.uniform(0.3, 3.0)) * rng.choice([-1.0, 1.0])
    return _dressed(
        rng, n, units, scalar=lambda x, s: x * (s - at - k * x * x), curve=lambda s: (0.0, s), crossings=[(0.0, at)],
        begin=float(-rng.uniform(1.0, 2.0)), end=float(rng.uniform(1.0, 2.0)),
    )  # fmt: skip


def transcritical(rng: np.random.Generator, n: int, units: float) -> Crossed:
    """x_0 (x_0 - k (s - s_0)) = 0, on either branch."""
    at, k = float(rng.uniform(-0.9, 0.9)), float(rng.normal())
    straight = bool(rng.integers(2))
    return _dressed(
        rng, n, units, scalar=lambda x, s: x * (x - k * (s - at)),
        curve=lambda s: (0.0 if straight else k * (s - at), s), crossings=[(0.0, at)],
        begin=float(-rng.uniform(1.0, 2.0)), end=float(rng.uniform(1.0, 2.0)), angle=min(abs(k), 1.0),
    )  # fmt: skip
