"""Every function of `continuation.intervals` against mpmath in 200 digits: is a value outside of its interval?"""

from collections.abc import Callable

import mpmath
import numpy as np

from continuation.intervals import Interval

DIGITS = 200

ONE = {
    **{name: name for name in ("exp", "expm1", "sin", "cos", "tan", "sinh", "cosh", "tanh", "sqrt", "log", "log1p")},
    **{f"arc{name}": f"a{name}" for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh")},
    "exp2": lambda x: mpmath.mpf(2) ** x,
    "log2": lambda x: mpmath.log(x) / mpmath.log(2),
    "log10": lambda x: mpmath.log(x) / mpmath.log(10),
    "cbrt": lambda x: mpmath.sign(x) * mpmath.cbrt(abs(x)),
    "square": lambda x: x * x,
    "absolute": abs,
    "reciprocal": lambda x: 1 / x,
}
"""mpmath's name, or the function."""

TWO = {
    "add": lambda x, y: x + y,
    "subtract": lambda x, y: x - y,
    "multiply": lambda x, y: x * y,
    "divide": lambda x, y: x / y,
    "power": lambda x, y: abs(x) ** y,
    "hypot": lambda x, y: mpmath.sqrt(x * x + y * y),
    "arctan2": mpmath.atan2,
    "maximum": max,
    "minimum": min,
}

INSIDE = {"arcsin", "arccos", "arctanh"}
POSITIVE = {"log", "log2", "log10", "sqrt"}


def arguments(name: str, generator: np.random.Generator, count: int) -> np.ndarray:
    """Numbers of all sizes where the function is defined: near its zeros and edges too."""
    sizes = 10.0 ** generator.uniform(-12.0, 2.5, count)
    x = sizes * generator.choice([-1.0, 1.0], count)
    if name in INSIDE:
        x = np.where(generator.random(count) < 0.5, np.tanh(x), np.copysign(1.0 - np.minimum(sizes, 1.0) / 2.0, x))
    elif name in POSITIVE:
        x = np.where(generator.random(count) < 0.5, sizes, 1.0 + np.tanh(x) / 2.0)
    elif name == "log1p":
        x = np.where(x <= -1.0, -1.0 / x, x)
        x[x <= -1.0] = 0.5
    elif name == "arccosh":
        x = 1.0 + sizes
    elif name in ("sin", "cos", "tan"):
        near = np.round(x / (np.pi / 2)) * (np.pi / 2)
        x = np.where(generator.random(count) < 0.3, near, x)
    return x


def violations(name: str, count: int, seed: int = 0) -> tuple[int, float]:
    """How many of so many values lie outside, and the share of intervals that say anything (are not nan)."""
    with mpmath.workdps(DIGITS):
        box, points, exact = _drawn(name, np.random.default_rng(seed), count)
        image = getattr(np, name)(*box)
        # The range over the box holds the value at a number inside.
        true = [exact(*map(mpmath.mpf, point)) for point in points]
        ends = zip(image.lo.tolist(), image.hi.tolist(), true, strict=True)
        outside = sum(a == a and b == b and not mpmath.mpf(a) <= value <= mpmath.mpf(b) for a, b, value in ends)
    return outside, np.isfinite(image.hi).mean()


def _drawn(name: str, generator: np.random.Generator, size: int) -> tuple[list[Interval], list, Callable]:
    """Boxes, a number inside of each, and the function in mpmath: a third of the boxes are thin."""
    if name in ONE:
        exact = ONE[name]
        columns = [arguments(name, generator, size)]
    else:
        exact = TWO[name]
        columns = [arguments(name, generator, size), arguments(name, generator, size)]
        if name == "power":
            columns = [np.minimum(np.abs(columns[0]), 1e3) + 1e-6, np.clip(columns[1], -30.0, 30.0)]
    if isinstance(exact, str):
        exact = getattr(mpmath, exact)
    boxes, inside = [], []
    for x in columns:
        width = np.abs(x) * 10.0 ** generator.uniform(-14.0, 0.5, size) * (generator.random(size) < 0.67)
        lo, hi = x - width * generator.random(size), x + width * generator.random(size)
        if name in INSIDE:
            lo, hi = np.maximum(lo, -0.9999999), np.minimum(hi, 0.9999999)
            lo, hi = np.minimum(lo, x), np.maximum(hi, x)
        boxes.append(Interval(lo, hi))
        inside.append(x.tolist())
    return boxes, list(zip(*inside)), exact
