"""Cells of a proof."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from attrs import evolve, frozen
from numpy.typing import NDArray

from continuation.arrays import EPS, Array
from continuation.numbers.ends import Ends, bilinear, thin

Index = NDArray[np.intp]

OVERHANG = 1e-3
"""Overlap of a tube with its neighbours, relative to its length."""

SLAB_PARTS = 4
"""Parts of a slab for H on the cubic, whose remainder is of third order, and for signs of what may vanish inside; twice
as many for the parameter's rate, else two turning points 1e-10 apart look like one. With eight for H proofs take a
third longer."""


@frozen(eq=False)
class Cells:
    """Consecutive pieces of a path; arrays of shape (cells, N + 1) unless stated.

    `begin`, `end`: nodes p(0), p(1) of the Hermite cubic p. `slope_begin`, `slope_end`: p'(0), p'(1). `chart`: the
    vector c; u has the parameter s with c . (u - p(s)) = 0. `radius`: the tube is |u - p(s)| <= radius by component.
    `slabs`, shape (cells,): number of equal parts in the test. `place`, shape (cells, 2): arclengths of the ends.
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
        """Select cells."""
        return Cells(*(getattr(self, name)[index] for name in COLUMNS))

    def with_tubes(self, radius: Array, slabs: Index) -> Cells:
        """Replace radii and slabs."""
        return evolve(self, radius=radius, slabs=slabs)


COLUMNS = tuple(Cells.__annotations__)


def joined(parts: list[Cells]) -> Cells:
    """Concatenate."""
    return Cells(*(np.concatenate([getattr(part, name) for part in parts]) for name in COLUMNS))


def cell_between(
    begin: Array, tangent_begin: Array, end: Array, tangent_end: Array, weights: Array, place: tuple[float, float]
) -> Cells:
    """The cell between two nodes, without a tube; its chart is orthogonal to the chord in the metric.

    `place`: arclengths.
    """
    chart = weights * (end - begin)
    chart = chart / (float(np.abs(chart).max()) or 1.0)
    along = float(chart @ (end - begin))
    slopes = []
    for tangent in (tangent_begin, tangent_end):
        rate = float(chart @ tangent)
        # A tangent that does not advance is replaced by the chord.
        slopes.append(tangent * (along / rate) if rate > 0.0 else end - begin)
    first, last = (slope[None] for slope in slopes)
    nothing, one = np.zeros_like(begin)[None], np.ones(1, dtype=np.intp)
    return Cells(begin[None], end[None], first, last, chart[None], nothing, one, np.array([place]))


def cell_sizes(cells: Cells, still: Array | None = None) -> Array:
    """Extent by component, at least 1e-6 of the chord; `still`: unit lengths of components that stand still."""
    far = np.maximum(np.abs(cells.end - cells.begin), np.maximum(np.abs(cells.slope_begin), np.abs(cells.slope_end)))
    with np.errstate(all="ignore"):
        # The chart is weights * chord up to a factor, so sqrt(chord / chart) is a unit length.
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
    """Parameter ranges within `half` of `middle`, by cell."""

    owner: Index
    middle: Array
    half: Array
    cells: Cells

    def __len__(self) -> int:
        return len(self.owner)

    def take(self, index: Any) -> Slabs:
        """Select slabs."""
        return Slabs(self.owner[index], self.middle[index], self.half[index], self.cells.take(index))

    @property
    def offset(self) -> Array:
        """Upper bound of |s - middle|, shape (slabs,)."""
        return np.where(self.half > 0.0, self.half * (1.0 + 8.0 * EPS) + 8.0 * EPS * (1.0 + np.abs(self.middle)), 0.0)

    @cached_property
    def cubic(self) -> Ends:
        """Coefficients q of p(middle + x) = sum_k q_k x^k, shape (slabs, 4, N + 1).

        They are computed from the nearer node, where the other adds no round-off.
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
        lo, hi = (np.stack([getattr(part, end) for part in parts], axis=1) for end in ("lo", "hi"))
        turned = later[:, :, None] & np.array([False, True, False, True])[:, None]
        return Ends(np.where(turned, -hi, lo), np.where(turned, -lo, hi))

    @cached_property
    def over(self) -> tuple[Ends, Ends, Ends]:
        """Ranges of p, p' and p''/2, shape (slabs, N + 1)."""
        x = self.offset[:, None]
        return evaluated(self.cubic, Ends(-x, x))

    @property
    def velocity(self) -> Ends:
        """Range of p'."""
        return self.over[1]

    def box(self, radius: Array) -> Ends:
        """Boxes within `radius` of the cubics."""
        return self.over[0] + Ends(-radius, radius)

    def halved(self, parts: int) -> Slabs:
        """Cut each slab into equal parts."""
        steps = (2.0 * np.arange(parts) + 1.0) / parts - 1.0
        middle = (self.middle[:, None] + self.half[:, None] * steps).ravel()
        index = np.repeat(np.arange(len(self)), parts)
        # Rounding must not uncover the slab.
        half = np.repeat(self.half / parts, parts) * (1.0 + 1e-9)
        return Slabs(self.owner[index], middle, half, self.cells.take(index))


def slabs_of(cells: Cells) -> Slabs:
    """All slabs; those of a cell cover [-OVERHANG, 1 + OVERHANG]."""
    counts = cells.slabs.astype(np.intp)
    owner = np.repeat(np.arange(len(cells)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    length = (1.0 + 2.0 * OVERHANG) / counts[owner]
    middle = (number + 0.5) * length - OVERHANG
    return Slabs(owner, middle, 0.5 * length * (1.0 + 1e-9), cells.take(owner))


def at_node(cells: Cells, s: Array) -> Slabs:
    """Slabs of length zero at s = 0 or 1."""
    return Slabs(np.arange(len(cells)), s, np.zeros(len(cells)), cells)


def evaluated(cubic: Ends, x: Ends) -> tuple[Ends, Ends, Ends]:
    """Ranges of p, p', p''/2 for cubics (slabs, 4, m) at offsets (slabs, 1)."""
    q0, q1, q2, q3 = (cubic[:, k] for k in range(4))
    by_last = x * q3
    second = q2 + by_last + by_last + by_last
    return q0 + x * (q1 + x * (q2 + by_last)), q1 + x * (q2 + second), second


def advance(slabs: Slabs) -> Array:
    """Lower bound of c . p'(s), shape (slabs,)."""
    bound, _ = along(slabs.cells.chart, slabs.velocity)
    return bound


def along(chart: Array, v: Ends) -> tuple[Array, Array]:
    """Range of c . v by row."""
    product = bilinear(np.matmul, thin(chart[:, None, :]), Ends(v.lo[..., None], v.hi[..., None]))
    return product.lo[:, 0, 0], product.hi[:, 0, 0]
