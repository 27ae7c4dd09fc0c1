"""Pieces of a path that are proved one by one: a cubic, a chart across it, and the radii of a tube around it."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from continuation.numbers.ends import EPS, Ends, bilinear, thin

Index = NDArray[np.intp]

OVERHANG = 1e-3
"""How far a tube goes beyond both ends of its cell, in lengths of it, so that neighbours overlap."""


@frozen(eq=False)
class Cells:
    """Pieces in order, each from the node where the one before ends; arrays of shape (cells, N + 1) but for two.

    Attributes
    ----------
    begin, end : ndarray
        The nodes: p(0) and p(1) of the Hermite cubic p.
    slope_begin, slope_end : ndarray
        p'(0) and p'(1).
    chart : ndarray
        The vector c: a point u belongs to the parameter s with c . (u - p(s)) = 0.
    radius : ndarray
        The tube: |u - p(s)| <= radius, component by component.
    slabs : ndarray of int, shape (cells,)
        Into how many parts of equal length the parameter is cut for the test.
    place : ndarray, shape (cells, 2)
        Arclengths of the path at either end.
    """

    begin: Array
    end: Array
    slope_begin: Array
    slope_end: Array
    chart: Array
    radius: Array
    slabs: Index
    place: Array

    def __len__(self) -> int:
        return len(self.begin)

    def take(self, index: Any) -> Cells:
        """Some of them.

        Parameters
        ----------
        index : ndarray
            Of numbers or truth values.
        """
        return Cells(*(getattr(self, name)[index] for name in NAMES))

    def with_tubes(self, radius: Array, slabs: Index) -> Cells:
        """The same with other radii and numbers of slabs."""
        return evolve(self, radius=radius, slabs=slabs)


NAMES = tuple(Cells.__annotations__)


def joined(parts: list[Cells]) -> Cells:
    """One after the other.

    Parameters
    ----------
    parts : list of Cells
    """
    return Cells(*(np.concatenate([getattr(part, name) for part in parts]) for name in NAMES))


def between(
    begin: Array, tangent_begin: Array, end: Array, tangent_end: Array, weights: Array, place: tuple[float, float]
) -> Cells:
    """The cell between two nodes with these tangents, across its chord in the metric; no tube yet.

    Parameters
    ----------
    begin, end : ndarray, shape (N + 1,)
    tangent_begin, tangent_end : ndarray, shape (N + 1,)
        Of any length.
    weights : ndarray, shape (N + 1,)
        The metric.
    place : tuple of float
        Arclengths.
    """
    chart = weights * (end - begin)
    chart = chart / (float(np.abs(chart).max()) or 1.0)
    along = float(chart @ (end - begin))
    slopes = []
    for tangent in (tangent_begin, tangent_end):
        rate = float(chart @ tangent)
        # A tangent that does not lead on serves no cubic: the chord does.
        slopes.append(tangent * (along / rate) if rate > 0.0 else end - begin)
    first, last = (slope[None] for slope in slopes)
    nothing, one = np.zeros_like(begin)[None], np.ones(1, dtype=np.intp)
    return Cells(begin[None], end[None], first, last, chart[None], nothing, one, np.array([place]))


def cell_sizes(cells: Cells, still: Array | None = None) -> Array:
    """How far a cell goes in each component; where that is little, a share of what its metric counts as much.

    Parameters
    ----------
    cells : Cells
    still : ndarray, optional
        Lengths in that metric of components that stand still, of which a cell does not know it.
    """
    far = np.maximum(np.abs(cells.end - cells.begin), np.maximum(np.abs(cells.slope_begin), np.abs(cells.slope_end)))
    with np.errstate(all="ignore"):
        # chart = weights * chord up to a factor: the square root of chord over chart is a length of that metric.
        unit = np.sqrt(np.abs(cells.end - cells.begin) / np.abs(cells.chart))
        if still is not None:
            unit = np.where(np.isfinite(unit), unit, still)
        length = np.sqrt(np.sum(np.abs(cells.chart * (cells.end - cells.begin)), axis=1, keepdims=True))
        alike = 1e-6 * length * unit
    alike = np.where(np.isfinite(alike), alike, 0.0)
    out: Array = np.maximum(far, alike)
    return out + 64.0 * EPS * np.maximum(np.abs(cells.begin), np.abs(cells.end)) + np.finfo(float).tiny


@frozen(eq=False, slots=False)
class Slabs:
    """Parts of cells: the parameter within `half` of `middle`; arrays of shape (slabs,) and of cells, one a slab.

    Attributes
    ----------
    owner : ndarray of int
        The cell of each.
    middle, half : ndarray
    cells : Cells
        That of each slab.
    """

    owner: Index
    middle: Array
    half: Array
    cells: Cells

    def __len__(self) -> int:
        return len(self.owner)

    def take(self, index: Any) -> Slabs:
        """Some of them."""
        return Slabs(self.owner[index], self.middle[index], self.half[index], self.cells.take(index))

    @property
    def offset(self) -> Array:
        """At least the distance of any parameter of the range from the middle, shape (slabs,)."""
        return np.where(self.half > 0.0, self.half * (1.0 + 8.0 * EPS) + 8.0 * EPS * (1.0 + np.abs(self.middle)), 0.0)

    @cached_property
    def cubic(self) -> Ends:
        """The cubics about the middles: p(middle + x) = sum_k q_k x^k, shape (slabs, 4, N + 1).

        In the distance from the nearer end a cubic is base + slope t + bend t^2 + last t^3: at a node it is the node,
        and round-off of the other one does not count.
        """
        cells, later = self.cells, self.middle[:, None] > 0.5
        sign, m = np.where(later, -1.0, 1.0), self.middle[:, None]
        t = thin(np.where(later, 1.0 - m, m))  # exact, as 1/2 < m <= 2 (Sterbenz)
        base, other = (thin(np.where(later, *ends)) for ends in ((cells.end, cells.begin), (cells.begin, cells.end)))
        slope = thin(sign * np.where(later, cells.slope_end, cells.slope_begin))
        chord = other - base
        last = slope + thin(sign * np.where(later, cells.slope_begin, cells.slope_end)) - chord - chord
        bend, by_last = chord - slope - last, t * last
        third = bend + by_last
        second = third + by_last + by_last
        parts = base + t * (slope + t * third), slope + t * (second + bend), second, last
        # From there on, whichever end is the nearer one.
        lo, hi = (np.stack([getattr(part, end) for part in parts], axis=1) for end in ("lo", "hi"))
        turned = later[:, :, None] & np.array([False, True, False, True])[:, None]
        return Ends(np.where(turned, -hi, lo), np.where(turned, -lo, hi))

    @cached_property
    def over(self) -> tuple[Ends, Ends, Ends]:
        """The ranges of p, p' and p''/2 over each slab, shape (slabs, N + 1)."""
        x = self.offset[:, None]
        return evaluated(self.cubic, Ends(-x, x))

    @property
    def velocity(self) -> Ends:
        """The range of p' alone."""
        return self.over[1]

    def box(self, radius: Array) -> Ends:
        """What is within `radius` of the cubics."""
        return self.over[0] + Ends(-radius, radius)

    def halved(self, parts: int) -> Slabs:
        """Each cut into so many."""
        steps = (2.0 * np.arange(parts) + 1.0) / parts - 1.0
        middle = (self.middle[:, None] + self.half[:, None] * steps).ravel()
        index = np.repeat(np.arange(len(self)), parts)
        # A little longer than a part: together they cover the whole, whatever rounding does.
        half = np.repeat(self.half / parts, parts) * (1.0 + 1e-9)
        return Slabs(self.owner[index], middle, half, self.cells.take(index))


