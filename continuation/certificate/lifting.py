"""Paths with further unknowns, with which the residual is plain arithmetic."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

import numpy as np
from attrs import evolve

from continuation.arrays import Array
from continuation.certificate.cells import Cells
from continuation.certificate.proof import Gap, Proof
from continuation.path import Path, Step


@runtime_checkable
class SupportsWrittenOut(Protocol):
    """A homotopy that eliminates unknowns by factorisations."""

    def written_out(self, points: Array) -> Any:
        """The homotopy with all unknowns, or None.

        Its `lifted(u, before)` puts the further unknowns in front of u, near those of `before`.

        Parameters
        ----------
        points : ndarray, shape (m, N + 1)
            Points of the path.
        """
        ...


def lifted(homotopy: Any, path: Path, cells: Cells | None = None) -> tuple[Any, Path] | Proof:
    """The homotopy and path to prove, perhaps with further unknowns, or an empty proof with a reason.

    Nodes of `cells` give those of the points that they share.
    """
    points = path.u
    width, ends = points.shape[1], (float(path.arclength[0]), float(path.arclength[-1]))
    try:
        whole = homotopy.written_out(points) if isinstance(homotopy, SupportsWrittenOut) else None
        longer = path if whole is None else _lifted(whole, path, cells)
    except ArithmeticError as error:
        return Proof.empty(width, Gap(*ends, f"the equations cannot be written out there ({error})"))
    needed = longer.steps[0].u.size
    if cells is not None and cells.begin.shape[1] != needed:
        return Proof.empty(width, Gap(*ends, f"tubes have {cells.begin.shape[1]} components, not {needed}"))
    return homotopy if whole is None else whole, longer


def _lifted(whole: Any, path: Path, cells: Cells | None) -> Path:
    rows = () if cells is None else (*cells.begin, *cells.end)
    known = {row[-path.steps[0].u.size :].tobytes(): row for row in rows}
    steps: list[Step] = []
    before = None
    for step in path.steps:
        found = known.get(step.u.tobytes())
        before = whole.lifted(step.u, before) if found is None else found
        steps.append(evolve(step, u=before, tangent=np.full_like(before, np.nan), weights=None))
    events = []
    for event in path.events:
        u = whole.lifted(event.u, steps[min(event.step, len(steps) - 1)].u)
        events.append(evolve(event, u=u, tangent=np.full_like(u, np.nan)))
    return evolve(path, steps=steps, events=events)
