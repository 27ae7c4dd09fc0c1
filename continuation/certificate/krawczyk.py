"""Krawczyk's test on slabs, for homotopies whose residual runs on interval arrays.

In the chart c . (u - p(s)) = 0 let G(s, u) = (H(u), c . (u - p(s))), and let Y be any matrix. If for every s of a slab

    |Y G(s, p(s))| + |I - Y G'(p(s) + d)| r < r    for all |d| <= r, component by component,

then p(s) + [-r, r] holds exactly one zero of G(s, .) for each s, and it moves smoothly with s (Krawczyk, Computing 4
(1969) 187-201; uniqueness: Moore, SIAM J. Numer. Anal. 14 (1977) 611-615).
"""

from __future__ import annotations

from collections.abc import Callable
from operator import itemgetter
from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import EPS, Array, Mask
from continuation.certificate.cells import SLAB_PARTS, Slabs, cell_sizes
from continuation.certificate.engine import Engine, SupportsProofEngine, inverses, times, up_by
from continuation.numbers import Interval, UndecidedError
from continuation.numbers.algebra import lengthened
from continuation.numbers.boxes import along_curve, derivatives, with_gradient
from continuation.numbers.ends import Ends, accumulated, bilinear, moved, thin
from continuation.numbers.truncated import wrap

DIRECTIONS_THAT_PAY = 16
"""Unknowns up to which second derivatives pay: they save nine boxes of ten with 10 (exponential-cosine), none with 30
(Bratu), where the proof takes eight times as long."""