def slabs_of(cells: Cells) -> Slabs:
    """All slabs of all cells, in order; those of one cell cover [-OVERHANG, 1 + OVERHANG].

    Parameters
    ----------
    cells : Cells
    """
    counts = cells.slabs.astype(np.intp)
    owner = np.repeat(np.arange(len(cells)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    length = (1.0 + 2.0 * OVERHANG) / counts[owner]
    middle = (number + 0.5) * length - OVERHANG
    return Slabs(owner, middle, 0.5 * length * (1.0 + 1e-9), cells.take(owner))


def at_node(cells: Cells, s: Array) -> Slabs:
    """Slabs of no length at one end of each cell.

    Parameters
    ----------
    cells : Cells
    s : ndarray, shape (cells,)
        0 or 1.
    """
    return Slabs(np.arange(len(cells)), s, np.zeros(len(cells)), cells)


def evaluated(cubic: Ends, x: Ends) -> tuple[Ends, Ends, Ends]:
    """p, p' and p''/2 of cubics, shape (slabs, 4, m), over offsets x of shape (slabs, 1)."""
    q0, q1, q2, q3 = (cubic[:, k] for k in range(4))
    by_last = x * q3
    second = q2 + by_last + by_last + by_last
    return q0 + x * (q1 + x * (q2 + by_last)), q1 + x * (q2 + second), second


def advance(slabs: Slabs) -> Array:
    """A lower bound of c . p'(s) over each slab, shape (slabs,)."""
    bound, _ = along(slabs.cells.chart, slabs.velocity)
    return bound


def along(chart: Array, v: Ends) -> tuple[Array, Array]:
    """The range of c . v, row by row."""
    product = bilinear(np.matmul, thin(chart[:, None, :]), Ends(v.lo[..., None], v.hi[..., None]))
    return product.lo[:, 0, 0], product.hi[:, 0, 0]
