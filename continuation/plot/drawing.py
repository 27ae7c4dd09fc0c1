"""Parts of every path picture: curve, marks, axes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.status import Kind

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
STYLES = ("-", "--", "-.", ":")
TURN = {"marker": "o", "markersize": 7, "markerfacecolor": "white", "markeredgecolor": "black", "linestyle": "none"}
"""Mark of turning points."""

KINK = {**TURN, "marker": "D", "markersize": 5.5}
"""Mark of kinks."""

MARKS = {
    Kind.TURNING_POINT: {},
    Kind.BRANCH_POINT: {"marker": "s", "markerfacecolor": "black", "markersize": 6},
    Kind.SINGULAR_POINT: {"marker": "s", "markersize": 6},
    Kind.KINK: {"marker": "D", "markersize": 5.5},
    Kind.HOPF: {"marker": "*", "markersize": 10, "markerfacecolor": "black"},
}
"""Marks by kind: circle, filled square, square, diamond, star."""

OTHER = {"marker": "D", "markersize": 5, "markerfacecolor": "0.6"}
"""Mark of other events, which show their name."""

SMOOTHNESS = 12
"""Curve points per step ..."""

SAMPLES = 600
"""... but at most this many: long paths look smooth without."""

MOST_COMPONENTS = 12
"""Most curves that a reader can tell apart."""

Axes = Any

Drawn: TypeAlias = Any
"""A `continuation.Path`."""


@frozen(eq=False)
class Drawing:
    """Dense output if stored, else cubics through points."""

    s: Array
    u: Array

    @classmethod
    def of(cls, path: Drawn) -> Drawing:
        """Sample the curve."""
        if len(path) < 2:
            return cls(path.arclength, path.u)
        if all(step.segment is not None for step in path.steps[1:]):
            return cls._along(path.steps)
        return cls._through(path)

    @classmethod
    def _along(cls, steps: Sequence[Any]) -> Drawing:
        """Sample segments, with arclength by chords, whose error no picture shows.

        `Path.__call__` integrates instead: 0.5 s of the demo's 4 s.
        """
        inner = np.linspace(0.0, 1.0, _count(len(steps)), endpoint=False)[1:]
        s, u = [], []
        for before, after in pairwise(steps):
            assert after.segment is not None
            # The previous step may have other unknowns (`continuation.renewal`).
            points = np.array([after.segment.at(0.0), *map(after.segment.at, inner), after.u])
            weights = np.ones(points.shape[1]) if after.weights is None else after.weights
            chords = np.sqrt(np.diff(points, axis=0) ** 2 @ weights)
            behind = np.append(0.0, np.cumsum(chords[:-1])) / max(chords.sum(), np.finfo(float).tiny)
            s.append(before.arclength + (after.arclength - before.arclength) * behind)
            u.append(points[:-1])
        return cls(np.append(np.concatenate(s), steps[-1].arclength), np.vstack([*u, steps[-1].u]))

    @classmethod
    def _through(cls, path: Drawn) -> Drawing:
        points = [(s.arclength, *s.u) for s in path.steps] + [(t.arclength, *t.u) for t in path.turning_points]
        s, u = (part for part in np.split(np.array(points), [1], axis=1))
        knots = path.arclength
        inner = np.linspace(0.0, 1.0, _count(len(knots)), endpoint=False)
        fine = np.append((knots[:-1, None] + np.diff(knots)[:, None] * inner).ravel(), knots[-1])
        fine = np.unique(np.append(fine, s))
        drawn = np.full((fine.size, u.shape[1]), np.nan)
        known = np.isfinite(u).all(axis=0)
        drawn[:, known] = interpolated(s[:, 0], u[:, known], fine)
        return cls(fine, drawn)


def interpolated(s: Array, values: Array, wanted: Array) -> Array:
    """Interpolate by monotone cubics, which add no extrema; `s` in any order, the first of equal ones counts."""
    from scipy.interpolate import PchipInterpolator

    order = np.argsort(s, kind="stable")
    order = order[np.append(True, np.diff(s[order]) > 1e-9 * s.max())]
    if order.size < 2:
        return np.broadcast_to(values[order[0]], (wanted.size, *values.shape[1:]))
    return np.asarray(PchipInterpolator(s[order], values[order])(wanted))


def _count(points: int) -> int:
    """Drawn points per step."""
    return int(np.clip(SAMPLES // (points - 1), 1, SMOOTHNESS))


def require_matplotlib() -> None:
    """Raise ImportError with advice unless matplotlib imports."""
    try:
        import matplotlib.pyplot  # noqa: F401
    except ImportError as error:
        raise ImportError("pictures need matplotlib: pip install 'pseudoarclength[plot]'") from error


AGAINST = ("lam", "arclength")


def check_path(path: Drawn) -> None:
    """Raise ValueError for an empty path."""
    if len(path) == 0:
        raise ValueError("path: expected at least one point, found none")


def chosen_components(components: Iterable[int] | None, y: Array) -> list[int]:
    """Requested components, or twelve evenly spaced."""
    n = y.shape[1]
    if components is None:
        # Archives fill shorter paths with NaN.
        filled = np.flatnonzero(np.isfinite(y).any(axis=0))
        if len(filled) > MOST_COMPONENTS:
            filled = filled[np.linspace(0, len(filled) - 1, MOST_COMPONENTS).round().astype(int)]
        return [int(i) for i in filled]
    chosen = list(components)
    outside = [i for i in chosen if not 0 <= i < n]
    if outside:
        raise ValueError(f"components: expected numbers from 0 to {n - 1}, found {outside[0]}")
    return chosen


def height(y: Array) -> Array:
    """Maximum norm on the last axis, ignoring NaN."""
    largest: Array = np.fmax.reduce(np.abs(y), axis=-1)
    return largest


def axes_or_new(axes: Axes | None) -> Axes:
    """The axes, or new ones."""
    if axes is not None:
        return axes
    require_matplotlib()
    from matplotlib import pyplot

    return pyplot.subplots(layout="constrained")[1]


def line_style(k: int) -> dict[str, Any]:
    """Colour and dashes of line k."""
    return {"color": COLOURS[k % len(COLOURS)], "linestyle": STYLES[k % len(STYLES)], "linewidth": 1.6}


def tidy(axes: Axes) -> Axes:
    """Remove the frame, narrow the margins."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(x=0.03)
    return axes


