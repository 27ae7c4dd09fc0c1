"""Links between tubes at their nodes.

At a node u Krawczyk's test on a box of length zero proves a point z of the left curve, |z - u| <= r_t. If the right
tube holds z and the tangent advances in both charts, one curve continues the other.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import EPS, Array, Mask
from continuation.certificate.cells import OVERHANG, Cells, Index, Slabs, along, at_node
from continuation.certificate.engine import Engine, Judged, together, up_by
from continuation.numbers.ends import Ends

RADII = 12
"""Radii tried with one test's bounds."""

INFLATION = 1.1
"""Factor from image to next radii: it lets them pass the fixed point from below."""

NODE_ULPS = 32.0
"""Least box, and least radius of a tube, in ulps: round-off must not fill it."""


@frozen(eq=False)
class Nodes:
    """Points of the curve near ends of cells: |z - u| <= `radius`, shape (cells, N + 1), or nan; `tangent` has c . t =
    1.
    """

    radius: Array
    tangent: Ends

    @property
    def proved(self) -> Mask:
        """Whether a point is proved, by cell."""
        return np.asarray(np.isfinite(self.radius).all(axis=1))

    def take(self, index: Any) -> Nodes:
        """Select cells."""
        return Nodes(self.radius[index], self.tangent[index])

    @classmethod
    def joined(cls, parts: list[Nodes]) -> Nodes:
        """Concatenate."""
        radius, lo, hi = (
            np.concatenate(rows) for rows in zip(*((part.radius, part.tangent.lo, part.tangent.hi) for part in parts))
        )
        return cls(radius, Ends(lo, hi))


def nodes(engine: Engine, cells: Cells, s: Array, half: float = 0.0) -> Nodes:
    """Points of the curve near an end of each cell, or the curve within `half` of s, shape (cells,)."""
    parts = together(cells)
    return Nodes.joined([_nodes(engine, cells.take(place), s[place], half) for place in parts])


def _nodes(engine: Engine, cells: Cells, s: Array, half: float) -> Nodes:
    slabs = evolve(at_node(cells, s), half=np.full(len(s), half))
    u = np.where((s == 0.0)[:, None], cells.begin, cells.end)
    least = NODE_ULPS * EPS * (np.abs(u) + cells.radius)
    judged = engine.judge(slabs, cells.radius)
    radius, _, done = settled(judged, slabs.owner, least, cells.radius)
    done &= (radius <= cells.radius).all(axis=1)
    return Nodes(np.where(done[:, None], radius, np.nan), judged.tangent(radius, radius))


def settled(judged: Judged, owner: Index, least: Array, bounded: Array) -> tuple[Array, Array, Mask]:
    """For each cell: radii slightly above the test's image, the contraction bound, whether the test holds.

    `least`, `bounded`: smallest radii, largest with valid bounds.
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
    """Largest value by cell, or nan."""
    if len(values) == count:
        return values
    out = np.zeros((count, values.shape[1]))
    np.maximum.at(out, owner, values)
    return out


def reach(cells: Cells, s: Array, off: Ends) -> Array:
    """Radius with which a tube holds points at s in [0, 1], `off` the cubic; nan beyond the tube."""
    count = len(cells)
    speed = Slabs(np.arange(count), s, np.full(count, 0.9 * OVERHANG), cells).velocity
    with np.errstate(all="ignore"):
        least, (lo, hi) = along(cells.chart, speed)[0], along(cells.chart, off)
        away = np.where(least > 0.0, np.maximum(np.abs(lo), np.abs(hi)) / least, np.nan) * (1.0 + 4.0 * EPS)
        wide = up_by(off.magnitude() + away[:, None] * speed.magnitude(), 2)
    return np.where((away <= 0.9 * OVERHANG)[:, None], wide, np.nan)


def linked(left: Cells, at: Nodes, right: Cells) -> Mask:
    """Whether the left curves, with nodes `at` their ends, continue in the right cells."""
    with np.errstate(all="ignore"):
        same = (left.end == right.begin).all(axis=1)
        inside = (at.radius <= left.radius).all(axis=1)
        held = (reach(right, np.zeros(len(right)), Ends(-at.radius, at.radius)) <= right.radius).all(axis=1)
        onward, _ = along(right.chart, at.tangent)
        return np.asarray(same & inside & held & (onward > 0.0))
