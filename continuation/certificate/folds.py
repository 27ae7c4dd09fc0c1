"""Where numbers vanish along a proved curve: by their signs on pieces of it, and those of their derivatives."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.certificate.cells import OVERHANG, Cells, Index, Slabs, at_node
from continuation.certificate.engine import Engine, Judged
from continuation.numbers.ends import EPS, Ends

RANGE = 0.25
"""Longer ranges with a turning point, in cells, do not say where it is."""

SIGN_PLACES = 32
"""At so many places in a range with a turning point the sign is asked, twice: a thousandth of it is left."""

Look = Callable[[Judged, Slabs, Array], list[tuple[Index, Index]]]
"""Signs of numbers on equal parts of slabs, and of their derivatives along the curve, which lies within a radius of the
cubic; of each number, shape (slabs, parts)."""


@frozen(eq=False)
class Piece:
    """A range of parameters of a cell, or in cells (number + parameter), with what is known of a number on it.

    Attributes
    ----------
    lo, hi : float
    sign : int
        Of that number; 0 where it has none.
    bend : int
        Sign of its derivative along the path; 0 where it is not known, or not asked.
    """

    lo: float
    hi: float
    sign: int
    bend: int


@frozen(eq=False)
class Turn:
    """A range in which a number has exactly one zero, in cells.

    At an end of the path it is not `certain`: the zero may lie a little beyond. The derivative of the number has the
    sign `bend` all over it.
    """

    lo: float
    hi: float
    certain: bool
    bend: int


def signs(x: Ends) -> Index:
    """Of intervals; 0 where there is none."""
    return np.where(x.lo > 0.0, 1, np.where(x.hi < 0.0, -1, 0))


def turning(judged: Judged, slabs: Slabs, radius: Array) -> list[tuple[Index, Index]]:
    """The look at the rate of the parameter along the curve, whose zeros are turning points."""
    slope, bend = judged.pace(radius, radius)
    return [(signs(slope), signs(bend))]


def pieces(look: Look, judged: Judged, slabs: Slabs, radius: Array, count: int) -> list[list[list[Piece]]]:
    """Those of so many cells, of each number, in order: one of a slab where the sign is one, else of each part.

    Parameters
    ----------
    look : callable
    judged : Judged
    slabs : Slabs
    radius : ndarray, shape (slabs, N + 1)
    count : int
    """
    numbers = look(judged, slabs, radius)
    out: list[list[list[Piece]]] = [[[] for _ in numbers] for _ in range(count)]
    for j, (sign, bend) in enumerate(numbers):
        same = (sign != 0).all(axis=1) & (sign == sign[:, :1]).all(axis=1)
        parts = slabs.take(~same).halved(sign.shape[1])
        for some, a, b in ((slabs.take(same), sign[same, 0], bend[same, 0]), (parts, sign[~same], bend[~same])):
            rows = some.owner, some.middle - some.half, some.middle + some.half, a.ravel(), b.ravel()
            for owner, *row in zip(*(x.tolist() for x in rows)):
                out[owner][j].append(Piece(*row))
    return [[sorted(part, key=lambda piece: piece.lo) for part in parts] for parts in out]


def turns(found: list[Piece]) -> tuple[list[Turn], list[tuple[float, float]]]:
    """Zeros in order, and ranges in which they could not be counted.

    Pieces without a sign form runs. A run on which the derivative has one sign all along, between different signs, has
    exactly one zero; between equal signs none is possible with it. Other runs are not understood.

    Parameters
    ----------
    found : list of Piece

    Returns
    -------
    turns : list of Turn
    unknown : list of tuple of float
    """
    out: list[Turn] = []
    unknown: list[tuple[float, float]] = []
    run: list[Piece] = []
    before = 0
    for piece in [*found, None]:
        if piece is not None and not piece.sign:
            run.append(piece)
            continue
        after = piece.sign if piece is not None else 0
        if run:
            place, bends = (run[0].lo, run[-1].hi), {one.bend for one in run}
            if len(bends) != 1 or 0 in bends:
                unknown.append(place)
            elif before != after:
                out.append(Turn(*place, certain=bool(before and after), bend=bends.pop()))
        run, before = [], after
    return out, unknown


def located(engine: Engine, cells: Cells, found: list[Turn]) -> list[Turn]:
    """The same in shorter ranges, of those that are longer than `RANGE`.

    The number grows, or falls, all over a range: where it has the sign that it has before its zero, that lies behind.
    At points within a cell the order of parameters is that of the curve; next to nodes it need not be.

    Parameters
    ----------
    engine : Engine
    cells : Cells
    found : list of Turn
        Of the parameter's rate.
    """
    found = list(found)
    wide = [k for k, turn in enumerate(found) if turn.hi - turn.lo > RANGE]
    for _ in range(2 if wide else 0):
        x = np.concatenate([np.linspace(found[k].lo, found[k].hi, SIGN_PLACES + 2)[1:-1] for k in wide])
        x = x[(np.abs(x - np.round(x)) > 2.0 * OVERHANG) & (x > 0.0) & (x < len(cells))]
        own = cells.take(x.astype(np.intp))
        slabs = at_node(own, x % 1.0)
        judged = engine.judge(slabs, own.radius)
        # The curve lies in the image of its box.
        radius = np.minimum((judged.misfit + judged.spread(own.radius, own.radius)) * (1.0 + 4.0 * EPS), own.radius)
        known = signs(engine.judge(slabs, radius).tangent(radius, radius)[:, -1])
        for k in wide:
            turn = found[k]
            inside = (turn.lo < x) & (x < turn.hi)
            lo, hi = x[inside & (known == -turn.bend)], x[inside & (known == turn.bend)]
            found[k] = evolve(turn, lo=max([turn.lo, *lo]), hi=min([turn.hi, *hi]))
    return found
