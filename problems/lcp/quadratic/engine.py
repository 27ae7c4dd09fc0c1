"""Krawczyk's test for quadratic homotopies, exact in the tube's width.

H(p + d) = H(p) + H'(p) d + Q(d, d), so that only rounding needs bounds. Along the cubic, x = s - middle, let Y_0 G' =
W + x E + x^2 F + x^3 H. With the preconditioner Y(s) = (I - x E) Y_0

    I - Y(s) G' = (I - W) + x^2 (E E - F) - x^3 H - x E ((I - W) - x^2 F - x^3 H)

has terms of second order left.
"""

from __future__ import annotations

from math import perm
from typing import ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import EPS, Array
from continuation.certificate.cells import Slabs, evaluated
from continuation.certificate.engine import Judged, inverses, times, up_by
from continuation.numbers.ends import Ends, accumulated, thin
from problems.lcp.quadratic.form import Quadratic

PARTS = 32
"""Parts of a slab for the size of H along the cubic, of which a sum of coefficients is several times too large, and for
the signs of the parameter's derivatives."""


@frozen(eq=False)
class ByProducts:
    """The engine of quadratic homotopies.

    Attributes
    ----------
    form : Quadratic
    """

    form: Quadratic
    exact: ClassVar[bool] = True
    most: ClassVar[int] = 4

    def judge(self, slabs: Slabs, radius: Array) -> Judged:
        """See `Engine`; valid for all radii."""
        with np.errstate(all="ignore"):
            return self._judge(slabs, radius)

    def _judge(self, slabs: Slabs, radius: Array) -> Judged:
        form, m, t, chart = self.form, radius.shape[1], slabs.offset[:, None, None], slabs.cells.chart[:, None, :]
        alpha, beta, value = (part.along(slabs.cubic) for part in (form.first, form.second, form.plain))
        G = form.derivatives(alpha.middle(), beta.middle())
        whole, gamma, one = np.concatenate([G[:, 0], chart], axis=1), accumulated(m + 16), np.eye(m)
        # Pivoting needs rows of equal size, in units near the radii.
        units = np.exp2(np.round(np.log2(radius)))[:, None, :]
        rows = np.abs(whole * units).max(axis=2, keepdims=True)
        Y = inverses(whole * units / rows) * units.transpose(0, 2, 1) / rows.transpose(0, 2, 1)
        left, size_Y = Y[:, :, :-1], np.abs(Y)
        plain = np.abs(one - np.matmul(Y, whole)) + gamma * (size_Y[:, :, -1:] * np.abs(chart) + one)
        found = form.image(value, alpha, beta)
        middle = found.middle()
        room = np.matmul(size_Y[:, :, :-1], found.radius(middle) + gamma * np.abs(middle))
        fixed = slabs, form, size_Y[:, :, :-1], form.rounding(alpha, beta, t)
        image = np.matmul(left, middle), up_by(room, m + 8)
        if not slabs.offset.any():
            return Bounds(*fixed, *image, largest(*image, slabs.offset), plain)
        E, F, H = (np.matmul(left, G[:, k]) for k in (1, 2, 3))
        both, wide = (np.pad(x, ((0, 0), (0, 0), (0, 1))) for x in image)
        both[:, :, 1:] -= np.matmul(E, image[0])
        wide[:, :, 1:] += np.matmul(np.abs(E), image[1] + gamma * np.abs(image[0]))
        misfit = largest(both, up_by(wide + gamma * np.abs(both), m + 8), slabs.offset)
        second = np.abs(F - np.matmul(E, E))
        E, F, H = np.abs(E), t * np.abs(F), t * t * np.abs(H)
        through_E = plain + t * (gamma * E + F + H)
        return Bounds(*fixed, *image, misfit, plain + t * (t * second + H), E, through_E, E + 2.0 * F + 3.0 * H)


