"""What joins tubes to one curve: at each node a point of it that is in the tubes on either side, passed in one way.

At the node that two cells share the test of Krawczyk on a box of no length proves a point z of the left curve with
|z - u| <= r_t. In the chart of the right cell z belongs to a parameter s' near 0; where p(s') + [-r, r] holds it, it is
the one zero that the right tube has there, and both curves pass through it. Where the tangent at z advances in both
charts, the one goes on where the other ends.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.certificate.cells import OVERHANG, Cells, Index, Slabs, along, at_node
from continuation.certificate.engine import Engine, Judged, together, up_by
from continuation.numbers.ends import EPS, Ends, Mask

RADII = 12
"""Radii that are tried with the bounds of one test."""

INFLATION = 1.1
"""How much wider than what the test gives the next radii are: a fixed point is approached from above."""

LEAST_BOX, FIRST_BOX = 1e-9, 1e-3
"""Of the radii of the tube: the least box around a node, and the one over which derivatives are bounded first."""

NODE_ULPS = 32.0
"""Units in the last place: the least box around a node."""


@frozen(eq=False)
class Nodes:
    """Points of the curve, proved near ends of cells.

    Attributes
    ----------
    radius : ndarray, shape (cells, N + 1)
        |z - u| <= radius; nan where nothing is proved.
    tangent : Ends
        That of the curve there, with c . t = 1.
    """

    radius: Array
    tangent: Ends

    @property
    def proved(self) -> Mask:
        """Whether there is a point, cell by cell."""
        return np.asarray(np.isfinite(self.radius).all(axis=1))

    def take(self, index: Any) -> Nodes:
        """Some of them."""
        return Nodes(self.radius[index], self.tangent[index])

    @classmethod
    def joined(cls, parts: list[Nodes]) -> Nodes:
        """One after the other."""
        radius, lo, hi = (
            np.concatenate(rows) for rows in zip(*((part.radius, part.tangent.lo, part.tangent.hi) for part in parts))
        )
        return cls(radius, Ends(lo, hi))


def nodes(engine: Engine, cells: Cells, s: Array, half: float = 0.0) -> Nodes:
    """A point of the curve at one end of each cell; or the curve on a range of parameters, |u - p(s)| <= radius.

    Parameters
    ----------
    engine : Engine
    cells : Cells
    s : ndarray, shape (cells,)
        0 or 1, or near these.
    half : float
        Half the length of the range.
    """
    parts = together(engine, cells)
    return Nodes.joined([_nodes(engine, cells.take(place), s[place], half) for place in parts])


def _nodes(engine: Engine, cells: Cells, s: Array, half: float) -> Nodes:
    slabs = evolve(at_node(cells, s), half=np.full(len(s), half))
    u = np.where((s == 0.0)[:, None], cells.begin, cells.end)
    least = NODE_ULPS * EPS * np.abs(u) + LEAST_BOX * cells.radius
    for bounded in (FIRST_BOX * cells.radius + 4.0 * least, cells.radius):
        judged = engine.judge(slabs, bounded)
        radius, _, done = settled(judged, slabs.owner, least, bounded)
        done &= (radius <= bounded).all(axis=1)
        if done.all():
            break
    return Nodes(np.where(done[:, None], radius, np.nan), judged.tangent(radius, radius))


def settled(judged: Judged, owner: Index, least: Array, bounded: Array) -> tuple[Array, Array, Mask]:
    """Radii a little above what the test gives back, the bound of the contraction, and whether it holds; a cell.

    Parameters
    ----------
    judged : Judged
    owner : ndarray of int, shape (slabs,)
        The cell of each slab.
    least, bounded : ndarray, shape (cells, N + 1)
        Radii to begin with, and those for which bounds are valid.
    """
    with np.errstate(all="ignore"):
        off = largest_by_cell(judged.misfit, owner, len(least))
        radius = np.minimum(np.maximum(2.0 * off, least), bounded)
        radius = np.where(np.isfinite(radius), radius, least)
        for _ in range(RADII):
            image = largest_by_cell(judged.spread(radius[owner], np.minimum(radius, bounded)[owner]), owner, len(least))
            kappa, total = (image / radius).max(axis=1), off + image
            inside = np.asarray((total * (1.0 + 8.0 * EPS) < radius).all(axis=1))
            if inside.all():
                break
            radius = np.where(inside[:, None], radius, np.maximum(INFLATION * total, least))
    return radius, kappa, inside


def largest_by_cell(values: Array, owner: Index, count: int) -> Array:
    """The largest of each cell's slabs, of which it has one at least; nan where one is."""
    if len(values) == count:
        return values
    out = np.zeros((count, values.shape[1]))
    np.maximum.at(out, owner, values)
    return out


def reach(cells: Cells, s: Array, off: Ends) -> Array:
    """How wide a tube has to be at a parameter to hold what is `off` the cubic there; nan where the tube ends before.

    Parameters
    ----------
    cells : Cells
    s : ndarray, shape (cells,)
        From 0 to 1.
    off : Ends, shape (cells, N + 1)
    """
    count = len(cells)
    speed = Slabs(np.arange(count), s, np.full(count, 0.9 * OVERHANG), cells).velocity
    with np.errstate(all="ignore"):
        least, (lo, hi) = along(cells.chart, speed)[0], along(cells.chart, off)
        away = np.where(least > 0.0, np.maximum(np.abs(lo), np.abs(hi)) / least, np.nan) * (1.0 + 4.0 * EPS)
        wide = up_by(off.magnitude() + away[:, None] * speed.magnitude(), 2)
    return np.where((away <= 0.9 * OVERHANG)[:, None], wide, np.nan)


def linked(left: Cells, at: Nodes, right: Cells) -> Mask:
    """Whether the curves of the left cells go on in the right ones.

    Parameters
    ----------
    left, right : Cells
    at : Nodes
        Of the left cells, at their ends.

    Returns
    -------
    ndarray of bool
    """
    with np.errstate(all="ignore"):
        same = (left.end == right.begin).all(axis=1)
        inside = (at.radius <= left.radius).all(axis=1)
        held = (reach(right, np.zeros(len(right)), Ends(-at.radius, at.radius)) <= right.radius).all(axis=1)
        onward, _ = along(right.chart, at.tangent)
        return np.asarray(same & inside & held & (onward > 0.0))
