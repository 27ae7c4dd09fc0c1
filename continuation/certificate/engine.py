"""What Krawczyk's test needs to know of slabs, and what follows from it where it holds."""

from __future__ import annotations

from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Cells, Index, Slabs
from continuation.numbers.ends import TINIEST, Ends, accumulated


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

    def pace(self, radius: Array, tube: Array) -> tuple[Ends, Ends]:
        """The ranges of the parameter's rate along the curve, or a multiple > 0 of it, and of the derivative of that.

        They are those of parts of each slab, of equal length and in order, shape (slabs, parts).

        The second is nan where it is not known, as where the first has a sign all along.

        Parameters
        ----------
        radius, tube : ndarray, shape (slabs, N + 1)
            As in `tangent`.
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
