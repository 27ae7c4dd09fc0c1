"""What is proved of the end of a path: a point of the curve, an exact solution, or nothing of the limit of a series."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import numpy as np

from continuation.arrays import Array
from continuation.certificate.cells import Cells
from continuation.certificate.links import Nodes, reach
from continuation.numbers.ends import Ends
from continuation.path import Path, Step
from continuation.status import Status

NEXT_TO_END = 1e-6
"""Where a path has a singular end, in lengths of the parameter's way there, it is proved up to there."""

NO_CURVE = "no point of the curve was found at the end"
LIMIT = "the end is the limit of a series, of which nothing is proved"


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


def ending(cells: Cells, at: Nodes, ends: Nodes, path: Path, homotopy: Any) -> tuple[str, Array | None, str]:
    """What is proved of the end, how far the curve there is from the stored one, and what is missing.

    Tubes that end next to the target of a path, where it was reached otherwise than by a step, are followed by what the
    homotopy can prove of the end, or by a series.
    """
    end, last = path.steps[-1], float(cells.end[-1, -1])
    if path.status is not Status.REACHED_TARGET:
        return ("The end is a point of the curve.", None, "") if at.proved[-1] else ("", None, NO_CURVE)
    tube, there = cells.take(slice(-1, None)), ends.take(slice(1, 2))
    whole = tube.place[0, 1] == path.arclength[-1] and bool((tube.end[0] == end.u).all())
    held = reach(tube, np.ones(1), Ends(-there.radius, there.radius)) <= tube.radius
    if whole and there.proved.all() and held.all():
        return f"The end lies on it, exactly at lam = {end.lam:g}.", there.radius[0], ""
    off = abs(last - end.lam)
    if at.proved[-1] and off <= 2.0 * NEXT_TO_END * abs(path.steps[0].lam - end.lam):
        proved = f"Proved to lam = {last:.1e}"
        if isinstance(homotopy, SupportsEndCertificate) and (sentence := homotopy.certify_end(end.y)):
            return f"{proved}. {sentence}", None, ""
        if off and made(end):
            return f"{proved}; from there a series leads to the end, which is not proved.", None, LIMIT
    return "", None, "no point of the curve was found at the target"


def made(step: Step) -> bool:
    """Whether a point was not stepped to, but is an end that was found otherwise: its tangent is a chord."""
    return step.index > 0 and step.segment is None and step.corrector_iterations == 0
