"""Which parts of a line are solid and which dashed: the stable ones, and the others."""

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
"""The scalar that `continuation.Stability` stores: how many eigenvalues are unstable."""

CHANGES = (Kind.TURNING_POINT, Kind.BRANCH_POINT, Kind.SINGULAR_POINT, Kind.HOPF, Kind.KINK)
"""Where stability may change."""


@frozen
class Stretch:
    """A part of a line between two arclengths, to be drawn solid or dashed."""

    begin: float
    end: float
    solid: bool


def stretches(s: Array, edges: Array, first: bool) -> list[Stretch]:
    """Solid and dashed in turn, changing at some arclengths of a line; `first` says whether it begins solid."""
    bounds = [float(s[0]), *map(float, edges), float(s[-1])]
    return [Stretch(a, b, first != bool(k % 2)) for k, (a, b) in enumerate(pairwise(bounds))]


def by_stability(path: Drawn, s: Array) -> list[Stretch] | None:
    """Where the path is stable, by what was stored with its points; None where nothing was.

    Between two points that differ it changes at the first of the events between them that can be the reason, else at
    the first of any other kind, as a period doubling of cycles is, else half way. The arclengths s are those of the
    line to draw.
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
    """A line of points at arclengths s, whole or in parts that are solid and dashed."""
    if parts is None or len(x) == 1:
        axes.plot(x, y, label=label, marker="." if len(x) == 1 else "", **looks)
        return
    for k, part in enumerate(parts):
        # Dashes mean one thing in a picture: with stability they are not for telling lines apart.
        style = {**looks, "linestyle": "-" if part.solid else "--"}
        places = np.concatenate(([part.begin], s[(s > part.begin) & (s < part.end)], [part.end]))
        axes.plot(np.interp(places, s, x), np.interp(places, s, y), label=label if k == 0 else "_", **style)
