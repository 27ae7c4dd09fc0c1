"""The switches along a proved arc: on it all keep their signs, and those that vanish at its ends do so once."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Cells, Index, Slabs, at_node
from continuation.certificate.engine import Engine, Judged
from continuation.certificate.folds import Piece, scanned, signs, turns
from continuation.certificate.krawczyk import ByIntervals
from continuation.certificate.links import nodes
from continuation.numbers.boxes import derivatives, with_gradient
from continuation.numbers.ends import Ends, bilinear

ARC_PARTS = 4
"""Parts of an arc at least: a switch that vanishes at both ends has its sign in between."""


def signs_along(engine: Engine, switches: ByIntervals, cells: Cells) -> list[list[Piece]]:
    """Of each switch, pieces of the cells in order, with its sign there or that of its derivative along the curve.

    The curve lies in the tubes, where the range of a switch is bounded; where that has no sign, its derivative along
    the curve is, gradient times tangent.

    Parameters
    ----------
    engine : Engine
    switches : ByIntervals
        The switching functions.
    cells : Cells
        Proved ones.
    """

    def look(judged: Judged, slabs: Slabs, radius: Array) -> tuple[Index, Index]:
        box, t = slabs.box(radius), judged.tangent(radius, slabs.cells.radius)
        image = switches.image(with_gradient(box.lo, box.hi))
        sign = signs(image.c[0])
        with np.errstate(all="ignore"):
            gradient = Ends(*derivatives(image, radius.shape[1]))
            slope = bilinear(np.matmul, gradient, Ends(t.lo[..., None], t.hi[..., None]))
        return sign, np.where(sign == 0, signs(slope[..., 0]), 0)

    many = -(-ARC_PARTS // int(cells.slabs.sum()))
    found = scanned(engine, cells.with_tubes(cells.radius, cells.slabs * many), look)
    return [[first, *one, last] for one, (first, last) in zip(found, _at_ends(engine, switches, cells))]


def _at_ends(engine: Engine, switches: ByIntervals, cells: Cells) -> list[tuple[Piece, Piece]]:
    """Of each switch, its signs at the first and the last point of the arc."""
    s, sides = np.array([0.0, 1.0]), cells.take([0, -1])
    radius = nodes(engine, sides, s).radius
    radius = np.where((radius <= sides.radius).all(axis=1, keepdims=True), radius, np.nan)
    first, last = value_at(switches, at_node(sides, s), radius)
    return [
        (Piece(0, 0.0, 0.0, a, 0), Piece(len(cells) - 1, 1.0, 1.0, b, 0)) for a, b in zip(first.tolist(), last.tolist())
    ]


def judged(found: list[Piece], count: int, sign: int, at: tuple[bool, bool]) -> tuple[float, float] | str:
    """Where one switch begins and ends to have its sign surely, in cells; or why it is not proved to have it.

    Parameters
    ----------
    found : list of Piece
        Of that switch.
    count : int
        Of cells.
    sign : int
        What it should have on the arc.
    at : tuple of bool
        Whether it should vanish at the beginning, and at the end.
    """
    begin, *inner, end = found
    # What vanishes there is zero but for rounding.
    found = [*([] if at[0] or not begin.sign else [begin]), *inner, *([] if at[1] or not end.sign else [end])]
    understood, unknown = turns(found)
    first = [turn for turn in understood if turn.lo <= 0.0 <= turn.hi]
    last = [turn for turn in understood if turn.lo <= count <= turn.hi]
    lo, hi = max((t.hi for t in first), default=-np.inf), min((t.lo for t in last), default=np.inf)
    between = [piece.sign for piece in found if lo < piece.cell + 0.5 * (piece.lo + piece.hi) < hi]
    if unknown or not any(between):
        return "kinks could not be counted"
    if len(understood) > len(first) + len(last) or -sign in between or (bool(first), bool(last)) > at:
        return "a kink that the path does not list"
    if (bool(first), bool(last)) != at or any(len(some) > 1 for some in (first, last)):
        return "a kink is listed where there is none"
    return lo, hi


def value_at(switches: ByIntervals, slabs: Slabs, radius: Array) -> Index:
    """Signs of the switches within radii of the middles of slabs, shape (slabs, m); 0 where there is none."""
    box = slabs.cubic[:, 0] + Ends(-radius, radius)
    return signs(switches.image(with_gradient(box.lo, box.hi)).c[0])
