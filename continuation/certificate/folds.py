"""Zeros of numbers along a proved curve, from signs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import EPS, Array
from continuation.certificate.cells import OVERHANG, Cells, Index, Slabs, at_node
from continuation.certificate.engine import Engine, Judged
from continuation.numbers.ends import Ends

RANGE = 0.25
"""Largest range, in cells, that locates a turning point."""

SIGN_PLACES = 32
"""Places in a range at which the sign is tried, twice: a thousandth of the range is left."""

SignsAlong = Callable[[Judged, Slabs, Array], list[tuple[Index, Index]]]
"""Signs of observed numbers and of their derivatives along curves within a radius of the cubic, on equal parts of
slabs: shape (slabs, parts)."""


@frozen(eq=False)
class Piece:
    """A parameter range, in a cell or in cells (index + parameter).

    `sign`: of a number; `bend`: of its derivative; 0 if unknown.
    """

    lo: float
    hi: float
    sign: int
    bend: int


@frozen(eq=False)
class Turn:
    """A range, in cells, with exactly one zero, where the derivative has the sign `bend`; not `certain` if the zero may
    lie beyond the path's end.
    """

    lo: float
    hi: float
    certain: bool
    bend: int


def signs(x: Ends) -> Index:
    """Signs of intervals; 0 if undecided."""
    return np.where(x.lo > 0.0, 1, np.where(x.hi < 0.0, -1, 0))


def turning(judged: Judged, slabs: Slabs, radius: Array) -> list[tuple[Index, Index]]:
    """Observe the parameter's rate, zero at turning points."""
    slope, bend = judged.pace(radius, radius)
    return [(signs(slope), signs(bend))]


def pieces(look: SignsAlong, judged: Judged, slabs: Slabs, radius: Array, count: int) -> list[list[list[Piece]]]:
    """Pieces of `count` cells for each number: a slab if it has one sign, else its parts."""
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
    """Zeros in order, and ranges with an unknown number of zeros.

    A run of pieces without sign holds exactly one zero if its derivative has one sign and the signs around it differ.
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
    """Shorten turning points' ranges above `RANGE` by signs of the monotone number."""
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
