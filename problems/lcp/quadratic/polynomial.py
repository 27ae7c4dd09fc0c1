"""Krawczyk's test for quadratic homotopies: I - Y(s) G' as a polynomial in x = s - middle.

The preconditioner is Y(s) = (I - x E + x^2 C) Y_0. Units d are powers of two near the radii. E, C and the remainder
need two digits, so single precision suffices.
"""

from __future__ import annotations

from functools import cached_property
from math import factorial

import numpy as np
from attrs import field, frozen

from continuation.arrays import EPS, Array
from continuation.certificate.cells import Slabs, evaluated
from continuation.certificate.engine import inverses, times, up_by
from continuation.numbers.ends import Ends, accumulated, thin
from problems.lcp.quadratic.balls import SINGLE_UNDERFLOW, UNIT, Ball, Single, image_of, largest, rounded
from problems.lcp.quadratic.derivative import Derivative

SHARE = 1e-3
"""Rounding is bounded once, for the misfit plus this part of its maximum."""

TERMS = 6
"""Terms of the tangent's series; the rest is bounded in the tube's shape."""

STRETCHES = 32
"""Parts of a slab for the signs of the parameter's derivatives."""


@frozen(eq=False, slots=False)
class Polynomial:
    """Bounds for slabs.

    Attributes
    ----------
    slabs : Slabs
    derivative : Derivative
    d : ndarray, shape (slabs, m)
        Units.
    Y, off : ndarray
        Y_0 and |I - Y_0 G_0|.
    E, C : ndarray
        None for slabs of no length.
    left : ndarray
        Stacked third-order remainder, |F|, |H|; E, F, H are Y_0 times coefficients of G'.
    """

    slabs: Slabs
    derivative: Derivative
    d: Array
    Y: Array
    off: Array
    E: Single | None = None
    C: Single | None = None
    left: Single | None = None
    _own: dict[bytes, Array] = field(factory=dict, init=False)

    @classmethod
    def of(cls, slabs: Slabs, derivative: Derivative, radius: Array) -> Polynomial:
        """Bounds for radii near `radius`."""
        d = np.exp2(np.round(np.log2(radius)))
        chart, form = slabs.cells.chart, derivative.form
        G0 = np.concatenate([derivative.matrix(0), chart[:, None, :]], axis=1) * d[:, None, :]
        moving = bool(slabs.offset.any())
        # Pivoting needs rows of equal size.
        rows = np.abs(G0).max(axis=2, keepdims=True)
        Y = inverses(G0 / rows) / rows.transpose(0, 2, 1)
        whole, *found = form.times(Y, derivative.a, derivative.b, chart, d, 4 if moving else 1)
        off = np.abs(np.eye(Y.shape[1]) - whole)
        if not moving:
            return cls(slabs, derivative, d, Y, off)
        E, F, H = (coefficient.astype(np.float32) for coefficient in found)
        C = np.matmul(E, E)
        C -= F
        left = np.concatenate([np.matmul(E, F), F, H], axis=1)
        third = left[:, : E.shape[1]]
        third -= np.matmul(C, E)
        third -= H
        return cls(slabs, derivative, d, Y, off, E, C, np.abs(left, out=left))

    @cached_property
    def size_Y(self) -> Array:
        """|Y_0| without its last column."""
        return np.abs(self.Y[:, :, :-1])

    @cached_property
    def sizes(self) -> Single:
        """|E| and |C|, side by side."""
        assert self.E is not None
        assert self.C is not None
        found: Single = np.abs(np.concatenate([self.E, self.C], axis=2))
        return found

    @cached_property
    def _images(self) -> tuple[Ball, ...]:
        """Y_0 H(p), E Y_0 H(p), C Y_0 H(p), of degree 6."""
        image = Ball.of(self.derivative.residual).through(self.Y[:, :, :-1], self.size_Y)
        if self.E is None or self.C is None:
            return (image,)
        return image, *(image.through(matrix.astype(float)) for matrix in (self.E, self.C))

    def _along(self, times: int) -> Array:
        """Bound of |Y(s)| times a derivative of H(p(s))."""
        found = self._images
        if len(found) == 1:
            return self.d * found[0].size[..., times] * float(factorial(times))
        for _ in range(times):
            found = tuple(one.derivative for one in found)
        image, by_E, by_C = found
        return self.d * largest(image, by_E, by_C, self.slabs.offset[:, None])

    @cached_property
    def _slope(self) -> Array:
        """|Y(s) (H(p(s)))'|."""
        return self._along(1)

    @cached_property
    def misfit(self) -> Array:
        """|Y(s) H(p(s))|."""
        return self._along(0)

    @cached_property
    def _errors(self) -> tuple[Array, Array]:
        """A vector x, and bounds of |I - Y G'| x from rounding and Y_0 G_0, scaled.

        The errors e_k of I, E, F, H, and e_C of C, give e_0 + t (e_1 + E e_0) + t^2 (e_2 + E e_1 + C e_0 + e_C) + t^3
        (...) and so on.
        """
        with np.errstate(all="ignore"):
            misfit = self.misfit / self.d
            x = misfit + SHARE * misfit.max(axis=1, keepdims=True)
            x = np.where(x == 0.0, 1.0, x)
            m, t, real = x.shape[1], self.slabs.offset[:, None], x * self.d
            gamma = accumulated(m + 16)
            sizes, errors = self.derivative.image(real)
            vectors = np.concatenate([gamma * sizes + errors], axis=1).transpose(0, 2, 1)
            e = list(up_by(np.matmul(self.size_Y, vectors), m).transpose(2, 0, 1))
            along = up_by((np.abs(self.slabs.cells.chart) * real).sum(axis=1, keepdims=True), m)
            e[0] = up_by(times(self.off, x), m) + gamma * (np.abs(self.Y[:, :, -1]) * along + x) + e[0]
            if self.E is None or self.C is None or self.left is None:
                return x, up_by(e[0], 16)
            lost = 4.0 * m * m * SINGLE_UNDERFLOW * x.max(axis=1, keepdims=True)
            third, by_F, by_H = np.split(image_of(self.left, x), 3, axis=1)
            by_E, by_C = (image_of(np.abs(matrix), x) for matrix in (self.E, self.C))
            for k, size in ((1, by_E), (2, by_F), (3, by_H)):
                e[k] = e[k] + 2.0 * UNIT * size + lost
            g = rounded(m) + 4.0 * UNIT
            e[2] = e[2] + 2.0 * UNIT * by_C + lost
            plain = e[0] + t * e[1] + t**2 * e[2] + t**3 * (e[3] + g * by_H + 2.0 * UNIT * third + 4.0 * lost)
            total = t * e[0] + t**2 * e[1] + t**3 * e[2] + t**4 * e[3]
            through_E = total + t**2 * g * by_E + t**3 * g * by_F
            through_C = t * total + t**3 * g * by_E
            return x, up_by(plain + image_of(self.sizes, np.concatenate([through_E, through_C], axis=1)), 64)

    def _pushed(self, defect: Array, x: Array | None = None) -> Array:
        """Bound of |Y(s)| defect, plus third- and higher-order terms times x."""
        size = up_by(times(self.size_Y, defect), defect.shape[1])
        if self.E is None or self.left is None:
            return size
        t = self.slabs.offset[:, None]
        through_E, through_C, third = t * size, t**2 * size, np.zeros(1)
        if x is not None:
            third, by_F, by_H = np.split(image_of(self.left, x), 3, axis=1)
            through_E, through_C = through_E + t**4 * by_H, through_C + t**4 * by_F + t**5 * by_H
        both = image_of(self.sizes, np.concatenate([through_E, through_C], axis=1))
        return up_by(size + t**3 * third + both, 32)

    def spread(self, x: Array, radius: Array) -> Array:
        """See `Judged.spread`.

        Bounds I - Y(s) (G_0 + x G_1 + x^2 G_2 + x^3 G_3), whose third order is E F - C E - H, and Y(s) 2 Q(d, .).
        """
        if not np.array_equal(x, radius):
            return self._spread(x, radius)
        key = x.tobytes()
        if key not in self._own:
            self._own[key] = self._spread(x, x)
        return self._own[key]

    def _spread(self, x: Array, radius: Array) -> Array:
        with np.errstate(all="ignore"):
            unit, errors = self._errors
            scaled = x / self.d
            share = (scaled / unit).max(axis=1, keepdims=True)
            found = self._pushed(self.derivative.products(x, radius), scaled) + share * errors
            return up_by(self.d * found, 16)

    def _turned(self, radius: Array) -> Array:
        """Scaled bound of |Y(s) 2 Q(d, p'(s))|, |d| <= radius.

        2 Q(p', .) = G_1 + 2 x G_2 + 3 x^2 G_3. Y(s) times it is E + x (F - C) + x^2 (2 H - E F - (E F - C E - H)) + x^3
        (2 C F - 3 E H) + 3 x^4 C H, with errors at most 3 / t times those of I - Y(s) G'.
        """
        if self.E is None or self.left is None:
            return self._pushed(self.derivative.products(self.slabs.velocity.magnitude(), radius))
        unit, errors = self._errors
        t, r = self.slabs.offset[:, None], radius / self.d
        third, by_F, by_H = np.split(image_of(self.left, r), 3, axis=1)
        through_E = r + t**2 * by_F + 3.0 * t**3 * by_H
        through_C = t * r + 2.0 * t**3 * by_F + 3.0 * t**4 * by_H
        both = image_of(self.sizes, np.concatenate([through_E, through_C], axis=1))
        share = (r / unit).max(axis=1, keepdims=True)
        return up_by(both + t * by_F + t**2 * (third + 2.0 * by_H) + 3.0 / t * share * errors, 64)

    def _solved(self, v: Array, radius: Array, tube: Array, terms: int) -> Array:
        """Bound of |G'^{-1} b| within `radius` <= tube of the cubic, from v >= |Y(s) b|.

        With E = I - Y G' and E r <= kappa r: the sum of the first E^k v, plus theta / (1 - kappa) r if the next is at
        most theta r.
        """
        with np.errstate(all="ignore"):
            kappa = (self.spread(tube, tube) / tube).max(axis=1, keepdims=True) * (1.0 + 4.0 * EPS)
            total = np.zeros_like(v)
            for _ in range(terms):
                total, v = total + v, self.spread(v, radius)
            theta = (v / tube).max(axis=1, keepdims=True)
            return up_by(total + np.where(kappa < 1.0, theta / (1.0 - kappa), np.nan) * tube, 4 * terms + 16)

    def _drift(self, radius: Array, tube: Array, terms: int) -> Array:
        """Bound of |u'(s) - p'(s)| for u(s) within `radius` of p(s).

        u' - p' = -G'^{-1} (H'(u) p', 0), and H'(u) p' = (H(p))' + 2 Q(u - p, p').
        """
        with np.errstate(all="ignore"):
            return self._solved(self._slope + self.d * self._turned(radius), radius, tube, terms)

    def tangent(self, radius: Array, tube: Array) -> Ends:
        """See `Judged.tangent`."""
        for terms in (0, TERMS):
            room = self._drift(radius, tube, terms)
            found = self.slabs.velocity + Ends(-room, room)
            if ((found.lo[:, -1] > 0.0) | (found.hi[:, -1] < 0.0)).all():
                break
        return found

    def pace(self, radius: Array, tube: Array) -> tuple[Ends, Ends]:
        """See `Judged.pace`.

        With e = u' - p': u'' - p'' = -G'^{-1} (r, 0), r = (H(p))'' + 4 Q(p', e) + 2 Q(e, e) + 2 Q(u - p, p'').
        """
        t = self.slabs.offset[:, None]
        middle, half = (2.0 * np.arange(STRETCHES) + 1.0) / STRETCHES - 1.0, (1.0 + 1e-9) / STRETCHES
        over = Ends(t * (middle - half), t * (middle + half))
        _, first, second = evaluated(self.slabs.cubic[:, :, -1:], over)
        with np.errstate(all="ignore"):
            drift = self._drift(radius, tube, 0)
            room = Ends(-drift[:, -1:], drift[:, -1:])
            slope = first + room
            if ((slope.lo > 0.0).all(axis=1) | (slope.hi < 0.0).all(axis=1)).all():
                return slope, thin(np.full_like(slope.lo, np.nan))
            drift = self._drift(radius, tube, TERMS)
            room = Ends(-drift[:, -1:], drift[:, -1:])
            two = thin(np.full((1, 1), 2.0))
            bend = (two * self.slabs.over[2]).magnitude()
            more = self.derivative.products(drift, drift) + self.derivative.products(bend, radius)
            v = up_by(self._along(2) + self.d * (2.0 * self._turned(drift) + self._pushed(more)), 8)
            again = self._solved(v, radius, tube, TERMS)[:, -1:]
            return first + room, two * second + Ends(-again, again)
