"""Radii and slabs with which Krawczyk's test holds."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from continuation.arrays import EPS, Array, Mask
from continuation.certificate.cells import Cells, Index, Slabs, advance, cell_sizes, joined, slabs_of
from continuation.certificate.engine import Engine, Judged, together
from continuation.certificate.folds import Piece, SignsAlong, pieces
from continuation.certificate.links import INFLATION, NODE_ULPS, settled

LEAST_RADIUS = 1e-6
"""Least radius, in sizes of the cell: tubes as thin as round-off miss the neighbour's curve."""

FIRST_RADII = 0.05
"""First radii, in slab lengths; derivatives widen in proportion."""

CONTRACTING = 0.6
"""Bound of |I - Y G'| above which slabs are halved: it falls with their length."""


def contracts(slabs: Slabs, judged: Judged, radius: Array) -> Mask:
    """Whether the test holds, by slab; all proofs rest on this."""
    with np.errstate(all="ignore"):
        total = (judged.misfit + judged.spread(radius, radius)) * (1.0 + 4.0 * EPS)
        # Charts must advance: the cubic crosses each once.
        return np.asarray((total < radius).all(axis=1) & (advance(slabs) > 0.0))


@frozen(eq=False)
class Tubes:
    """Cells with test results.

    `pieces`: by cell and observed number.
    """

    cells: Cells
    proved: Mask
    pieces: list[list[list[Piece]]]

    @classmethod
    def joined(cls, parts: list[Tubes]) -> Tubes:
        """Concatenate."""
        return cls(
            joined([part.cells for part in parts]),
            np.concatenate([part.proved for part in parts]),
            [cell for part in parts for cell in part.pieces],
        )

    def take(self, index: Index) -> Tubes:
        """Select cells."""
        return Tubes(self.cells.take(index), self.proved[index], [self.pieces[k] for k in index])

    def numbers(self) -> list[list[Piece]]:
        """Pieces by observed number, in cells."""
        placed = [
            [[Piece(k + piece.lo, k + piece.hi, piece.sign, piece.bend) for piece in part] for part in parts]
            for k, parts in enumerate(self.pieces)
        ]
        return [[piece for part in parts for piece in part] for parts in zip(*placed)]


def search(engine: Engine, cells: Cells, look: SignsAlong) -> Tubes:
    """Find radii and slabs; `cells.radius` holds unit lengths."""
    return Tubes.joined([_search(engine, cells.take(place), look) for place in together(cells)])


def _search(engine: Engine, cells: Cells, look: SignsAlong) -> Tubes:
    count, scale = len(cells), cell_sizes(cells, cells.radius)
    least = LEAST_RADIUS * scale + NODE_ULPS * EPS * np.maximum(np.abs(cells.begin), np.abs(cells.end))
    slabs, radius = cells.slabs.copy(), np.maximum(FIRST_RADII * scale, least)
    proved = np.zeros(count, bool)
    known: list[list[list[Piece]]] = [[] for _ in range(count)]
    pending = np.arange(count)
    for _ in range(engine.most):
        tried = cells.take(pending).with_tubes(radius[pending], slabs[pending])
        parts = slabs_of(tried)
        judged = engine.judge(parts, tried.radius[parts.owner])
        # Interval bounds hold up to their radii only.
        bounded = np.full_like(tried.radius, np.inf) if engine.exact else tried.radius
        wanted, kappa, _ = settled(judged, parts.owner, least[pending], bounded)
        good = _every(contracts(parts, judged, wanted[parts.owner]), parts.owner, len(tried))
        if engine.exact and good.any():
            seen = pieces(look, judged, parts, wanted[parts.owner], len(tried))
            for k in np.flatnonzero(good):
                known[pending[k]] = seen[k]
        proved[pending] = good
        # Exact bounds would not change.
        wider = np.isfinite(wanted).all(axis=1) & (kappa < CONTRACTING) & (not engine.exact)
        slabs[pending] *= np.where(good | wider, 1, 2)
        first = np.maximum(FIRST_RADII * scale[pending] / slabs[pending][:, None], least[pending])
        kept = np.where(good[:, None], wanted, INFLATION * wanted)
        radius[pending] = np.where((good | wider)[:, None], kept, first)
        pending = pending[~good & (slabs[pending] <= engine.most)]
        if not len(pending):
            break
    cells = cells.with_tubes(radius, np.minimum(slabs, engine.most))
    if not engine.exact and proved.any():
        for k, found in zip(np.flatnonzero(proved), check(engine, cells.take(proved), look).pieces):
            known[k] = found
    return Tubes(cells, proved, known)


def _every(values: Mask, owner: Index, count: int) -> Mask:
    out = np.ones(count, bool)
    np.logical_and.at(out, owner, values)
    return out


def check(engine: Engine, cells: Cells, look: SignsAlong) -> Tubes:
    """Test cells with their own tubes."""
    found = []
    for place in together(cells):
        some = cells.take(place)
        parts = slabs_of(some)
        radius = some.radius[parts.owner]
        judged = engine.judge(parts, radius)
        good = _every(contracts(parts, judged, radius), parts.owner, len(some))
        found.append(Tubes(some, good, pieces(look, judged, parts, radius, len(some))))
    return Tubes.joined(found)