def across(against: str, drawing: Drawing) -> Array:
    """Horizontal coordinates of a drawing."""
    if against not in AGAINST:
        raise ValueError(f"against: expected 'lam' or 'arclength', found {against!r}")
    values: Array = drawing.u[:, -1] if against == "lam" else drawing.s
    return values


def label_axis(axes: Axes, against: str, paths: Sequence[Drawn]) -> None:
    """Label the horizontal axis; invert it for falling parameters."""
    if against == "arclength":
        axes.set_xlabel("arclength $s$")
        return
    axes.set_xlabel(paths[0].labels.parameter(r"$\lambda$"))
    falling = [len(path) > 1 and (np.diff(path.lam) <= 0.0).all() and path.lam[-1] < path.lam[0] for path in paths]
    if all(falling) and not axes.xaxis_inverted():
        axes.invert_xaxis()


def sign(event: Any) -> dict[str, Any]:
    """Mark of an event."""
    return {**TURN, **MARKS.get(event.kind, OTHER)}


def called(event: Any) -> str:
    """An event's kind, or its own name if that says more."""
    known = event.kind in MARKS and event.kind is not Kind.HOPF
    return str(event.kind.flag.replace("_", " ") if known else event.name)


def name_events(axes: Axes, places: Sequence[tuple[Any, float, Any]]) -> None:
    """Name the first event of each name, with their number."""
    names = [called(event) for event, _, _ in places]
    for name in dict.fromkeys(names):
        _, x, y = places[names.index(name)]
        text = f"{name} ({names.count(name)})" if names.count(name) > 1 else name
        # Towards the middle of the panel.
        right, up = (axes.transData + axes.transAxes.inverted()).transform((x, np.max(y)))
        looks = {"fontsize": "x-small", "ha": "left" if right < 0.6 else "right", "va": "bottom" if up < 0.9 else "top"}
        offset = (6 if right < 0.6 else -6, 4 if up < 0.9 else -4)
        behind = {"facecolor": "white", "edgecolor": "none", "pad": 0.5, "alpha": 0.7}
        axes.annotate(text, (x, np.max(y)), offset, textcoords="offset points", zorder=4, bbox=behind, **looks)


def arrow(axes: Axes, x: Array, y: Array, colour: str) -> None:
    """Draw an arrow head two fifths along a line's moving points."""
    moves = np.flatnonzero(np.isfinite(y[1:]) & np.isfinite(y[:-1]) & ((np.diff(x) != 0.0) | (np.diff(y) != 0.0)))
    if moves.size:
        k = moves[2 * moves.size // 5]
        head = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 11.0}
        axes.annotate("", (x[k + 1], y[k + 1]), (x[k], y[k]), arrowprops=head)


def mark_events(axes: Axes, places: Sequence[tuple[Any, float, Any]]) -> None:
    """Mark events, each name once in the legend."""
    named = set(axes.get_legend_handles_labels()[1])
    for event, x, y in places:
        heights, name = np.atleast_1d(y), called(event)
        axes.plot([x] * heights.size, heights, zorder=3, label="_" if name in named else name, **sign(event))
        named.add(name)
