"""Krawczyk's test on slabs, for any homotopy whose residual runs on interval arrays.

In the chart c . (u - p(s)) = 0 let G(s, u) = (H(u), c . (u - p(s))), and Y any matrix. If for every s of a slab

    |Y G(s, p(s))| + |I - Y G'(p(s) + d)| r < r    for all |d| <= r, component by component,

then p(s) + [-r, r] holds exactly one zero of G(s, .) for every such s, and it moves smoothly with s: one arc (Krawczyk,
Computing 4 (1969) 187-201; with the uniqueness of Moore, SIAM J. Numer. Anal. 14 (1977) 611-615).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.certificate.cells import Slabs, cell_sizes
from continuation.certificate.engine import Engine, Judged, SupportsProofEngine, applied, solution_range, up_by
from continuation.certificate.inverse import inverses, times
from continuation.numbers import Interval, UndecidedError
from continuation.numbers.algebra import lengthened
from continuation.numbers.boxes import along_curve, derivatives, with_gradient
from continuation.numbers.ends import Ends, accumulated, moved, thin
from continuation.numbers.truncated import wrap

RESIDUAL_NUMBERS = 500_000
"""Numbers of one array while many slabs go through a residual together: 4 MB, and 64 where each is cut into `most`."""

DIRECTIONS_THAT_PAY = 16
"""Second derivatives in so many directions pay: of exponential-cosine with 10 unknowns they save nine boxes of ten, of
Bratu's equation with 30 none, and its proof took eight times as long."""

STANDS_STILL = 1e-10
"""Of the size of a component: one that moves by less is where it is to the accuracy of the path's points."""

MISFIT_PARTS = 4
"""Into so many parts a slab is cut to bound H along the cubic: what Taylor's formula leaves of it is of third order."""


