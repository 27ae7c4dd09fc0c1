"""A second opinion on tubes: Krawczyk's test once more, in the ball arithmetic of python-flint, by other authors.

Nothing is shared with `continuation.intervals`: the residual runs on arrays of objects, each a truncated power series
of balls (Arb; Johansson, IEEE Trans. Comput. 66 (2017) 1281-1292), one direction at a time.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import OVERHANG, Cells

BITS = 113
"""Of each ball's middle: twice those of a double, so that its own round-off is no matter."""

RANGE_PARTS, DEPTH = 4, 7
"""Into how many parts a slab is cut where the test fails, and how often: it is a plainer one, its preconditioner stands
still."""

_ARCS = {f"arc{name}": f"a{name}" for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh")}


class Series:
    """A power series of balls as one number: what numpy calls in its loops over objects."""

    __slots__ = ("value",)

    def __init__(self, value: Any) -> None:
        self.value = value

    def __getattr__(self, name: str) -> Any:
        function = getattr(self.value, _ARCS.get(name, name), None)
        if function is None:
            raise AttributeError(f"balls do not know {name}")
        return lambda: Series(function())

    def square(self) -> Series:
        """Its square."""
        return Series(self.value * self.value)

    def __neg__(self) -> Series:
        return Series(-self.value)

    def __pow__(self, exponent: Any) -> Series:
        if exponent != int(exponent):
            return Series(self.value ** _plain(exponent))
        # By products: the power of a series that is a ball around zero alone is nan in python-flint 0.9.
        power, count = self.value**0, abs(int(exponent))
        for digit in f"{count:b}":
            power = power * power * self.value if digit == "1" else power * power
        return Series(1 / power if exponent < 0 else power)


def _plain(x: Any) -> Any:
    return x.value if isinstance(x, Series) else float(x)


def _operator(function: Callable[[Any, Any], Any], swapped: bool = False) -> Any:
    def method(self: Series, other: Any) -> Any:
        if isinstance(other, np.ndarray):
            return NotImplemented
        a, b = self.value, _plain(other)
        return Series(function(b, a) if swapped else function(a, b))

    return method


for _name, _function in (
    ("add", operator.add),
    ("sub", operator.sub),
    ("mul", operator.mul),
    ("truediv", operator.truediv),
):
    setattr(Series, f"__{_name}__", _operator(_function))
    setattr(Series, f"__r{_name}__", _operator(_function, swapped=True))


def confirmed(residual: Callable[[Any, Any], Any], cells: Cells) -> list[bool]:
    """Whether the tubes hold, cell by cell, by python-flint.

    Parameters
    ----------
    residual : callable
        ``residual(y, lam)``, of the homotopy.
    cells : Cells

    Raises
    ------
    ImportError
        If python-flint is not installed.
    TypeError
        If the residual uses a function that its balls do not know.
    """
    flint: Any = import_module("flint")
    before, flint.ctx.prec = flint.ctx.prec, BITS
    try:
        return [_holds(flint, residual, cells.take(slice(k, k + 1))) for k in range(len(cells))]
    finally:
        flint.ctx.prec = before


def _holds(flint: Any, residual: Callable[[Any, Any], Any], cell: Cells) -> bool:
    count = int(cell.slabs[0])
    length = (1.0 + 2.0 * OVERHANG) / count
    return all(
        _covered(flint, residual, cell, -OVERHANG + (k + 0.5) * length, 0.5 * length, DEPTH) for k in range(count)
    )


def _covered(
    flint: Any, residual: Callable[[Any, Any], Any], cell: Cells, middle: float, half: float, depth: int
) -> bool:
    # A hair more than half: together the parts cover the whole. Division by what may be zero is a ValueError there.
    with suppress(ValueError):
        if _slab(flint, residual, cell, middle, half * (1.0 + 1e-9)):
            return True
    part = half / RANGE_PARTS
    return depth > 0 and all(
        _covered(flint, residual, cell, middle + (2 * k + 1 - RANGE_PARTS) * part, part, depth - 1)
        for k in range(RANGE_PARTS)
    )


def _slab(flint: Any, residual: Callable[[Any, Any], Any], cell: Cells, middle: float, half: float) -> bool:
    arb, series = flint.arb, flint.arb_series
    m = cell.begin.shape[1]
    vectors = cell.begin, cell.end, cell.slope_begin, cell.slope_end, cell.chart, cell.radius
    u0, u1, d0, d1, c, r = ([arb(float(v)) for v in x[0]] for x in vectors)
    t, x = arb(middle), arb(0.0, half)
    q: list[list[Any]] = []
    for a, b, p, s in zip(u0, u1, d0, d1):
        a2, a3 = 3 * (b - a) - 2 * p - s, p + s - 2 * (b - a)
        q.append([a + t * (p + t * (a2 + t * a3)), p + t * (2 * a2 + 3 * t * a3), a2 + 3 * t * a3, a3])
    over = [
        (k[0] + x * (k[1] + x * (k[2] + x * k[3])), k[1] + x * (2 * k[2] + 3 * x * k[3]), k[2] + 3 * x * k[3])
        for k in q
    ]
    # Along the cubic: value and slope in the middle, half the second derivative all over.
    middle_image = _image(residual, [series(k[:3], 3) for k in q])
    slab_image = _image(residual, [series(list(k), 3) for k in over])
    powers = [a[0] for a in middle_image], [a[1] for a in middle_image], [b[2] for b in slab_image]
    box = [k[0] + arb(0.0, 1.0) * s for k, s in zip(over, r)]
    columns = [_image(residual, [series([b, 1 if i == j else 0], 2) for i, b in enumerate(box)]) for j in range(m)]
    G = [[columns[j][i][1] for j in range(m)] for i in range(m - 1)] + [c]
    with np.errstate(all="ignore"):
        try:
            Y: Array = np.linalg.inv(np.array([[float(g.mid()) for g in row] for row in G]))
        except np.linalg.LinAlgError:
            return False
    if not np.isfinite(Y).all():
        return False
    speed = sum((ci * k[1] for ci, k in zip(c, over)), arb(0))
    if not speed > 0:
        return False
    rows = [[arb(float(v)) for v in row] for row in Y]
    for i, row in enumerate(rows):
        at, along, bend = (sum((y * h for y, h in zip(row, power)), arb(0)) for power in powers)
        total = (at + x * along + x * x * bend).abs_upper()
        for j in range(m):
            entry = sum((row[k] * G[k][j] for k in range(m)), arb(0)) - (1 if i == j else 0)
            total = total + entry.abs_upper() * r[j]
        if not total < r[i]:
            return False
    return True


class Balls(np.ndarray[Any, Any]):
    """An array of series; numpy counts no objects."""

    def __array_function__(self, function: Any, types: Any, args: Any, kwargs: Any) -> Any:
        """As numpy's, but for `bincount`."""
        if function is not np.bincount:
            return super().__array_function__(function, types, args, kwargs)
        index, values, size = args
        out = np.zeros(size, dtype=object).view(Balls)
        for k, value in zip(index.tolist(), values):
            out[k] = out[k] + value
        return out


def _image(residual: Callable[[Any, Any], Any], u: list[Any]) -> list[Any]:
    """H of series, as series; a constant of it as numbers."""
    y = np.empty(len(u) - 1, dtype=object).view(Balls)
    for k, value in enumerate(u[:-1]):
        y[k] = Series(value)
    image = residual(y, Series(u[-1]))
    return [h.value if isinstance(h, Series) else type(u[0])([float(h)], 3) for h in np.asarray(image, dtype=object)]