@frozen(eq=False)
class ByIntervals:
    """Derivatives over boxes by interval arithmetic; `unknowns` is N."""

    residual: Callable[[Any, Any], Any]
    unknowns: int
    exact: ClassVar[bool] = False

    @property
    def moving(self) -> bool:
        """Whether the preconditioner follows the path: N <= `DIRECTIONS_THAT_PAY`."""
        return self.unknowns <= DIRECTIONS_THAT_PAY

    @property
    def most(self) -> int:
        """See `Engine`."""
        return 8 if self.moving else 16

    def image(self, u: Interval) -> Any:
        """H on an interval array, shape (N + 1,); nan if undecided."""
        whole: Any = u
        try:
            return u.lifted(self.residual(whole[:-1], whole[-1]))
        except UndecidedError:
            count = u.c.lo.shape[1]
            if count == 1:
                return wrap(thin(np.full((len(u.c), 1, u.size - 1), np.nan)), u.algebra)
            halves = (slice(None, count // 2), slice(count // 2, None))
            parts = [self.image(u.moved(itemgetter((slice(None), half)))).c for half in halves]
            stores = [lengthened(part, max(map(len, parts))) for part in parts]
            return wrap(moved(lambda *ends: np.concatenate(ends, axis=1), *stores), u.algebra)

    def judge(self, slabs: Slabs, radius: Array) -> Bounded:
        """As `Engine.judge`, with Y(s) = (I - x E) Y_0, E about Y_0 W, where G'(p(s) + d) lies in G_0 + x W, x = s - m.

        G_0 is the range of G' over the box at the middle m, W that of H''(p'(s), .) over the whole. With
        R = I - Y_0 G_0 and D = Y_0 W - E, I - Y(s) G' is R - x (D + E R) + x^2 (E E + E D). At kinks, or with many
        unknowns, E = D = 0 and G_0 is over the whole box.
        """
        m, x, whole = radius.shape[1], slabs.offset[:, None, None], slabs.box(radius)
        W = thin(np.full((len(slabs), m - 1, m), np.nan))
        moving = self.moving and bool(slabs.half.any())
        if moving:
            size = cell_sizes(slabs.cells)
            # Components that stand still get the largest range, in unit lengths.
            unit = np.where(size < radius, radius * (size / radius).max(axis=1, keepdims=True), size)
            W = self._change(whole, slabs.velocity, unit)
        at, largest = slabs.cubic[:, 0] + Ends(-radius, radius), W.magnitude().sum(axis=(1, 2), keepdims=True)
        along = np.isfinite(largest)
        smooth = along[:, 0]
        box = Ends(np.where(smooth, at.lo, whole.lo), np.where(smooth, at.hi, whole.hi))
        Y, R = self._inverse(slabs, box)
        left = Y[:, :, :-1]
        with np.errstate(all="ignore"):
            middle = W.middle()
            E = np.where(along, np.matmul(left, middle), 0.0)
            size_E = np.abs(E)
            D = np.matmul(np.abs(left), W.radius(middle) + accumulated(m) * np.abs(middle))
            D = np.where(along, D, 0.0)
            square = np.abs(np.matmul(E, E)) + np.matmul(size_E, accumulated(m) * size_E + D)
            off = up_by(R + x * (D + np.matmul(size_E, R) + x * square), 4 * m)
            misfit = self._misfit(slabs, Y, SLAB_PARTS if moving else 1)
            misfit = up_by(misfit + x[:, 0] * times(size_E, misfit), m + 2)
        return Bounded(self, slabs, misfit, Y, off, radius, E)

    def _inverse(self, slabs: Slabs, box: Ends) -> tuple[Array, Array]:
        """Y, about the inverse of G' over a box, and bounds of the entries of |I - Y G'|."""
        m = box.shape[1]
        lo, hi = derivatives(self.image(with_gradient(box.lo, box.hi)), m)
        middle = 0.5 * lo + 0.5 * hi
        full = np.concatenate([middle, slabs.cells.chart[:, None, :]], axis=1)
        with np.errstate(all="ignore"):
            Y = inverses(full)
            width = Ends(lo, hi).radius(middle)
            size_Y = np.abs(Y)
            off = np.abs(np.eye(m) - np.matmul(Y, full))
            # Bound the rounding of product and subtraction, then the derivative's width.
            off = up_by(off + accumulated(m) * (np.matmul(size_Y, np.abs(full)) + np.eye(m)), 2)
            return Y, off + up_by(np.matmul(size_Y[:, :, :-1], width), m)

    def _change(self, box: Ends, velocity: Ends, unit: Array) -> Ends:
        """Range of H''(p', e_j), shape (slabs, N, m), from H'' along p' + e_j and p' - e_j."""
        count, m = unit.shape
        step: Array = np.exp2(np.round(np.log2(unit)))
        along = np.zeros((2, m, count, m))
        for sign, part in zip((1.0, -1.0), along):
            part[np.arange(m), :, np.arange(m)] = sign * step.T
        shape = (2 * m * count, m)
        direction = thin(along.reshape(shape)) + Ends(*(np.tile(v, (2 * m, 1)) for v in (velocity.lo, velocity.hi)))
        boxes = Ends(*(np.tile(v, (2 * m, 1)) for v in (box.lo, box.hi)))
        image = self.image(along_curve(boxes, direction, thin(np.zeros(shape)))).c
        if len(image.lo) < 3:  # constant along every line
            return thin(np.zeros((count, m - 1, m)))
        both = Ends(*(v[2].reshape(2, m, count, m - 1) for v in (image.lo, image.hi)))
        change = (both[0] - both[1]) * thin(0.5 / step.T[:, :, None])
        return Ends(*(v.transpose(1, 2, 0) for v in (change.lo, change.hi)))

    def _misfit(self, slabs: Slabs, Y: Array, parts: int) -> Array:
        """|Y H(p(s))| by Taylor's formula to second order, at kinks to first."""
        fine = slabs.halved(parts)
        x, left, count = fine.offset[:, None], np.repeat(Y[:, :, :-1], parts, axis=0), len(fine)
        both = [moved(lambda *ends: np.concatenate(ends), fine.cubic[:, k], fine.over[k]) for k in range(3)]
        image = self.image(along_curve(*both)).c
        if len(image.lo) == 1:  # constant along the curve
            image = Ends(*(np.concatenate([e, np.zeros((2, *e.shape[1:]))]) for e in (image.lo, image.hi)))
        at, along = image[:, :count], image[:, count:]
        with np.errstate(all="ignore"):
            linear = size_of(left, at[1]) * x + size_of(left, along[2]) * x * x
            blunt = size_of(left, along[1]) * x
            bound = up_by(size_of(left, at[0]) + np.fmin(linear, blunt), 4)
            return np.asarray(bound.reshape(len(slabs), parts, -1).max(axis=1))


def engine_of(homotopy: Any) -> Engine:
    """The source of bounds: the homotopy's own engine, else its residual in interval arithmetic.

    `TypeError` names an operation of the residual that intervals lack.
    """
    if isinstance(homotopy, SupportsProofEngine):
        return homotopy.proof_engine()
    y, lam = homotopy.start()
    start = np.append(np.asarray(y, dtype=float), float(lam))[None]
    engine = ByIntervals(homotopy.residual, start.size - 1)
    engine.image(with_gradient(start, start))
    return engine


def applied(Y: Array, v: Ends) -> Ends:
    """Range of matrix times interval vector."""
    image = bilinear(np.matmul, thin(Y), Ends(v.lo[..., None], v.hi[..., None]))
    return image[..., 0]


def size_of(Y: Array, v: Ends) -> Array:
    """Upper bound of |Y v|."""
    bound = applied(Y, v).magnitude()
    return np.where(np.isfinite(v.lo).all(axis=-1) & np.isfinite(v.hi).all(axis=-1), bound.T, np.nan).T


@frozen(eq=False)
class Bounded:
    """Bounds for radii up to `largest`; `off`: |I - Y G'| by entry."""

    engine: ByIntervals
    slabs: Slabs
    misfit: Array
    Y: Array
    off: Array
    largest: Array
    E: Array

    def take(self, index: Mask) -> Bounded:
        """Select slabs."""
        bounds = (self.misfit, self.Y, self.off, self.largest, self.E)
        return Bounded(self.engine, self.slabs.take(index), *(bound[index] for bound in bounds))

    def tangent(self, radius: Array, tube: Array) -> Ends:
        """See `Judged.tangent`; c . t = 1."""
        return self._solved(thin(self.Y[:, :, -1]), radius, tube)

    def pace(self, radius: Array, tube: Array) -> tuple[Ends, Ends]:
        """See `Judged.pace`, with c . t = 1. Slabs without a sign are cut, which shrinks wide images tenfold."""
        slope, most = self.tangent(radius, tube)[:, -1:], 2 * SLAB_PARTS
        ends = np.repeat([[slope.lo, slope.hi], np.full((2, len(radius), 1), np.nan)], most, axis=3)
        with np.errstate(all="ignore"):
            asked = (self._image(radius) < radius).all(axis=1) & ~(slope.lo * slope.hi > 0.0)[:, 0]
        for cuts in (1, most):
            if not asked.any():
                break
            r = np.repeat(radius[asked], cuts, axis=0)
            judged = self.take(asked)
            if cuts > 1:
                parts = judged.slabs.halved(cuts)
                image = self.engine.judge(parts, r)._image(r)
                r = np.where(image < r, np.maximum(image, 1e-9 * r), r)
                judged = self.engine.judge(parts, r)
            found = np.array([[x.lo, x.hi] for x in judged.turned(r)])
            ends[:, :, asked] = np.repeat(found.reshape(2, 2, -1, cuts), most // cuts, axis=3)
            asked &= ~(ends[:, 0] * ends[:, 1] > 0.0).any(axis=0).all(axis=1)
        return Ends(*ends[0]), Ends(*ends[1])

    def _image(self, radius: Array) -> Array:
        with np.errstate(all="ignore"):
            return (self.misfit + self.spread(radius, radius)) * (1.0 + 4.0 * EPS)

    def turned(self, radius: Array) -> tuple[Ends, Ends]:
        """Ranges of t's last component and of its derivative up to a factor, shape (slabs,).

        H' t = 0 gives H' t' = -H''(u', t), u' a positive multiple of t.
        """
        t = self.tangent(radius, radius)
        image = self.engine.image(along_curve(self.slabs.box(radius), t, thin(np.zeros_like(t.lo)))).c
        if len(image.lo) < 3:
            return t[:, -1], thin(np.full(len(t), np.nan))
        second = moved(lambda part: np.concatenate([part[2], np.zeros((len(t), 1))], axis=1), image)
        return t[:, -1], -self._solved(applied(self.Y, second), radius, radius)[:, -1]

    def _solved(self, v: Ends, radius: Array, tube: Array) -> Ends:
        """Range of G'^{-1} b within `radius` of the cubic; v holds Y_0 b.

        With F = I - Y(s) G' and w = (I - x E) v it is (I - F)^{-1} w, off w by the sum of F^k |w|: two terms and a
        geometric series, as F^3 |w| <= theta r, F r <= kappa r.
        """
        x = self.slabs.offset[:, None]
        with np.errstate(all="ignore"):
            v = v + Ends(-x, x) * applied(self.E, v)
            first = self.spread(v.magnitude(), radius)
            second = self.spread(first, radius)
            kappa = (self.spread(tube, radius) / tube).max(axis=1) * (1.0 + 4.0 * EPS)
            theta = (self.spread(second, radius) / tube).max(axis=1) * (1.0 + 4.0 * EPS)
            factor = np.where(kappa < 1.0, theta / (1.0 - kappa), np.nan) * (1.0 + 8.0 * EPS)
            room = up_by(first + second + factor[:, None] * tube, 3)
            return v + Ends(-room, room)

    def spread(self, x: Array, radius: Array) -> Array:
        """See `Judged`; nan beyond the largest radii."""
        bound = up_by(times(self.off, x), x.shape[1])
        known = (radius <= self.largest).all(axis=1, keepdims=True)
        return np.where(known, bound, np.nan)
