"""Proofs and their gaps."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.certificate.cells import COLUMNS, Cells


@frozen
class Gap:
    """A part of the path without a proof.

    Attributes
    ----------
    begin, end : float
        Arclengths.
    reason : str
    """

    begin: float
    end: float
    reason: str

    def __str__(self) -> str:
        return f"from s = {self.begin:.6g} to {self.end:.6g}: {self.reason}"


def merged(gaps: list[Gap]) -> tuple[Gap, ...]:
    """Gaps in order; touching gaps with one reason become one."""
    out: list[Gap] = []
    for gap in sorted(gaps, key=lambda gap: (gap.reason, gap.begin, gap.end)):
        if out and out[-1].reason == gap.reason and gap.begin <= out[-1].end:
            last = out.pop()
            out.append(Gap(last.begin, max(last.end, gap.end), gap.reason))
        else:
            out.append(gap)
    return tuple(sorted(out, key=lambda gap: (gap.begin, gap.end)))


@frozen(eq=False, repr=False)
class Proof:
    """A proof that a traced path is one curve, or the proved parts.

    If complete, the tubes hold one smooth curve of zeros of the residual, round-off included. It passes the boxes of
    all points in order, without branch points, and turns exactly where the path says. Other curves may exist outside.

    Attributes
    ----------
    cells : Cells
    node_radius : ndarray, shape (cells, N + 1)
        Largest distance of the curve from each cell's end.
    gaps : tuple of Gap
    turning_points : tuple of tuple of float
        Ranges of arclength with one turning point each.
    end : str
        What is known of the end.
    end_radius : ndarray or None
        Largest distance of the curve from the stored end, if proved exactly at the target.
    kinks : tuple of tuple of float
        Ranges of arclength with exactly one zero of a switch; there are no others.
    width : int
        N + 1 of the path; cells may have further unknowns in front.
    """

    cells: Cells
    node_radius: Array
    gaps: tuple[Gap, ...]
    turning_points: tuple[tuple[float, float], ...]
    end: str
    end_radius: Array | None = None
    kinks: tuple[tuple[float, float], ...] = ()
    width: int = 0

    @classmethod
    def empty(cls, width: int, *gaps: Gap) -> Proof:
        """A proof without cells.

        Parameters
        ----------
        width : int
            N + 1.
        *gaps : Gap
        """
        rows, none = np.zeros((0, width)), np.zeros(0, dtype=np.intp)
        cells = Cells(rows, rows, rows, rows, rows, rows, none, np.zeros((0, 2)))
        return cls(cells, rows, gaps, (), "")

    @property
    def complete(self) -> bool:
        """Whether the proof covers the whole path."""
        return not self.gaps

    @property
    def boxes(self) -> int:
        """Number of boxes, one for each slab."""
        return int(self.cells.slabs.sum())

    def __repr__(self) -> str:
        return f"<Proof: {self}>"

    def __str__(self) -> str:
        if self.complete:
            turns = len(self.turning_points)
            return f"Proved: one curve through all points, {turns} turning points, {self.boxes} boxes. {self.end}"
        return "Not proved " + "; ".join(map(str, self.gaps))

    @property
    def shadow(self) -> Cells:
        """Cells, reduced to the path's unknowns."""
        rows = {name: getattr(self.cells, name)[:, -self.width :] for name in COLUMNS if name not in ("slabs", "place")}
        return evolve(self.cells, **rows)

    def of_width(self, width: int) -> Proof:
        """The proof with `width` N + 1.

        Parameters
        ----------
        width : int
        """
        end = None if self.end_radius is None else self.end_radius[-width:]
        return evolve(self, node_radius=self.node_radius[:, -width:], end_radius=end, width=width)

    def radius(self, s: float) -> Array:
        """The tube's radius, shape (N + 1,); nan in a gap.

        Parameters
        ----------
        s : float
            Arclength.
        """
        place = self.cells.place
        inside = np.flatnonzero((place[:, 0] <= s) & (s <= place[:, 1]))
        if not len(inside):
            return np.full(self.shadow.radius.shape[1], np.nan)
        return np.asarray(self.shadow.radius[inside].max(axis=0))

    def plot(self, component: int = 0, axes: Any = None) -> Any:
        """Plot the tube and the gaps against the parameter.

        Parameters
        ----------
        component : int
            Size of y.
        axes : matplotlib axes, optional

        Returns
        -------
        matplotlib axes
        """
        from continuation.plot.along import plot_tube

        return plot_tube(self.shadow, [(gap.begin, gap.end) for gap in self.gaps], component, axes)
