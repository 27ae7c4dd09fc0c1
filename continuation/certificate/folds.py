"""The turning points of a proved path: where the parameter's component of the tangent has no sign, and how many."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.certificate.cells import OVERHANG, Cells, Index, Slabs, at_node, slabs_of
from continuation.certificate.engine import Engine, Judged, solution_range, together
from continuation.numbers.ends import EPS, Ends

SLAB_CUTS = 6
"""A slab without a sign is halved so often at most: two turning points within 3e-8 of the parameter, on a way of 1,
took five."""

AskSigns = Callable[[Judged, Slabs, Array], tuple[Index, Index]]
"""Signs of some numbers on slabs, and of their derivatives along the curve where they have none, shape (slabs, k)."""

NEAR_LISTED = (1e-3, 1e-2, 0.1)
"""Before and behind a listed turning point the sign is asked there, in lengths of the cell: it is off by its tolerance,
of 1e-6 of a step, of which a cell is 1/256 at least."""

RANGE = 0.25
"""Longer ranges with a turning point, in cells, do not say where it is: these are asked, and what comes is less."""


@frozen(eq=False)
class Piece:
    """A range of parameters of one cell, with what is known of the parameter's component of the tangent on it.

    Attributes
    ----------
    cell : int
    lo, hi : float
    sign : int
        Of that component; 0 where it has none.
    bend : int
        Sign of its derivative along the path; 0 where it is not known.
    """

    cell: int
    lo: float
    hi: float
    sign: int
    bend: int


@frozen(eq=False)
class Turn:
    """A range in which the path has exactly one turning point, in cells: number + parameter.

    At an end of the path it is not `certain`: the point may lie a little beyond. The derivative of the parameter's
    component of the tangent has the sign `bend` all over it.
    """

    lo: float
    hi: float
    certain: bool
    bend: int


def scanned(engine: Engine, cells: Cells, look: AskSigns) -> list[list[Piece]]:
    """Of each number pieces of all cells in order, cut until its sign, or that of its derivative, is known.

    Parameters
    ----------
    engine : Engine
    cells : Cells
        Proved ones.
    look : callable
    """
    found: list[list[Piece]] = []
    for place in together(engine, cells):
        slabs = slabs_of(cells.take(place))
        slabs, radius = evolve(slabs, owner=place[slabs.owner]), slabs.cells.radius
        for depth in range(SLAB_CUTS + 1):
            judged, radius = narrowed(engine, slabs, radius, min(depth, 1))
            sign, bend = look(judged, slabs, radius)
            clear = np.asarray(((sign != 0) | (bend != 0)).all(axis=1))
            keep = clear | (depth == SLAB_CUTS)
            rows = [_rows(slabs.take(keep), a[keep], b[keep]) for a, b in zip(sign.T, bend.T)]
            found = [old + new for old, new in zip(found, rows)] if found else rows
            if keep.all():
                break
            # The curve in a part lies where that in the whole does: radii that were found are kept.
            slabs, radius = slabs.take(~keep).halved(2), np.repeat(radius[~keep], 2, axis=0)
    return [sorted(one, key=_where) for one in found]


def pieces(engine: Engine, cells: Cells) -> list[Piece]:
    """Those of the parameter's component of the tangent.

    Parameters
    ----------
    engine, cells
        As in `scanned`.
    """
    if engine.exact:
        found = []
        for place in together(engine, cells):
            slabs = slabs_of(cells.take(place))
            slabs = evolve(slabs, owner=place[slabs.owner])
            found += told(engine.judge(slabs, slabs.cells.radius), slabs, slabs.cells.radius)
        return found

    def look(judged: Judged, slabs: Slabs, radius: Array) -> tuple[Index, Index]:
        sign = _sign(judged.tangent(radius, slabs.cells.radius))
        bend = _bends(engine, judged, slabs, radius, slabs.cells.radius, sign)
        return sign[:, None], bend[:, None]

    return scanned(engine, cells, look)[0]


def told(judged: Judged, slabs: Slabs, tube: Array) -> list[Piece]:
    """Pieces of the slabs' cells, from bounds that hold for all radii: of whole slabs, or of parts where they turn.

    Parameters
    ----------
    judged : Judged
    slabs : Slabs
        In the order of their cells.
    tube : ndarray, shape (slabs, N + 1)
        Radii with which the test holds.
    """
    pace = judged.pace(tube, tube)
    if pace is None:
        sign = _sign(judged.tangent(tube, tube))
        return _rows(slabs, sign, np.zeros_like(sign))
    slope, bend = (signs(one) for one in pace)
    same = np.asarray((slope != 0).all(axis=1) & (slope == slope[:, :1]).all(axis=1))
    parts = slabs.take(~same).halved(slope.shape[1])
    turned = np.where(slope == 0, bend, 0)
    whole = _rows(slabs.take(same), slope[same, 0], turned[same, 0])
    return sorted([*whole, *_rows(parts, slope[~same].ravel(), turned[~same].ravel())], key=_where)


def _where(piece: Piece) -> tuple[int, float]:
    return piece.cell, piece.lo


def _rows(slabs: Slabs, sign: Index, bend: Index) -> list[Piece]:
    rows = zip(*(x.tolist() for x in (slabs.owner, slabs.middle, slabs.half, sign, bend)))
    return [Piece(cell, middle - half, middle + half, a, b) for cell, middle, half, a, b in rows]


def _narrowed(judged: Judged, radius: Array) -> Array:
    """The curve lies in the image of its box, which on a part of a tube is smaller."""
    with np.errstate(all="ignore"):
        inner = (judged.misfit + judged.spread(radius, radius)) * (1.0 + 4.0 * EPS)
        return np.where(inner < radius, np.maximum(inner, 1e-9 * radius), radius)


def narrowed(engine: Engine, slabs: Slabs, radius: Array, times: int) -> tuple[Judged, Array]:
    """Radii of parts of tubes within which the curve lies, and what is known of them there.

    Each time those of a wide tube fall to a tenth.

    Parameters
    ----------
    engine : Engine
    slabs : Slabs
    radius : ndarray, shape (slabs, N + 1)
        Within which it lies.
    times : int
        How often radii are replaced by those of the image.
    """
    judged = engine.judge(slabs, radius)
    for _ in range(times):
        radius = _narrowed(judged, radius)
        judged = engine.judge(slabs, radius)
    return judged, radius


def _sign(t: Ends) -> Index:
    """That of the last component."""
    return signs(t[:, -1])


def signs(x: Ends) -> Index:
    """Of intervals; 0 where there is none."""
    return np.where(x.lo > 0.0, 1, np.where(x.hi < 0.0, -1, 0))


def _bends(engine: Engine, judged: Judged, slabs: Slabs, radius: Array, tube: Array, sign: Index) -> Index:
    """Signs of the derivative of the parameter's component of t, c . t = 1, along the path, where it has none itself.

    H' t = 0 gives H' t' = -H''(u', t), where u' is t times c . p' > 0: the sign is that of the last component of
    -G'^{-1} (H''(t, t), 0).
    """
    if sign.all():
        return np.zeros_like(sign)
    t, box = judged.tangent(radius, tube), slabs.box(radius)
    with np.errstate(all="ignore"):
        second = engine.bent(box, t)
        if second is None:  # no derivative has a sign
            return np.zeros_like(sign)
        lo, hi = (np.concatenate([half, np.zeros((len(slabs), 1))], axis=1) for half in (second.lo, second.hi))
        v = solution_range(judged, judged.applied(Ends(lo, hi)), radius, tube)
        bend = np.where(v.hi[:, -1] < 0.0, 1, np.where(v.lo[:, -1] > 0.0, -1, 0))
    return np.where(sign == 0, bend, 0)


def turns(found: list[Piece]) -> tuple[list[Turn], list[tuple[float, float]]]:
    """Turning points in order, and ranges in which they could not be counted.

    Pieces without a sign form runs. A run on which the derivative has one sign all along, between different signs, has
    exactly one turning point; between equal signs none is possible with it. Other runs are not understood.

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
    k = 0
    while k < len(found):
        if found[k].sign:
            k += 1
            continue
        begin = k
        while k < len(found) and not found[k].sign:
            k += 1
        run = found[begin:k]
        place = (run[0].cell + run[0].lo, run[-1].cell + run[-1].hi)
        before = found[begin - 1].sign if begin else 0
        after = found[k].sign if k < len(found) else 0
        bends = {piece.bend for piece in run}
        if len(bends) != 1 or 0 in bends:
            unknown.append(place)
        elif before != after:
            out.append(Turn(*place, certain=bool(before and after), bend=bends.pop()))
    return out, unknown


