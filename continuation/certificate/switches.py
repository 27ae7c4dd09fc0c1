"""The switches along a proved arc: on it all keep their signs, and those that vanish at its ends do so once."""

from __future__ import annotations

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Cells, Slabs, at_node, slabs_of
from continuation.certificate.engine import Engine
from continuation.certificate.folds import Piece, narrowed, turns
from continuation.certificate.krawczyk import ByIntervals
from continuation.certificate.links import nodes
from continuation.numbers.boxes import derivatives, with_gradient
from continuation.numbers.ends import Ends, bilinear

ARC_PARTS = 4
"""Parts of an arc of few slabs: a switch that vanishes at both ends has its sign in between."""

SLAB_HALVINGS = 5
"""A slab on which neither a switch nor its derivative along the curve has a sign is halved so often at most."""


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
    slabs = slabs_of(cells)
    if len(slabs) < ARC_PARTS:
        slabs = slabs.halved(ARC_PARTS)
    radius = slabs.cells.radius
    found: list[list[Piece]] = []
    for depth in range(SLAB_HALVINGS + 1):
        m = radius.shape[1]
        known, radius = narrowed(engine, slabs, radius)
        box = slabs.box(radius)
        image = switches.image(with_gradient(box.lo, box.hi))
        sign = _signs(image.c[0])
        t = known.tangent(radius, slabs.cells.radius)
        with np.errstate(all="ignore"):
            slope = bilinear(np.matmul, Ends(*derivatives(image, m)), Ends(t.lo[..., None], t.hi[..., None]))
        bend = np.where(sign == 0, _signs(Ends(slope.lo[..., 0], slope.hi[..., 0])), 0)
        keep = ((sign != 0) | (bend != 0)).all(axis=1) | (depth == SLAB_HALVINGS)
        found = found or [[] for _ in range(sign.shape[1])]
        for k in np.flatnonzero(keep).tolist():
            cell, lo, hi = int(slabs.owner[k]), slabs.middle[k] - slabs.half[k], slabs.middle[k] + slabs.half[k]
            for one, a, b in zip(found, sign[k].tolist(), bend[k].tolist()):
                one.append(Piece(cell, float(lo), float(hi), a, b))
        if keep.all():
            break
        slabs, radius = slabs.take(~keep).halved(2), np.repeat(radius[~keep], 2, axis=0)
    at_ends = _at_ends(engine, switches, cells)
    ordered = [sorted(one, key=lambda piece: (piece.cell, piece.lo)) for one in found]
    return [[first, *one, last] for one, (first, last) in zip(ordered, at_ends)]


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


def value_at(switches: ByIntervals, slabs: Slabs, radius: Array) -> Array:
    """Signs of the switches within radii of the middles of slabs, shape (slabs, m); 0 where there is none."""
    box = slabs.cubic[:, 0] + Ends(-radius, radius)
    return _signs(switches.image(with_gradient(box.lo, box.hi)).c[0])


def _signs(value: Ends) -> Array:
    return np.where(value.lo > 0.0, 1, np.where(value.hi < 0.0, -1, 0))
