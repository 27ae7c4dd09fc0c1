"""What Krawczyk's test needs to know of slabs, and what follows from it where it holds."""

from __future__ import annotations

from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Cells, Index, Slabs
from continuation.numbers.ends import EPS, TINIEST, Ends, accumulated, bilinear, thin


class Judged(Protocol):
    """What is known of slabs once their derivatives have been bounded."""

    @property
    def misfit(self) -> Array:
        """A bound of |Y G(s, p(s))|, shape (slabs, N + 1); nan where there is none."""
        ...

    def tangent(self, radius: Array, tube: Array) -> Ends:
        """A multiple > 0 of the tangent over each slab, shape (slabs, N + 1); nan where unknown.

        Parameters
        ----------
        radius : ndarray, shape (slabs, N + 1)
            Within which the curve lies.
        tube : ndarray, shape (slabs, N + 1)
            Radii with which the test holds, for a norm.
        """
        ...

    def pace(self, radius: Array, tube: Array) -> tuple[Ends, Ends] | None:
        """The ranges of the first two derivatives of the parameter along the curve, on parts of each slab of equal
        length and in order, shape (slabs, parts); None where the bounds of a slab do not tell them.

        The second is nan where the first has a sign all along.

        Parameters
        ----------
        radius, tube : ndarray, shape (slabs, N + 1)
            As in `tangent`.
        """
        ...

    def applied(self, v: Ends) -> Ends:
        """The range of Y(s) v over each slab.

        Parameters
        ----------
        v : Ends, shape (slabs, N + 1)
        """
        ...

    def spread(self, x: Array, radius: Array) -> Array:
        """A bound of |I - Y G'(p(s) + d)| x for |d| <= radius and x >= 0.

        Parameters
        ----------
        x, radius : ndarray, shape (slabs, N + 1)
        """
        ...


class Engine(Protocol):
    """A way to bound what Krawczyk's test needs.

    Attributes
    ----------
    exact : bool
        Whether bounds hold for all radii, and smaller ones need no new judgement.
    """

    exact: ClassVar[bool]

    @property
    def order(self) -> int:
        """To which power of a slab's length |I - Y(s) G'(p(s))| falls."""
        ...

    @property
    def most(self) -> int:
        """Into so many slabs a cell is cut; where they do not do, a new point of the path is worth more."""
        ...

    def together(self, m: int) -> int:
        """So many slabs are best judged together.

        Parameters
        ----------
        m : int
            Unknowns, with the parameter.
        """
        ...

    def bent(self, box: Ends, t: Ends) -> Ends | None:
        """The range of H''(t, t) / 2 over boxes, shape (slabs, N); None where there is none, or nobody asks.

        Parameters
        ----------
        box, t : Ends, shape (slabs, N + 1)
        """
        ...

    def judge(self, slabs: Slabs, radius: Array) -> Judged:
        """Bounds for slabs, valid for radii up to `radius`.

        Parameters
        ----------
        slabs : Slabs
        radius : ndarray, shape (slabs, N + 1)
        """
        ...


@runtime_checkable
class SupportsProofEngine(Protocol):
    """A homotopy that knows bounds of its own: its proofs are then cheaper than by interval arithmetic."""

    def proof_engine(self) -> Engine:
        """What proofs of its paths ask.

        Returns
        -------
        Engine
        """
        ...


def together(engine: Engine, cells: Cells) -> list[Index]:
    """Places of cells to be judged together, by the number of their slabs."""
    most = engine.together(cells.radius.shape[1])
    groups = (np.cumsum(cells.slabs) - cells.slabs) // most
    return np.split(np.arange(len(cells)), np.flatnonzero(np.diff(groups)) + 1)


def up_by(x: Array, count: int) -> Array:
    """A bound for sums of `count` products of numbers >= 0 that were rounded in any order."""
    bound: Array = x * (1.0 + accumulated(count)) + 4.0 * count * TINIEST
    return bound


def applied(Y: Array, v: Ends) -> Ends:
    """The range of matrices times interval vectors, slab by slab."""
    image = bilinear(np.matmul, thin(Y), Ends(v.lo[..., None], v.hi[..., None]))
    return Ends(image.lo[..., 0], image.hi[..., 0])


def solution_range(judged: Judged, v: Ends, radius: Array, tube: Array) -> Ends:
    """The solutions of G' z = b, all over the slab, for v that holds Y(s) b.

    With E = I - Y(s) G', z = (I - E)^{-1} Y(s) b, so that |z - Y(s) b| is at most the sum of E^k |Y(s) b| over k >= 1:
    two terms, and a geometric series, as E^3 |Y(s) b| <= theta r and E r <= kappa r.

    Parameters
    ----------
    judged : Judged
    v : Ends
    radius, tube : ndarray, shape (slabs, N + 1)
        As in `Judged.tangent`.
    """
    with np.errstate(all="ignore"):
        first = judged.spread(v.magnitude(), radius)
        second = judged.spread(first, radius)
        kappa = (judged.spread(tube, radius) / tube).max(axis=1) * (1.0 + 4.0 * EPS)
        theta = (judged.spread(second, radius) / tube).max(axis=1) * (1.0 + 4.0 * EPS)
        factor = np.where(kappa < 1.0, theta / (1.0 - kappa), np.nan) * (1.0 + 8.0 * EPS)
        room = up_by(first + second + factor[:, None] * tube, 3)
        return v + Ends(-room, room)
