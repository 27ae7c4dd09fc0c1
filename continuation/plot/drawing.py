"""Parts of pictures of paths: curves, events, arrows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from attrs import frozen

from continuation.arguments.checks import expect
from continuation.arrays import Array
from continuation.status import Kind

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
STYLES = ("-", "--", "-.", ":")
TURN: dict[str, Any] = {
    "marker": "o", "markersize": 6, "markerfacecolor": "white", "markeredgecolor": "black", "linestyle": "none",
}  # fmt: skip

KINK: dict[str, Any] = {**TURN, "marker": "D", "markersize": 5}

MARKS: dict[Kind, dict[str, Any]] = {
    Kind.TURNING_POINT: TURN,
    Kind.BRANCH_POINT: {**TURN, "marker": "s", "markerfacecolor": "black"},
    Kind.SINGULAR_POINT: {**TURN, "marker": "s"},
    Kind.KINK: KINK,
    Kind.HOPF: {**TURN, "marker": "*", "markersize": 10, "markerfacecolor": "black"},
}
"""Marks by kind."""

OTHER: dict[str, Any] = {**KINK, "markerfacecolor": "0.6"}

SMOOTHNESS = 12
"""Curve points per step ..."""

SAMPLES = 600
"""... but at most this many: long paths look smooth without."""

MOST_COMPONENTS = len(COLOURS)
"""Most curves that a reader can tell apart."""

UNSTABLE = "unstable"
"""Number of unstable eigenvalues, stored by `continuation.Stability`."""

Axes = Any

Drawn: TypeAlias = Any
StableParts: TypeAlias = tuple[Sequence[float], bool] | None
"""Arclengths where stability changes, and whether the first part is stable."""


@frozen(eq=False)
class Drawing:
    """One number along a path.

    `s`, `u`: points of the curve. `y`, `at`: the number at points and at events. `k`: of colours and dashes.
    """

    path: Drawn
    s: Array
    u: Array
    y: Array
    at: Sequence[float]
    label: str
    k: int
    parts: StableParts


def sampled(path: Drawn) -> tuple[Array, Array]:
    """Arclengths and points of the curve, from dense output or cubics."""
    knots, steps = path.arclength, path.steps
    if len(steps) < 2:
        return knots, path.u
    inner = np.linspace(0.0, 1.0, int(np.clip(SAMPLES // (len(steps) - 1), 1, SMOOTHNESS)), endpoint=False)
    fine = np.append((knots[:-1, None] + np.diff(knots)[:, None] * inner).ravel(), knots[-1])
    if all(step.segment is not None for step in steps[1:]):
        return fine, path(fine)
    fine = np.union1d(fine, [event.arclength for event in path.turning_points])
    return fine, known_along(path, lambda point: point.u, fine)


def known_along(path: Drawn, number: Any, wanted: Array) -> Array:
    """`number(point)` at the arclengths `wanted`: known at points and events, by monotone cubics between."""
    from scipy.interpolate import PchipInterpolator

    points = sorted([*path.events, *path.steps], key=lambda point: point.arclength)
    s, values = np.array([point.arclength for point in points]), np.array([number(point) for point in points])
    apart = np.append(True, np.diff(s) > 1e-9 * s[-1])
    if apart.sum() < 2:
        return np.repeat(values[:1], wanted.size, axis=0)
    s, values = s[apart], values[apart]
    k = np.clip(np.searchsorted(s, wanted), 1, s.size - 1)
    # Archives fill shorter paths with NaN, and a number may be known on part of a path.
    known = np.isfinite(values[k - 1]) & np.isfinite(values[k])
    return np.where(known, PchipInterpolator(s, np.where(np.isfinite(values), values, 0.0))(wanted), np.nan)


def stable_parts(path: Drawn) -> StableParts:
    """`StableParts`, or None if stability is not stored.

    Stability changes at the first event between two points, those of `Kind.EVENT` last, else half way.
    """
    if not path.steps or UNSTABLE not in path.steps[0].observed:
        return None
    stable = np.array([step.observed[UNSTABLE] == 0.0 for step in path.steps])
    edges = []
    for k in np.flatnonzero(stable[1:] != stable[:-1]):
        a, b = path.arclength[k], path.arclength[k + 1]
        inside = [(event.kind is Kind.EVENT, event.arclength) for event in path.events if a <= event.arclength <= b]
        edges.append(min(inside, default=(False, 0.5 * (a + b)))[1])
    return edges, bool(stable[0])


def draw(axes: Axes | None, paths: Sequence[Sequence[Drawing]], against: str, legend: bool) -> Axes:
    """Draw curves, one or more of each path, with events; with `legend` also names and arrows."""
    expect(against in ("lam", "arclength"), "against", "'lam' or 'arclength'", against)
    axes = axes_or_new(axes)
    lam, curves = against == "lam", [curve for mine in paths for curve in mine]
    for curve in curves:
        x, knots = curve.u[:, -1] if lam else curve.s, curve.s
        looks = line_style(curve.k)
        edges, solid = curve.parts or ((), True)
        for k, (a, b) in enumerate(pairwise([knots[0], *edges, knots[-1]])):
            s = np.unique(np.concatenate(([a, b], knots[(knots > a) & (knots < b)])))
            dashes = {} if curve.parts is None else {"linestyle": "-" if solid != bool(k % 2) else "--"}
            alone = {"marker": "." if knots.size == 1 else "", "label": "_" if k else curve.label}
            axes.plot(np.interp(s, knots, x), np.interp(s, knots, curve.y), **{**looks, **dashes, **alone})
        if legend:
            _arrow(axes, x, curve.y, looks["color"])
    label_axis(axes, against, [curve.path for curve in curves])
    tidy(axes)
    # Fix the limits, which names need.
    axes.get_xlim()
    _mark(axes, paths, lam, legend)
    if legend and any(curve.parts for curve in curves):
        axes.set_title("solid: stable, dashed: not", fontsize="x-small", color="0.4", loc="right")
    if legend and len(axes.get_legend_handles_labels()[1]) > 1:
        axes.legend(frameon=False, fontsize="small")
    return axes


def _mark(axes: Axes, paths: Sequence[Sequence[Drawing]], lam: bool, named: bool) -> None:
    from matplotlib.lines import Line2D

    said = set()
    for mine in paths:
        path = mine[0].path
        for k, event in enumerate(path.events):
            x, heights = event.lam if lam else event.arclength, [float(curve.at[k]) for curve in mine]
            # Round-off of events must not set the scale, as by `plot`.
            axes.add_artist(Line2D([x] * len(mine), heights, zorder=3, **MARKS.get(event.kind, OTHER)))
            if named and event.name not in said:
                _say(axes, event.name, x, max(heights))
            said.add(event.name)


def _say(axes: Axes, text: str, x: float, y: float) -> None:
    """Write beside a point, towards the middle of the panel."""
    text = "".join(c if c.isprintable() else "?" for c in text)
    right, up = (axes.transData + axes.transAxes.inverted()).transform((x, y))
    side, above = right < 0.6, up < 0.9
    looks = {"ha": "left" if side else "right", "va": "bottom" if above else "top", "fontsize": "x-small", "zorder": 4}
    place = (6 if side else -6, 4 if above else -4)
    axes.annotate(text, (x, y), place, textcoords="offset points", parse_math=False, **looks)


def _arrow(axes: Axes, x: Array, y: Array, colour: str) -> None:
    moves = np.flatnonzero(np.isfinite(y[1:]) & np.isfinite(y[:-1]) & ((np.diff(x) != 0.0) | (np.diff(y) != 0.0)))
    if moves.size:
        k = moves[2 * moves.size // 5]
        head = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 13.0}
        axes.annotate("", (x[k + 1], y[k + 1]), (x[k], y[k]), arrowprops=head)


def require_matplotlib() -> None:
    """Raise ImportError without matplotlib."""
    try:
        import matplotlib.pyplot  # noqa: F401
    except ImportError as error:
        raise ImportError("pictures need matplotlib: pip install 'pseudoarclength[plot]'") from error


def check_path(path: Drawn) -> None:
    """Raise ValueError for an empty path."""
    expect(len(path), "path", "at least one point", path)


def chosen_components(components: Iterable[int] | None, y: Array) -> list[int]:
    """Requested components, or some evenly spaced."""
    n = y.shape[1]
    if components is None:
        filled = np.flatnonzero(np.isfinite(y).any(axis=0))
        spaced = np.linspace(0, len(filled) - 1, min(len(filled), MOST_COMPONENTS)).round().astype(int)
        return [int(i) for i in filled[spaced]]
    chosen = list(components)
    expect(chosen and all(0 <= i < n for i in chosen), "components", f"numbers from 0 to {n - 1}", chosen)
    return chosen


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


def label_axis(axes: Axes, against: str, paths: Sequence[Drawn]) -> None:
    """Label the horizontal axis; invert it for falling parameters."""
    if against == "arclength":
        axes.set_xlabel("arclength $s$")
        return
    axes.set_xlabel(paths[0].labels.parameter(r"$\lambda$"))
    falling = [len(path) > 1 and (np.diff(path.lam) <= 0.0).all() and path.lam[-1] < path.lam[0] for path in paths]
    if all(falling) and not axes.xaxis_inverted():
        axes.invert_xaxis()
