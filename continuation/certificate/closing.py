"""Proofs of a path's end."""

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
"""Distance from a singular end up to which a path is proved, relative to the parameter's way."""

NO_CURVE = "no point of the curve was found at the end"
LIMIT = "the end is the limit of a series, of which nothing is proved"


@runtime_checkable
class SupportsEndCertificate(Protocol):
    """A homotopy that proves its ends in another way."""

    def certify_end(self, y: Array) -> str:
        """A sentence on the end y, shape (N,), if it is proved; else empty."""
        ...


def ending(cells: Cells, at: Nodes, ends: Nodes, path: Path, homotopy: Any) -> tuple[str, Array | None, str]:
    """The proved sentence on the end, the curve's distance from it, and the missing condition."""
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
    """Whether an end was found without a step, so has a chord as tangent."""
    return step.index > 0 and step.segment is None and step.corrector_iterations == 0
