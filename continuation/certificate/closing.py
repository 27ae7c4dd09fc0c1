"""What is proved of the end of a path: a point of the curve, an exact solution, or nothing of the limit of a series."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Cells
from continuation.certificate.links import Nodes, reach
from continuation.certificate.proof import Gap
from continuation.numbers.ends import Ends
from continuation.path import Path
from continuation.status import Status

NO_CURVE = "no point of the curve was found at the end"
LIMIT = "the end is the limit of a series, of which nothing is proved"

NEAR_END = 1e-5
"""How far the parameter may be from its target, of its way there, where an exact end takes the place of the rest."""


@runtime_checkable
class SupportsEndCertificate(Protocol):
    """A homotopy whose ends can be proved to be solutions by other means than the path."""

    def certify_end(self, y: Array) -> str:
        """What is proved of the end, as a sentence; empty where nothing is.

        Parameters
        ----------
        y : ndarray, shape (N,)

        Returns
        -------
        str
        """
        ...


def certificate_of(cells: Cells, at: Nodes, path: Path, homotopy: Any) -> str:
    """What is said of an end that the tubes do not reach, or not at the target, where the homotopy can prove it."""
    last, end = float(cells.end[-1, -1]), path.steps[-1]
    if path.status is not Status.REACHED_TARGET or not isinstance(homotopy, SupportsEndCertificate):
        return ""
    if not at.proved[-1]:
        return ""
    if not abs(last - end.lam) <= NEAR_END * abs(path.steps[0].lam - end.lam):
        return ""
    sentence = homotopy.certify_end(end.y)
    return f"Proved to lam = {last:.1e}. {sentence}" if sentence else ""


def series_of(cells: Cells, at: Nodes, path: Path) -> str:
    """What is said of tubes up to next to an end to which no step leads, but a series."""
    last, end = float(cells.end[-1, -1]), path.steps[-1]
    made = end.index > 0 and end.segment is None and end.corrector_iterations == 0
    near = 0.0 < abs(last - end.lam) <= NEAR_END * abs(path.steps[0].lam - end.lam)
    if path.status is not Status.REACHED_TARGET or not at.proved[-1] or not made or not near:
        return ""
    return f"Proved to lam = {last:.1e}; from there a series leads to the end, which is not proved."


def at_target(cells: Cells, ends: Nodes, path: Path) -> bool:
    """Whether the last tube has a point of the curve exactly at the parameter of the end of a path to its target."""
    if path.status is not Status.REACHED_TARGET:
        return False
    last, there = cells.take(slice(-1, None)), ends.take(slice(1, 2))
    whole = last.place[0, 1] == path.arclength[-1] and bool((last.end[0] == path.steps[-1].u).all())
    held = reach(last, np.ones(1), Ends(-there.radius, there.radius)) <= last.radius
    return bool(whole and there.proved.all() and held.all())


def at_end(at: Nodes, ends: Nodes, path: Path, there: bool) -> tuple[str, Array | None, list[Gap]]:
    """What is proved of the end: where the path reached its target, a point of the curve exactly `there`, or not."""
    s = float(path.arclength[-1])
    if path.status is not Status.REACHED_TARGET:
        found = bool(at.proved[-1])
        return ("The end is a point of the curve.", None, []) if found else ("", None, [Gap(s, s, NO_CURVE)])
    if there:
        return f"The end lies on it, exactly at lam = {path.steps[-1].lam:g}.", ends.radius[1], []
    return "", None, [Gap(s, s, "no point of the curve was found at the target")]