@frozen(eq=False)
class ByIntervals:
    """Any homotopy: derivatives over the boxes by interval arithmetic.

    Attributes
    ----------
    residual : callable
        ``residual(y, lam)``, of the homotopy.
    unknowns : int
        N. Up to `DIRECTIONS_THAT_PAY` the preconditioner follows the path.
    still : bool
        Whether some component stands still along all of the path: it has no size then in which to take differences of
        second derivatives, and the preconditioner stays as it is.
    """

    residual: Callable[[Any, Any], Any]
    unknowns: int
    still: bool = False
    exact: ClassVar[bool] = False

    @property
    def moving(self) -> bool:
        """Whether the preconditioner follows the path."""
        return self.unknowns <= DIRECTIONS_THAT_PAY and not self.still

    @property
    def order(self) -> int:
        """One more than that of the preconditioner."""
        return 2 if self.moving else 1

    @property
    def most(self) -> int:
        """See `Engine`."""
        return 8 if self.moving else 16

    def image(self, u: Interval) -> Any:
        """H on an interval array of shape (N + 1,); nan for boxes on which a comparison is not decided."""
        whole: Any = u
        try:
            return u.lifted(self.residual(whole[:-1], whole[-1]))
        except UndecidedError:
            count = u.c.lo.shape[1]
            if count == 1:
                return wrap(thin(np.full((len(u.c), 1, u.size - 1), np.nan)), u.algebra)
            halves = (slice(None, count // 2), slice(count // 2, None))
            parts = [self.image(u.moved(partial(_boxes, half))) for half in halves]
            return _side_by_side(parts)

    def probe(self, u: Array) -> None:
        """Run the residual on one point: TypeError, naming the operation, where it cannot be."""
        self.image(with_gradient(u[None], u[None]))

    def together(self, m: int) -> int:
        """As their boxes go through the residual together."""
        return max(1, RESIDUAL_NUMBERS // (6 * m * (m + 1)))

    def bent(self, box: Ends, t: Ends) -> Ends | None:
        """See `Engine`."""
        image = self.image(along_curve(box, t, thin(np.zeros_like(t.lo)))).c
        return image[2] if len(image.lo) == 3 else None  # constant along every line

    def judge(self, slabs: Slabs, radius: Array) -> Judged:
        """As `Engine.judge`; with a preconditioner that stands still where H' has no derivative, at kinks."""
        if not (self.moving and slabs.half.any()):
            return self._still(slabs, radius)
        found = self._moving(slabs, radius)
        rough = ~np.isfinite(found.off).all(axis=(1, 2))
        if rough.any():
            found.put(rough, self._still(slabs.take(rough), radius[rough]))
        return found

    def _still(self, slabs: Slabs, radius: Array) -> Bounded:
        Y, off = self._inverse(slabs, slabs.box(radius))
        return Bounded(self._misfit(slabs, Y), Y, up_by(off, 1), radius, np.zeros_like(Y), slabs.offset[:, None])

    def _moving(self, slabs: Slabs, radius: Array) -> Bounded:
        """With Y(s) = (I - x E) Y_0, E about Y_0 W, where G'(p(s) + d) lies in G_0 + x W for x = s - middle.

        G_0 is the range of G' over the box around the middle alone, W that of H''(p'(s), .) over the whole. With
        R = I - Y_0 G_0 and D = Y_0 W - E, I - Y(s) G' is R - x (D + E R) + x^2 (E E + E D).
        """
        m, x = radius.shape[1], slabs.offset[:, None, None]
        Y, R = self._inverse(slabs, slabs.cubic[:, 0] + Ends(-radius, radius))
        left = Y[:, :, :-1]
        with np.errstate(all="ignore"):
            W = self._change(slabs.box(radius), slabs.velocity, cell_sizes(slabs.cells))
            middle = W.middle()
            E = np.matmul(left, middle)
            size_E = np.abs(E)
            D = np.matmul(np.abs(left), W.radius(middle) + accumulated(m) * np.abs(middle))
            square = np.abs(np.matmul(E, E)) + np.matmul(size_E, accumulated(m) * size_E + D)
            off = up_by(R + x * (D + np.matmul(size_E, R) + x * square), 4 * m)
            misfit = self._misfit(slabs, Y)
            misfit = up_by(misfit + x[:, 0] * times(size_E, misfit), m + 2)
        return Bounded(misfit, Y, off, radius, E, x[:, 0])

    def _inverse(self, slabs: Slabs, box: Ends) -> tuple[Array, Array]:
        """An inverse Y of the middle of G' over a box, and a bound of |I - Y G'| entry by entry."""
        m = box.shape[1]
        lo, hi = derivatives(self.image(with_gradient(box.lo, box.hi)), m)
        middle = 0.5 * lo + 0.5 * hi
        full = np.concatenate([middle, slabs.cells.chart[:, None, :]], axis=1)
        with np.errstate(all="ignore"):
            Y = inverses(full)
            width = Ends(lo, hi).radius(middle)
            size_Y = np.abs(Y)
            off = np.abs(np.eye(m) - np.matmul(Y, full))
            # Rounding of Y times the middle, of the subtraction, and the width of the derivative.
            off = up_by(off + accumulated(m) * (np.matmul(size_Y, np.abs(full)) + np.eye(m)), 2)
            return Y, off + up_by(np.matmul(size_Y[:, :, :-1], width), m)

    def _change(self, box: Ends, velocity: Ends, unit: Array) -> Ends:
        """The range of H''(p', e_j), shape (slabs, N, m): H''(a, b) is a difference of H'' along a + b and a - b.

        The lengths of the e_j are those of the cell, which makes both of a size.
        """
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

    def _misfit(self, slabs: Slabs, Y: Array) -> Array:
        """|Y H(p(s))| by Taylor's formula about the middle of each part, to second order; to first at kinks."""
        parts = MISFIT_PARTS if self.moving and slabs.half.any() else 1
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


def engine_of(homotopy: Any, points: Array | None = None) -> Engine:
    """What bounds derivatives for this homotopy: by products where it is quadratic, else by intervals.

    Parameters
    ----------
    homotopy : Homotopy
    points : ndarray, shape (m, N + 1), optional
        Of the path.

    Raises
    ------
    TypeError
        If the residual does not run on interval arrays; the message names the operation.
    """
    if isinstance(homotopy, SupportsProofEngine):
        return homotopy.proof_engine()
    y, lam = homotopy.start()
    start = np.append(np.asarray(y, dtype=float), float(lam))
    still = points is not None and bool((np.ptp(points, axis=0) <= STANDS_STILL * np.abs(points).max(axis=0)).any())
    engine = ByIntervals(homotopy.residual, len(start) - 1, still)
    engine.probe(start)
    return engine


def size_of(Y: Array, v: Ends) -> Array:
    """A bound of |Y v| for interval vectors v, slab by slab."""
    bound = applied(Y, v).magnitude()
    return np.where(np.isfinite(v.lo).all(axis=-1) & np.isfinite(v.hi).all(axis=-1), bound.T, np.nan).T


@frozen(eq=False)
class Bounded:
    """The bounds as a matrix: |I - Y G'| entry by entry, for all radii up to `largest`."""

    misfit: Array
    Y: Array
    off: Array
    largest: Array
    E: Array
    offset: Array

    def put(self, index: Any, some: Bounded) -> None:
        """Replace those of some slabs."""
        for name in Bounded.__annotations__:
            getattr(self, name)[index] = getattr(some, name)

    def tangent(self, radius: Array, tube: Array) -> Ends:
        """See `Judged.tangent`; c . t = 1."""
        return solution_range(self, self._moved(thin(self.Y[:, :, -1])), radius, tube)

    def pace(self, radius: Array, tube: Array) -> None:
        """They are valid for one tube."""
        return

    def applied(self, v: Ends) -> Ends:
        """Y(s) = (I - x E) Y_0."""
        return self._moved(applied(self.Y, v))

    def _moved(self, image: Ends) -> Ends:
        return image + Ends(-self.offset, self.offset) * applied(self.E, image)

    def spread(self, x: Array, radius: Array) -> Array:
        """Nothing is known (nan) beyond the largest radii."""
        bound = up_by(times(self.off, x), x.shape[1])
        known = (radius <= self.largest).all(axis=1, keepdims=True)
        return np.where(known, bound, np.nan)


def _boxes(some: slice, x: Array) -> Array:
    return x[:, some]


def _side_by_side(parts: list[Interval]) -> Any:
    """Boxes of two arrays in one; a part without derivatives has zeros for them."""
    stores = [lengthened(part.c, max(len(part.c) for part in parts)) for part in parts]
    return wrap(moved(lambda *ends: np.concatenate(ends, axis=1), *stores), parts[0].algebra)