def located(engine: Engine, cells: Cells, found: list[Turn], places: list[float]) -> list[Turn]:
    """The same in shorter ranges, where turning points are said to be at these places.

    The component grows, or falls, all over a range: where it has the sign that it has before its zero, that lies
    behind. At points within a cell the order of parameters is that of the curve; next to nodes it need not be.

    Parameters
    ----------
    engine : Engine
    cells : Cells
    found : list of Turn
    places : list of float
        In cells.
    """
    asked = [
        (k, x)
        for k, turn in enumerate(found)
        for place in places
        if turn.hi - turn.lo > RANGE and turn.lo <= place <= turn.hi
        for near in NEAR_LISTED
        for x in (place - near, place + near)
        if turn.lo < x < turn.hi and abs(x - round(x)) > 2.0 * OVERHANG
    ]
    if not asked:
        return found
    x = np.array([place for _, place in asked])
    owner = np.clip(x.astype(np.intp), 0, len(cells) - 1)
    own = cells.take(owner)
    judged, radius = narrowed(engine, at_node(own, x - owner), own.radius, 2)
    sign = _sign(judged.tangent(radius, own.radius))
    out = list(found)
    for (k, place), told in zip(asked, sign.tolist()):
        turn = out[k]
        if told == -turn.bend:
            out[k] = evolve(turn, lo=max(turn.lo, place))
        elif told:
            out[k] = evolve(turn, hi=min(turn.hi, place))
    return out
