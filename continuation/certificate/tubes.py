"""Tubes around cells: radii and slabs with which Krawczyk's test holds, found and checked."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.certificate.cells import Cells, Index, Slabs, advance, cell_sizes, joined, slabs_of
from continuation.certificate.engine import Engine, Judged, together
from continuation.certificate.folds import Look, Piece, pieces
from continuation.certificate.links import INFLATION, largest_by_cell, settled
from continuation.numbers.ends import EPS, Mask

LEAST_RADIUS = 1e-6
"""Least radius, in sizes of the cell: a tube that is thinner than round-off at its nodes does not hold its neighbour's
curve. The curve itself is found where it is, within the misfit."""

STILL_ULPS = 1024.0
"""Units in the last place of the nodes: the same for a component that stands still."""

FIRST_RADII = 0.05
"""The radii that a test begins with, in lengths of a slab: they widen the derivatives by so much."""

CELL_TESTS = 6
"""Tests of a cell, with more slabs or other radii each time."""

CONTRACTING = 0.6
"""A bound of |I - Y G'| above this, in the norm of the radii, calls for more slabs: it falls with their length."""


def contracts(slabs: Slabs, judged: Judged, radius: Array) -> Mask:
    """Whether the test holds, slab by slab: the only place where something is proved.

    Parameters
    ----------
    slabs : Slabs
    judged : Judged
    radius : ndarray, shape (slabs, N + 1)

    Returns
    -------
    ndarray of bool
    """
    with np.errstate(all="ignore"):
        total = (judged.misfit + judged.spread(radius, radius)) * (1.0 + 4.0 * EPS)
        # Along the cubic the charts must advance: then each of them is crossed once, in order.
        return np.asarray((total < radius).all(axis=1) & (advance(slabs) > 0.0))


@frozen(eq=False)
class Tubes:
    """Cells with radii and slabs, and what came of their tests.

    Attributes
    ----------
    cells : Cells
    proved : ndarray of bool, shape (cells,)
    undefined : ndarray of bool, shape (cells,)
        Whether the residual has no value, or is not decided, somewhere in the last box that was tried.
    pieces : list of list of list of Piece
        Of each proved cell, of each number that is looked at.
    """

    cells: Cells
    proved: Mask
    undefined: Mask
    pieces: list[list[list[Piece]]]

    @classmethod
    def joined(cls, parts: list[Tubes]) -> Tubes:
        """One after the other."""
        return cls(
            joined([part.cells for part in parts]),
            np.concatenate([part.proved for part in parts]),
            np.concatenate([part.undefined for part in parts]),
            [cell for part in parts for cell in part.pieces],
        )

    def take(self, index: Index) -> Tubes:
        """Some of them."""
        return Tubes(self.cells.take(index), self.proved[index], self.undefined[index], [self.pieces[k] for k in index])

    def numbers(self) -> list[list[Piece]]:
        """Of each number that is looked at the pieces of all cells, in cells."""
        placed = [
            [[Piece(k + piece.lo, k + piece.hi, piece.sign, piece.bend) for piece in part] for part in parts]
            for k, parts in enumerate(self.pieces)
        ]
        return [[piece for part in parts for piece in part] for parts in zip(*placed)]


def search(engine: Engine, cells: Cells, look: Look) -> Tubes:
    """Radii and slabs for cells that have none, many of them in one batch a round.

    Parameters
    ----------
    engine : Engine
    cells : Cells
        With lengths of components that stand still for radii.
    look : callable
        What is asked of proved cells.
    """
    return Tubes.joined([_search(engine, cells.take(place), look) for place in together(engine, cells)])


def _search(engine: Engine, cells: Cells, look: Look) -> Tubes:
    count, scale = len(cells), cell_sizes(cells, cells.radius)
    least = LEAST_RADIUS * scale + STILL_ULPS * EPS * np.maximum(np.abs(cells.begin), np.abs(cells.end))
    slabs, radius = cells.slabs.copy(), np.maximum(FIRST_RADII * scale, least)
    proved, undefined = np.zeros(count, bool), np.zeros(count, bool)
    known: list[list[list[Piece]]] = [[] for _ in range(count)]
    pending = np.arange(count)
    for _ in range(CELL_TESTS):
        tried = cells.take(pending).with_tubes(radius[pending], slabs[pending])
        parts = slabs_of(tried)
        judged = engine.judge(parts, tried.radius[parts.owner])
        # Exact bounds hold for all radii, others for those that they were made with.
        bounded = np.full_like(tried.radius, np.inf) if engine.exact else tried.radius
        wanted, kappa, _ = settled(judged, parts.owner, least[pending], bounded)
        good = _every(contracts(parts, judged, wanted[parts.owner]), parts.owner, len(tried))
        if engine.exact and good.any():
            seen = pieces(look, judged, parts, wanted[parts.owner], len(tried))
            for k in np.flatnonzero(good):
                known[pending[k]] = seen[k]
        proved[pending] = good
        undefined[pending] = ~np.isfinite(largest_by_cell(judged.misfit, parts.owner, len(tried))).all(axis=1)
        # Bounds that hold for all radii are the same again; the others are not.
        wider = np.isfinite(wanted).all(axis=1) & (kappa < CONTRACTING) & (not engine.exact)
        slabs[pending] *= np.where(good | wider, 1, 2)
        first = np.maximum(FIRST_RADII * scale[pending] / slabs[pending][:, None], least[pending])
        kept = np.where(good[:, None], wanted, INFLATION * wanted)
        radius[pending] = np.where((good | wider)[:, None], kept, first)
        pending = pending[~good & (slabs[pending] <= engine.most)]
        if not len(pending):
            break
    cells = cells.with_tubes(radius, np.minimum(slabs, engine.most))
    if not engine.exact and proved.any():  # all at once
        for k, found in zip(np.flatnonzero(proved), check(engine, cells.take(proved), look).pieces):
            known[k] = found
    return Tubes(cells, proved, undefined, known)


def _every(values: Mask, owner: Index, count: int) -> Mask:
    """Whether all of a cell's slabs have it."""
    out = np.ones(count, bool)
    np.logical_and.at(out, owner, values)
    return out


def check(engine: Engine, cells: Cells, look: Look) -> Tubes:
    """What is proved of these cells with the radii and slabs that they have.

    Parameters
    ----------
    engine, cells, look
        As for `search`.
    """
    found = []
    for place in together(engine, cells):
        some = cells.take(place)
        parts = slabs_of(some)
        radius = some.radius[parts.owner]
        judged = engine.judge(parts, radius)
        good = _every(contracts(parts, judged, radius), parts.owner, len(some))
        found.append(Tubes(some, good, ~good, pieces(look, judged, parts, radius, len(some))))
    return Tubes.joined(found)
