"""Solid (stable) and dashed parts of a line."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.plot.drawing import Axes, Drawn
from continuation.status import Kind

UNSTABLE = "unstable"
"""Number of unstable eigenvalues, stored by `continuation.Stability`."""

CHANGES = (Kind.TURNING_POINT, Kind.BRANCH_POINT, Kind.SINGULAR_POINT, Kind.HOPF, Kind.KINK)
"""Events where stability may change."""


@frozen
class Stretch:
    """A solid or dashed part between two arclengths."""

    begin: float
    end: float
    solid: bool


def stretches(s: Array, edges: Array, first: bool) -> list[Stretch]:
    """Alternate solid and dashed at the arclengths `edges`."""
    bounds = [float(s[0]), *map(float, edges), float(s[-1])]
    return [Stretch(a, b, first != bool(k % 2)) for k, (a, b) in enumerate(pairwise(bounds))]


def by_stability(path: Drawn, s: Array) -> list[Stretch] | None:
    """Solid parts of a line at arclengths s from stored stability, or None.

    Stability changes at the first event of `CHANGES` between two points, else at another event (period doubling), else
    half way.
    """
    if not path.steps or UNSTABLE not in path.steps[0].observed:
        return None
    knots = path.arclength
    stable = np.array([step.observed[UNSTABLE] == 0.0 for step in path.steps])
    reasons, others = (
        np.array([event.arclength for event in path.events if (event.kind in CHANGES) is able])
        for able in (True, False)
    )
    edges = []
    for k in np.flatnonzero(stable[1:] != stable[:-1]):
        inside = (known[(known >= knots[k]) & (known <= knots[k + 1])] for known in (reasons, others))
        edges.append(next((found[0] for found in inside if found.size), 0.5 * (knots[k] + knots[k + 1])))
    return stretches(s, np.array(edges), bool(stable[0]))


def draw_line(
    axes: Axes, x: Array, y: Array, label: str, looks: dict[str, Any], s: Array, parts: Sequence[Stretch] | None
) -> None:
    """Draw a line whole, or in solid and dashed parts."""
    if parts is None or len(x) == 1:
        axes.plot(x, y, label=label, marker="." if len(x) == 1 else "", **looks)
        return
    for k, part in enumerate(parts):
        # With stability, dashes do not distinguish lines.
        style = {**looks, "linestyle": "-" if part.solid else "--"}
        places = np.concatenate(([part.begin], s[(s > part.begin) & (s < part.end)], [part.end]))
        axes.plot(np.interp(places, s, x), np.interp(places, s, y), label=label if k == 0 else "_", **style)
