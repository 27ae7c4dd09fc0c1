"""Pictures of a path with matplotlib, which is imported only when one is drawn.

Colours are Okabe and Ito's, which colour-blind readers tell apart; line styles repeat the distinction.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array
from continuation.path import LocatedEvent, Path, Step

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")
STYLES = ("-", "--", "-.", ":")
TURN = {"marker": "o", "markersize": 7, "markerfacecolor": "white", "markeredgecolor": "black", "linestyle": "none"}
"""How a turning point is marked, above every line."""

KINK = {**TURN, "marker": "D", "markersize": 5.5}
"""How a kink is marked."""

SMOOTHNESS = 12
"""Points of the curve for every step, ..."""

SAMPLES = 600
"""... but no more than this in all: a path of many steps is smooth without."""

MOST_COMPONENTS = 12
"""More curves than this cannot be told apart in one picture."""

Axes = Any


@frozen(eq=False)
class Drawing:
    """A curve as lines to draw: dense output where there is some, else cubics through the stored points."""

    s: Array
    u: Array

    @classmethod
    def of(cls, path: Path) -> Drawing:
        """Sample the curve, between its points too."""
        if len(path) < 2:
            return cls(path.arclength, path.u)
        if all(step.segment is not None for step in path.steps[1:]):
            return cls._along(path.steps)
        return cls._through(*_with_turns(path.arclength, path.u, path.turning_points))

    @classmethod
    def _along(cls, steps: Sequence[Step]) -> Drawing:
        """By the segments' own parameter; arclength within a segment by chords, which no picture shows to be wrong.

        The path at given arclengths (`Path.__call__`) integrates its speed for each: 0.5 s of the 4 s of the demo.
        """
        inner = np.linspace(0.0, 1.0, _count(len(steps)), endpoint=False)[1:]
        s, u = [], []
        for before, after in pairwise(steps):
            assert after.segment is not None
            points = np.array([before.u, *map(after.segment.at, inner), after.u])
            weights = np.ones(points.shape[1]) if after.weights is None else after.weights
            chords = np.sqrt(np.diff(points, axis=0) ** 2 @ weights)
            behind = np.append(0.0, np.cumsum(chords[:-1])) / max(chords.sum(), np.finfo(float).tiny)
            s.append(before.arclength + (after.arclength - before.arclength) * behind)
            u.append(points[:-1])
        return cls(np.append(np.concatenate(s), steps[-1].arclength), np.vstack([*u, steps[-1].u]))

    @classmethod
    def _through(cls, s: Array, u: Array) -> Drawing:
        """Through points without tangents, by monotone cubics: they have no extremum that the points have not."""
        from scipy.interpolate import PchipInterpolator

        fine = _between(s)
        drawn = np.full((fine.size, u.shape[1]), np.nan)
        known = np.isfinite(u).all(axis=0)
        drawn[:, known] = PchipInterpolator(s, u[:, known])(fine)
        return cls(fine, drawn)


def _count(points: int) -> int:
    """How many points to draw for a step of a path of so many points."""
    return int(np.clip(SAMPLES // (points - 1), 1, SMOOTHNESS))


def _between(knots: Array) -> Array:
    """The knots, and places between them."""
    pieces = [np.linspace(a, b, _count(len(knots)), endpoint=False) for a, b in pairwise(knots)]
    return np.append(np.concatenate(pieces), knots[-1])


def _with_turns(s: Array, u: Array, turns: Sequence[LocatedEvent]) -> tuple[Array, Array]:
    """The points with the located turning points among them; of points in one place, the first."""
    located = [np.append(turn.y, turn.lam) for turn in turns]
    every = np.concatenate([s, [turn.arclength for turn in turns]])
    points = np.vstack([u, *located])
    order = np.argsort(every, kind="stable")
    every, points = every[order], points[order]
    apart = np.append(True, np.diff(every) > 1e-9 * every[-1])
    return every[apart], points[apart]


def plot_components(
    path: Path,
    axes: Axes | None = None,
    against: str = "lam",
    names: Sequence[str] | None = None,
    components: Iterable[int] | None = None,
    legend: bool = True,
) -> Axes:
    """Draw components of y against the parameter or the arclength, turning points and kinks marked.

    Parameters
    ----------
    path : Path
        Or a path of an archive.
    axes : matplotlib Axes, optional
        Drawn into; a new figure otherwise.
    against : {"lam", "arclength"}
    names : sequence of str, optional
        One a component drawn; ``y_0``, ``y_1``, ... by default, counted as in `y`.
    components : iterable of int, optional
        Which components; by default all of them, or twelve at even distances where there are more.
    legend : bool
        Whether to name the curves.

    Returns
    -------
    Axes

    Raises
    ------
    ImportError
        Without matplotlib.
    ValueError
        If `against` is neither, a component does not exist, the names are too few, or the path is empty.
    """
    _check(path)
    drawing = Drawing.of(path)
    chosen = _components(components, drawing.u[:, :-1])
    unknowns = int(np.isfinite(drawing.u[:, :-1]).any(axis=0).sum())
    labels = [f"$y_{{{i}}}$" for i in chosen] if names is None else list(names)
    if len(labels) != len(chosen):
        raise ValueError(f"names: expected {len(chosen)}, one a component drawn, found {len(labels)}")
    axes = _axes(axes)
    across = _across(against, drawing)
    for k, (i, label) in enumerate(zip(chosen, labels)):
        axes.plot(across, drawing.u[:, i], label=label, marker="." if len(across) == 1 else "", **_line(k))
    for event, mark in _marked(path):
        where = event.lam if against == "lam" else event.arclength
        axes.plot([where] * len(chosen), event.y[chosen], zorder=3, **mark)
    axes.set_xlabel(_LABELS[against])
    if len(chosen) == 1:
        axes.set_ylabel(labels[0])
    elif legend:
        some = f"{len(chosen)} of {unknowns} components" if components is None and len(chosen) < unknowns else None
        axes.legend(title=some, title_fontsize="small", fontsize="small", frameon=False, ncols=1 + len(chosen) // 5)
    return _tidy(axes)


def plot_bifurcation(path: Path, axes: Axes | None = None, component: int | None = None) -> Axes:
    """Draw one number of y (a component, or its largest absolute value) against the parameter: the usual diagram.

    Parameters
    ----------
    path : Path
    axes : matplotlib Axes, optional
    component : int, optional
        Of y; the maximum norm by default.

    Returns
    -------
    Axes

    Raises
    ------
    ImportError
        Without matplotlib.
    ValueError
        If the component does not exist or the path is empty.
    """
    _check(path)
    drawing = Drawing.of(path)
    i = None if component is None else _components([component], drawing.u[:, :-1])[0]
    if i is None:
        height = _height(drawing.u[:, :-1])
        label = r"$\max_i |y_i|$"
    else:
        height = drawing.u[:, i]
        label = f"$y_{{{i}}}$"
    axes = _axes(axes)
    axes.plot(drawing.u[:, -1], height, **_line(0))
    for event, mark in _marked(path):
        value = float(_height(event.y) if i is None else event.y[i])
        axes.plot([event.lam], [value], zorder=3, **mark)
    axes.set_xlabel(_LABELS["lam"])
    axes.set_ylabel(label)
    return _tidy(axes)


def plot_steps(path: Path, axes: Axes | None = None) -> Axes:
    """Draw how far apart the points are, on a logarithmic scale, against arclength: where the controller was careful.

    Parameters
    ----------
    path : Path
    axes : matplotlib Axes, optional

    Returns
    -------
    Axes

    Raises
    ------
    ImportError
        Without matplotlib.
    ValueError
        If the path is empty.
    """
    _check(path)
    axes = _axes(axes)
    s = path.arclength
    lengths = np.diff(s)
    # An event stored with the points may lie on one of them; a length of zero has no logarithm.
    axes.semilogy(s[1:][lengths > 0], lengths[lengths > 0], marker=".", markersize=4, linewidth=0.8, color=COLOURS[0])
    _label_decades(axes, lengths[lengths > 0])
    for event, _ in _marked(path):
        axes.axvline(event.arclength, color="0.6", linewidth=0.8, zorder=0)
    axes.set_xlabel(_LABELS["arclength"])
    axes.set_ylabel("step in $s$")
    return _tidy(axes)


def require_matplotlib() -> None:
    """Raise ImportError, with what to install, unless matplotlib can be imported."""
    try:
        import matplotlib.pyplot  # noqa: F401
    except ImportError as error:
        raise ImportError("pictures need matplotlib: pip install 'continuation[plot]'") from error


_LABELS = {"lam": r"$\lambda$", "arclength": "arclength $s$"}


def _marked(path: Path) -> list[tuple[LocatedEvent, dict[str, Any]]]:
    """The turning points and kinks, with their marks."""
    return [*((event, TURN) for event in path.turning_points), *((event, KINK) for event in path.kinks)]


def _check(path: Path) -> None:
    if len(path) == 0:
        raise ValueError("path: expected at least one point, found none")


def _across(against: str, drawing: Drawing) -> Array:
    if against not in _LABELS:
        raise ValueError(f"against: expected 'lam' or 'arclength', found {against!r}")
    across: Array = drawing.u[:, -1] if against == "lam" else drawing.s
    return across


def _components(components: Iterable[int] | None, y: Array) -> list[int]:
    n = y.shape[1]
    if components is None:
        # An archive of paths with different numbers of unknowns fills the shorter ones up with NaN.
        filled = np.flatnonzero(np.isfinite(y).any(axis=0))
        if len(filled) > MOST_COMPONENTS:
            filled = filled[np.linspace(0, len(filled) - 1, MOST_COMPONENTS).round().astype(int)]
        return [int(i) for i in filled]
    chosen = list(components)
    outside = [i for i in chosen if not 0 <= i < n]
    if outside:
        raise ValueError(f"components: expected numbers from 0 to {n - 1}, found {outside[0]}")
    return chosen


def _height(y: Array) -> Array:
    """The largest absolute value along the last axis, NaN apart."""
    height: Array = np.fmax.reduce(np.abs(y), axis=-1)
    return height


def _axes(axes: Axes | None) -> Axes:
    if axes is not None:
        return axes
    require_matplotlib()
    from matplotlib import pyplot

    return pyplot.subplots(layout="constrained")[1]


def _label_decades(axes: Axes, values: Array) -> None:
    """Ticks of a logarithmic axis: decades, or 1, 2 and 5 where decades would leave one label or two."""
    from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

    if values.size and values.max() < 100.0 * values.min():
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _line(k: int) -> dict[str, Any]:
    return {"color": COLOURS[k % len(COLOURS)], "linestyle": STYLES[k % len(STYLES)], "linewidth": 1.6}


def _tidy(axes: Axes) -> Axes:
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(x=0.03)
    return axes
