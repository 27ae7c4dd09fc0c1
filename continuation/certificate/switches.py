"""The kinks of a proved path: on each piece all switches keep their signs, and one that changes does so once."""

from __future__ import annotations

import numpy as np

from continuation.certificate.cells import Cells, expansion, slabs_of
from continuation.certificate.engine import Engine
from continuation.certificate.folds import Piece, Turn, turns
from continuation.certificate.krawczyk import ByIntervals
from continuation.intervals.calculus import derivatives, with_gradient
from continuation.intervals.ends import Ends, bilinear

DEPTH = 5
"""A slab on which neither a switch nor its derivative along the curve has a sign is halved so often at most."""


def crossings(engine: Engine, switches: ByIntervals, cells: Cells) -> tuple[list[Turn], list[tuple[float, float]]]:
    """Ranges with exactly one zero of one switch, and those in which zeros could not be counted.

    The curve lies in the tubes, where the range of a switch is bounded; where that has no sign, its derivative along
    the curve is, gradient times tangent. At a kink the tangent is bounded by the generalized Jacobian, so that a switch
    is monotone along a curve that is Lipschitz alone.

    Parameters
    ----------
    engine : Engine
    switches : ByIntervals
        The switching functions.
    cells : Cells
        Proved ones.
    """
    slabs = slabs_of(cells)
    radius = slabs.cells.radius
    found: list[list[Piece]] = []
    for depth in range(DEPTH + 1):
        x, m = slabs.offset[:, None], radius.shape[1]
        box = expansion(slabs).over(Ends(-x, x))[0] + Ends(-radius, radius)
        image = switches.image(with_gradient(box.lo, box.hi))
        value = image.ends[0]
        sign = np.where(value.lo > 0.0, 1, np.where(value.hi < 0.0, -1, 0))
        t = engine.judge(slabs, radius).tangent(radius, radius)
        with np.errstate(all="ignore"):
            slope = bilinear(np.matmul, Ends(*derivatives(image, m)), Ends(t.lo[..., None], t.hi[..., None]))
        bend = np.where(slope.lo[..., 0] > 0.0, 1, np.where(slope.hi[..., 0] < 0.0, -1, 0))
        bend = np.where(sign == 0, bend, 0)
        keep = ((sign != 0) | (bend != 0)).all(axis=1) | (depth == DEPTH)
        found = found or [[] for _ in range(sign.shape[1])]
        for k in np.flatnonzero(keep).tolist():
            cell, lo, hi = int(slabs.owner[k]), slabs.middle[k] - slabs.half[k], slabs.middle[k] + slabs.half[k]
            for one, a, b in zip(found, sign[k].tolist(), bend[k].tolist()):
                one.append(Piece(cell, float(lo), float(hi), a, b))
        if keep.all():
            break
        slabs, radius = slabs.take(~keep).halved(2), np.repeat(radius[~keep], 2, axis=0)
    told = [turns(sorted(one, key=lambda piece: (piece.cell, piece.lo))) for one in found]
    return [turn for understood, _ in told for turn in understood], [place for _, more in told for place in more]