@frozen(eq=False, slots=False)
class Bounds:
    """Bounds for slabs.

    `size_Y`: |Y_0| without its last column. `lost`: rounding of G'. `image`, `room`, (slabs, N + 1, 7): coefficients of
    Y_0 H(p), and their radii. `misfit`: |Y(s) H(p(s))|. `off`: |I - Y(s) G'| but for the terms with x E. `E`,
    `through_E`, `turning`: |E|, its factor in these terms, |Y_0 2 Q(p', .)|; None for slabs of no length.
    """

    slabs: Slabs
    form: Quadratic
    size_Y: Array
    lost: Array
    image: Array
    room: Array
    misfit: Array
    off: Array
    E: Array | None = None
    through_E: Array | None = None
    turning: Array | None = None

    @property
    def t(self) -> Array:
        """Largest |x|, shape (slabs, 1)."""
        return self.slabs.offset[:, None]

    def _lifted(self, v: Array) -> Array:
        """Bound of |I - x E| v."""
        return v if self.E is None else up_by(v + self.t * times(self.E, v), v.shape[1] + 4)

    def _pushed(self, defect: Array) -> Array:
        """Bound of |Y(s)| defect."""
        return self._lifted(up_by(times(self.size_Y, defect), defect.shape[1]))

    def _along(self, order: int) -> Array:
        """Bound of |Y(s)| times a derivative of H(p(s))."""
        count = self.image.shape[2] - order
        factors = np.array([float(perm(k + order, order)) for k in range(count)])
        return self._lifted(
            largest(self.image[:, :, order:] * factors, self.room[:, :, order:] * factors, self.slabs.offset)
        )

    def spread(self, x: Array, radius: Array) -> Array:
        """See `Judged.spread`."""
        with np.errstate(all="ignore"):
            m = x.shape[1]
            found = times(self.off, x)
            if self.E is not None and self.through_E is not None:
                found = found + self.t * times(self.E, times(self.through_E, x))
            lost = up_by(times(self.lost, x) + self.form.products(x, radius), m)
            return up_by(found, 3 * m) + self._pushed(lost)

    def _turned(self, radius: Array) -> Array:
        """Bound of |Y(s) 2 Q(d, p'(s))|, |d| <= radius; 2 Q(p', .) is the derivative of G'."""
        if self.turning is None:
            return self._pushed(self.form.products(self.slabs.velocity.magnitude(), radius))
        lost = times(self.lost, 3.0 / self.t * radius)
        return self._lifted(up_by(times(self.turning, radius), radius.shape[1])) + self._pushed(
            up_by(lost, lost.shape[1])
        )

    def _solved(self, v: Array, radius: Array, tube: Array) -> Array:
        """Bound of |G'^{-1} b| within `radius` <= tube of the cubic, from v >= |Y(s) b|.

        With R = I - Y G' and R r <= kappa r: v + R v, plus theta / (1 - kappa) r if R R v is at most theta r.
        """
        first = self.spread(v, radius)
        kappa = (self.spread(tube, radius) / tube).max(axis=1, keepdims=True) * (1.0 + 4.0 * EPS)
        theta = (self.spread(first, radius) / tube).max(axis=1, keepdims=True)
        return up_by(v + first + np.where(kappa < 1.0, theta / (1.0 - kappa), np.nan) * tube, 16)

    def _drift(self, radius: Array, tube: Array) -> Array:
        """Bound of |u'(s) - p'(s)| for u(s) within `radius` of p(s).

        u' - p' = -G'^{-1} (H'(u) p', 0), and H'(u) p' = (H(p))' + 2 Q(u - p, p').
        """
        with np.errstate(all="ignore"):
            return self._solved(self._along(1) + self._turned(radius), radius, tube)

    def tangent(self, radius: Array, tube: Array) -> Ends:
        """See `Judged.tangent`."""
        room = self._drift(radius, tube)
        return self.slabs.velocity + Ends(-room, room)

    def pace(self, radius: Array, tube: Array) -> tuple[Ends, Ends]:
        """See `Judged.pace`.

        With e = u' - p': u'' - p'' = -G'^{-1} (r, 0), r = (H(p))'' + 4 Q(p', e) + 2 Q(e, e) + 2 Q(u - p, p'').
        """
        drift, two = self._drift(radius, tube), thin(np.full((1, 1), 2.0))
        room, places = drift[:, -1:], (2.0 * np.arange(PARTS) + 1.0) / PARTS - 1.0
        over = Ends(self.t * (places - (1.0 + 1e-9) / PARTS), self.t * (places + (1.0 + 1e-9) / PARTS))
        _, first, second = evaluated(self.slabs.cubic[:, :, -1:], over)
        slope = first + Ends(-room, room)
        if ((slope.lo > 0.0).all(axis=1) | (slope.hi < 0.0).all(axis=1)).all():
            return slope, thin(np.full_like(slope.lo, np.nan))
        with np.errstate(all="ignore"):
            bend = (two * self.slabs.over[2]).magnitude()
            more = self.form.products(drift, drift) + self.form.products(bend, radius)
            v = up_by(self._along(2) + 2.0 * self._turned(drift) + self._pushed(more), 8)
            again = self._solved(v, radius, tube)[:, -1:]
            return slope, two * second + Ends(-again, again)


def largest(image: Array, room: Array, offset: Array) -> Array:
    """Bound of polynomials with coefficients within `room` of `image`, last axis, up to `offset` from zero."""
    count = image.shape[2]
    powers = offset[:, None, None] ** np.arange(float(count))
    found = image * powers
    places = np.vander((2.0 * np.arange(PARTS) + 1.0) / PARTS - 1.0, count, increasing=True)
    steep = np.matmul(np.abs(found), np.arange(float(count)) / PARTS + 64.0 * EPS)
    return up_by(np.abs(np.matmul(found, places.T)).max(axis=2) + steep + (room * powers).sum(axis=2), 64)
