"""Functions in mpmath, arguments of all sizes for them, and whether intervals hold what mpmath says in 200 digits."""

import mpmath as mp
import numpy as np

from continuation.intervals import Interval

DIGITS = 200

ONE = {
    **{
        name: getattr(mp, name)
        for name in ("exp", "expm1", "sin", "cos", "tan", "sinh", "cosh", "tanh", "sqrt", "log", "log1p")
    },
    **{f"arc{name}": getattr(mp, f"a{name}") for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh")},
    "exp2": lambda x: mp.mpf(2) ** x,
    "log2": lambda x: mp.log(x) / mp.log(2),
    "log10": lambda x: mp.log(x) / mp.log(10),
    "cbrt": lambda x: mp.sign(x) * mp.cbrt(abs(x)),
    "square": lambda x: x * x,
    "absolute": abs,
    "reciprocal": lambda x: 1 / x,
}
TWO = {
    "add": lambda x, y: x + y,
    "subtract": lambda x, y: x - y,
    "multiply": lambda x, y: x * y,
    "divide": lambda x, y: x / y,
    "power": lambda x, y: x**y,
    "hypot": lambda x, y: mp.sqrt(x * x + y * y),
    "arctan2": mp.atan2,
    "maximum": max,
    "minimum": min,
}


def inside(interval, exact, room=0):
    """Whether ends that are numbers hold exact values, or values known to `room`, entry by entry."""
    ends = zip(interval.lo.ravel().tolist(), interval.hi.ravel().tolist(), exact, strict=True)
    told = [(mp.mpf(lo), value, mp.mpf(hi)) for lo, hi, value in ends if lo == lo and hi == hi]
    return all(lo - room <= value <= hi + room for lo, value, hi in told)


def numbers(generator, shape):
    """Of all sizes, near 0, around 1 and -1, next to these, and next to multiples of a right angle."""
    x = 10.0 ** generator.uniform(-12.0, 2.5, shape) * generator.choice([-1.0, 1.0], shape)
    near = 1.0 + np.tanh(x) / 2.0, np.copysign(1.0 - np.minimum(np.abs(x), 1.0) / 2.0, x)
    return np.choose(generator.integers(0, 5, shape), [x, x, *near, np.round(x / (np.pi / 2)) * (np.pi / 2)])


@np.errstate(all="ignore")
def drawn(name, count, seed):
    """Of so many boxes in the function's domain, a third of them thin, and its exact values at a number in each."""
    function, exact, generator = getattr(np, name), {**ONE, **TWO}[name], np.random.default_rng(seed)
    x = numbers(generator, (function.nin, 40 * count))
    width = np.abs(x) * 10.0 ** generator.uniform(-14.0, 0.5, x.shape) * (generator.random(x.shape) < 0.67)
    places = np.stack([x - width * generator.random(x.shape), x, x + width * generator.random(x.shape)])
    defined = np.isfinite([function(*place) for place in places]).all(axis=0)
    lo, x, hi = places[..., defined][..., :count]
    with mp.workdps(DIGITS):
        return function(*map(Interval, lo, hi)), [exact(*map(mp.mpf, point)) for point in x.T.tolist()]
