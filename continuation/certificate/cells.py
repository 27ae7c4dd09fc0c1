"""Pieces of a path that are proved one by one: a cubic, a chart across it, and the radii of a tube around it."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from continuation.arrays import Array
from continuation.numbers.ends import EPS, TINIEST, Ends, bilinear, thin, up_sum

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


def sizes(cells: Cells, still: Array | None = None) -> Array:
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
    def expansion(self) -> Expansion:
        """The cubics about the middles."""
        return expansion(self)

    @cached_property
    def velocity(self) -> Ends:
        """The range of p' over each slab, shape (slabs, N + 1)."""
        return self.expansion.rate(self.offset[:, None])

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


@frozen(eq=False, slots=False)
class Expansion:
    """The cubic about the middle of a slab: p(middle + x) = sum_k q_k x^k, exactly, as intervals that hold q_k.

    Attributes
    ----------
    coefficients : Ends, shape (slabs, 4, N + 1)
    """

    coefficients: Ends

    @cached_property
    def q(self) -> tuple[Ends, ...]:
        """The coefficients one by one."""
        return tuple(self.coefficients[:, k] for k in range(4))

    @property
    def last(self) -> Expansion:
        """Of the last component, the parameter, shape (slabs, 1)."""
        return Expansion(self.coefficients[:, :, -1:])

    def over(self, x: Ends) -> tuple[Ends, Ends, Ends]:
        """p, p' and p''/2 over offsets x of shape (slabs, 1)."""
        q0, q1, q2, q3 = self.q
        two, three = thin(np.full((1, 1), 2.0)), thin(np.full((1, 1), 3.0))
        value = q0 + x * (q1 + x * (q2 + x * q3))
        first = q1 + x * (two * q2 + three * x * q3)
        return value, first, q2 + three * x * q3

    def rate(self, x: Array) -> Ends:
        """The range of p' over offsets of at most x >= 0, of shape (slabs, 1): as `over`, with sizes alone."""
        size = self.coefficients[:, 2:].magnitude()
        # Five roundings of numbers >= 0, half an EPS each; and products that underflow, unless all is zero.
        room = x * (2.0 * size[:, 0] + 3.0 * x * size[:, 1]) * (1.0 + 4.0 * EPS) + (size[:, 0] > 0.0) * 16.0 * TINIEST
        return self.coefficients[:, 1] + Ends(-room, room)


def expansion(slabs: Slabs) -> Expansion:
    """The cubics of slabs about their middles, by middle and radius.

    Parameters
    ----------
    slabs : Slabs
        With middles of at most 2.
    """
    cells, m = slabs.cells, slabs.middle[:, None]
    # From the nearer end, where the cubic is that node, and round-off of the other one does not count.
    later = m > 0.5
    t = np.where(later, m - 1.0, m)  # exact, as 1/2 < m <= 2 (Sterbenz)
    base, slope = np.where(later, cells.end, cells.begin), np.where(later, cells.slope_end, cells.slope_begin)
    other, chord = np.where(later, cells.slope_begin, cells.slope_end), cells.end - cells.begin
    bend = (3.0 * chord - 2.0 * slope - other) * np.where(later, -1.0, 1.0)
    last = slope + other - 2.0 * chord
    by_last = t * last
    inner = slope + t * (bend + by_last)
    middle = np.stack([base + t * inner, slope + t * (2.0 * bend + 3.0 * by_last), bend + 3.0 * by_last, last], axis=1)
    # None of these, but for the last sum and product of the first, is of terms with more than eight roundings each:
    # they are off by gamma_8 < 8.1 / 2 EPS times the same of sizes (Higham, Section 3.1), of which there are twice as
    # many, for the rounding of these sizes.
    size_t, first, second = np.abs(t), np.abs(slope), np.abs(other)
    third = first + second + 2.0 * np.abs(chord)
    second = third + first + np.abs(chord)
    third_by = size_t * third
    size = first + size_t * (second + third_by)
    room = np.empty_like(middle)
    room[:, 0] = size_t * size
    room[:, 1] = first + size_t * (2.0 * second + 3.0 * third_by)
    room[:, 2] = second + 3.0 * third_by
    room[:, 3] = third
    room *= 8.0 * EPS
    room[:, 0] += EPS * (size_t * np.abs(inner) + np.abs(middle[:, 0]))
    # Where all is zero nothing underflows; elsewhere a few products may, each by half of the tiniest number.
    room += ((second > 0.0) * (32.0 * TINIEST))[:, None]
    return Expansion(Ends(-up_sum(room - middle), up_sum(middle + room)))


def advance(slabs: Slabs) -> Array:
    """A lower bound of c . p'(s) over each slab, shape (slabs,)."""
    bound, _ = along(slabs.cells.chart, slabs.velocity)
    return bound


def along(chart: Array, v: Ends) -> tuple[Array, Array]:
    """The range of c . v, row by row."""
    product = bilinear(np.matmul, thin(chart[:, None, :]), Ends(v.lo[..., None], v.hi[..., None]))
    return product.lo[:, 0, 0], product.hi[:, 0, 0]
