"""Pictures of one path: components, profiles, heat map, steps."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from continuation.arrays import Array
from continuation.plot.drawing import (
    COLOURS,
    Axes,
    Drawing,
    Drawn,
    across,
    arrow,
    axes_or_new,
    check_path,
    chosen_components,
    label_axis,
    line_style,
    name_events,
    sign,
    tidy,
)
from continuation.plot.stretches import by_stability, draw_line

MOST_PROFILES = 6
"""Lines of a panel that a reader distinguishes at a glance."""


def plot_components(
    path: Drawn,
    axes: Axes | None = None,
    against: str = "lam",
    names: Sequence[str] | None = None,
    components: Iterable[int] | None = None,
    legend: bool = True,
) -> Axes:
    """Draw components of y against the parameter or arclength, with events.

    Arrows show the direction. If the path stored `continuation.Stability`, stable parts are solid, others dashed.

    Parameters
    ----------
    path : Path
        Also from an archive.
    axes : matplotlib Axes, optional
        Default: new figure.
    against : {"lam", "arclength"}
    names : sequence of str, optional
        One per component; default: the homotopy's, or ``y_0``, ``y_1``, ....
    components : iterable of int, optional
        Default: all, or twelve evenly spaced.
    legend : bool
        Whether to name curves and events and draw arrows.

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for invalid arguments or an empty path.
    """
    check_path(path)
    drawing = Drawing.of(path)
    chosen = chosen_components(components, drawing.u[:, :-1])
    unknowns = int(np.isfinite(drawing.u[:, :-1]).any(axis=0).sum())
    own = path.labels
    usual = [own.with_unit(own.unknown(i)) if own.unknown(i) else f"$y_{{{i}}}$" for i in chosen]
    labels = usual if names is None else list(names)
    if len(labels) != len(chosen):
        raise ValueError(f"names: expected {len(chosen)}, one a component drawn, found {len(labels)}")
    axes = axes_or_new(axes)
    horizontal = across(against, drawing)
    parts = by_stability(path, drawing.s)
    for k, (i, label) in enumerate(zip(chosen, labels)):
        draw_line(axes, horizontal, drawing.u[:, i], label, line_style(k), drawing.s, parts)
    places = [(event, event.lam if against == "lam" else event.arclength, event.y[chosen]) for event in path.events]
    for event, where, heights in places:
        axes.plot([where] * len(chosen), heights, zorder=3, **sign(event))
    label_axis(axes, against, [path])
    if legend:
        name_events(axes, places)
        for k, i in enumerate(chosen):
            arrow(axes, horizontal, drawing.u[:, i], line_style(k)["color"])
        if parts is not None:
            axes.set_title("solid: stable, dashed: not", fontsize="x-small", color="0.4", loc="right")
    if len(chosen) == 1:
        axes.set_ylabel(labels[0])
    elif legend:
        some = f"{len(chosen)} of {unknowns} components" if components is None and len(chosen) < unknowns else None
        axes.legend(title=some, title_fontsize="small", fontsize="small", frameon=False, ncols=1 + len(chosen) // 5)
    return tidy(axes)


def plot_profiles(path: Drawn, axes: Axes | None = None, profiles: int = MOST_PROFILES, x: Array | None = None) -> Axes:
    """Draw all unknowns over position at a few points of the path.

    Parameters
    ----------
    path : Path
    axes : matplotlib Axes, optional
    profiles : int, default 6
        Evenly spaced in arclength, ends included.
    x : array_like, shape (N,), optional
        Positions; default: numbers of the unknowns.

    Returns
    -------
    Axes

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for an empty path or wrong size of x.
    """
    check_path(path)
    places = _places(path, x)
    axes = axes_or_new(axes)
    ends = path.arclength[0], path.arclength[-1]
    for k, s in enumerate(np.linspace(*ends, min(profiles, MOST_PROFILES))):
        u = path(float(s))
        axes.plot(places, u[:-1], label=f"{u[-1]:.4g}", **line_style(k))
    axes.legend(title=path.labels.parameter(r"$\lambda$"), frameon=False, fontsize="small")
    axes.set_xlabel("number of the unknown" if x is None else "$x$")
    return tidy(axes)


def plot_heat(path: Drawn, axes: Axes | None = None, x: Array | None = None) -> Axes:
    """Draw all unknowns as a heat map over arclength.

    Parameters
    ----------
    path : Path
    axes : matplotlib Axes, optional
    x : array_like, shape (N,), optional
        Positions; default: numbers of the unknowns.

    Returns
    -------
    Axes

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for an empty path or wrong size of x.
    """
    check_path(path)
    places = _places(path, x)
    axes = axes_or_new(axes)
    drawing = Drawing.of(path)
    filled = axes.pcolormesh(drawing.s, places, drawing.u[:, :-1].T, shading="nearest", cmap="viridis", rasterized=True)
    axes.figure.colorbar(filled, ax=axes)
    for event in path.turning_points:
        axes.axvline(event.arclength, color="white", linewidth=0.8)
    label_axis(axes, "arclength", [path])
    axes.set_ylabel("number of the unknown" if x is None else "$x$")
    return axes


def _places(path: Drawn, x: Array | None) -> Array:
    size = path.steps[0].y.size
    places = np.arange(size, dtype=float) if x is None else np.asarray(x, dtype=float)
    if places.shape != (size,):
        raise ValueError(f"x: expected {size} places, one an unknown, found shape {places.shape}")
    return places


def plot_steps(path: Drawn, axes: Axes | None = None) -> Axes:
    """Draw step lengths (logarithmic) against arclength.

    Parameters
    ----------
    path : Path
    axes : matplotlib Axes, optional

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for an empty path.
    """
    check_path(path)
    axes = axes_or_new(axes)
    s = path.arclength
    lengths = np.diff(s)
    # An event on a point gives length zero.
    axes.semilogy(s[1:][lengths > 0], lengths[lengths > 0], marker=".", markersize=4, linewidth=0.8, color=COLOURS[0])
    for event in path.events:
        axes.axvline(event.arclength, color="0.6", linewidth=0.8, zorder=0)
    label_axis(axes, "arclength", [path])
    axes.set_ylabel("step in $s$")
    return tidy(axes)
