"""The bounds that Krawczyk's test needs."""

from __future__ import annotations

from contextlib import suppress
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Cells, Index, Slabs
from continuation.numbers.ends import TINIEST, Ends, accumulated

BATCH = 100_000
"""Numbers in an array of matrices of a batch: a few arrays fit the cache; with four times as many a proof takes a third
longer."""


class Judged(Protocol):
    """Bounds on slabs."""

    @property
    def misfit(self) -> Array:
        """Upper bound of |Y G(s, p(s))|, shape (slabs, N + 1); nan if unknown."""
        ...

    def tangent(self, radius: Array, tube: Array) -> Ends:
        """Range of a positive multiple of the tangent, shape (slabs, N + 1); nan if unknown.

        Parameters
        ----------
        radius : ndarray, shape (slabs, N + 1)
            Bounds the curve's distance.
        tube : ndarray, shape (slabs, N + 1)
            Radii for which the test holds.
        """
        ...

    def pace(self, radius: Array, tube: Array) -> tuple[Ends, Ends]:
        """Ranges of the parameter's rate (up to a positive factor) and of its derivative, along the curve.

        Shape (slabs, parts), equal parts in order. The derivative is nan if unknown or unneeded.

        Parameters
        ----------
        radius, tube : ndarray, shape (slabs, N + 1)
            As in `tangent`.
        """
        ...

    def spread(self, x: Array, radius: Array) -> Array:
        """Upper bound of |I - Y G'(p(s) + d)| x for |d| <= radius, x >= 0.

        Parameters
        ----------
        x, radius : ndarray, shape (slabs, N + 1)
        """
        ...


class Engine(Protocol):
    """A source of bounds of Krawczyk's operator.

    Attributes
    ----------
    exact : bool
        Whether bounds hold above the given radii too.
    """

    exact: ClassVar[bool]

    @property
    def most(self) -> int:
        """Most slabs of a cell; beyond, a new point costs less."""
        ...

    def judge(self, slabs: Slabs, radius: Array) -> Judged:
        """Bound Krawczyk's operator on tubes about the slabs, with radii up to `radius`.

        Parameters
        ----------
        slabs : Slabs
        radius : ndarray, shape (slabs, N + 1)
        """
        ...


@runtime_checkable
class SupportsProofEngine(Protocol):
    """A homotopy with bounds cheaper than interval arithmetic."""

    def proof_engine(self) -> Engine:
        """The engine."""
        ...


def together(cells: Cells) -> list[Index]:
    """Batches of cells by number of slabs."""
    most = max(1, BATCH // cells.radius.shape[1] ** 2)
    groups = (np.cumsum(cells.slabs) - cells.slabs) // most
    return np.split(np.arange(len(cells)), np.flatnonzero(np.diff(groups)) + 1)


def up_by(x: Array, count: int) -> Array:
    """Upper bound of sums of `count` products >= 0, rounded in any order."""
    bound: Array = x * (1.0 + accumulated(count)) + 4.0 * count * TINIEST
    return bound


def times(matrix: Array, x: Array) -> Array:
    """Matrix times vector, slab by slab."""
    product: Array = np.matmul(matrix, x[..., None])[..., 0]
    return product


def inverses(matrices: Array) -> Array:
    """Approximate inverses; nan for singular matrices."""
    try:
        return np.asarray(np.linalg.inv(matrices), dtype=float)
    except np.linalg.LinAlgError:
        out = np.full_like(matrices, np.nan)
        for k, matrix in enumerate(matrices):
            with suppress(np.linalg.LinAlgError):
                out[k] = np.linalg.inv(matrix)
        return out
