"""Pictures of one path, and of the tube of its proof."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from continuation.arguments.checks import expect
from continuation.arrays import Array
from continuation.plot.drawing import (
    COLOURS,
    MOST_COMPONENTS,
    SMOOTHNESS,
    Axes,
    Drawing,
    Drawn,
    axes_or_new,
    check_path,
    chosen_components,
    draw,
    label_axis,
    line_style,
    sampled,
    stable_parts,
    tidy,
)
from continuation.point.segment import cubic


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
        Default: all, or seven evenly spaced.
    legend : bool
        Whether to name curves and events and draw arrows.

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for invalid arguments or an empty path.
    """
    check_path(path)
    s, u = sampled(path)
    chosen, own = chosen_components(components, path.u[:, :-1]), path.labels
    usual = [own.with_unit(own.unknown(i)) if own.unknown(i) else f"$y_{{{i}}}$" for i in chosen]
    labels = usual if names is None else list(names)
    expect(len(labels) == len(chosen), "names", f"{len(chosen)}, one a component drawn", labels)
    parts = stable_parts(path)
    curves = [
        Drawing(path, s, u, u[:, i], [event.y[i] for event in path.events], label, k, parts)
        for k, (i, label) in enumerate(zip(chosen, labels))
    ]
    axes = draw(axes, [curves], against, legend)
    if len(chosen) == 1:
        axes.set_ylabel(labels[0])
    return axes


def plot_profiles(
    path: Drawn, axes: Axes | None = None, profiles: int = MOST_COMPONENTS, x: Array | None = None
) -> Axes:
    """Draw all unknowns over position at a few points of the path.

    Parameters
    ----------
    path : Path
    axes : matplotlib Axes, optional
    profiles : int, default 7
        Evenly spaced in arclength, ends included.
    x : array_like, shape (N,), optional
        Positions; default: numbers of the unknowns.

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for an empty path or wrong size of x.
    """
    check_path(path)
    size = path.steps[0].y.size
    places = np.arange(size, dtype=float) if x is None else np.asarray(x, dtype=float)
    expect(places.shape == (size,), "x", f"{size} places, one an unknown", x)
    axes = axes_or_new(axes)
    ends = path.arclength[0], path.arclength[-1]
    for k, s in enumerate(np.linspace(*ends, min(profiles, MOST_COMPONENTS))):
        u = path(float(s))
        axes.plot(places, u[:-1], label=f"{u[-1]:.4g}", **line_style(k))
    axes.legend(title=path.labels.parameter(r"$\lambda$"), frameon=False, fontsize="small")
    axes.set_xlabel("number of the unknown" if x is None else "$x$")
    return tidy(axes)


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
    axes.semilogy(s[1:][lengths > 0], lengths[lengths > 0], marker=".", markersize=4, linewidth=0.8, color=COLOURS[0])
    for event in path.events:
        axes.axvline(event.arclength, color="0.6", linewidth=0.8, zorder=0)
    label_axis(axes, "arclength", [path])
    axes.set_ylabel("step in $s$")
    return tidy(axes)


def plot_tube(cells: Any, gaps: Sequence[tuple[float, float]], component: int, axes: Axes | None = None) -> Axes:
    """Draw the tube in one component of y against the parameter; `gaps` are arclengths."""
    axes = axes_or_new(axes)
    from matplotlib.collections import PolyCollection

    rows = zip(cells.begin, cells.end, cells.slope_begin, cells.slope_end)
    curves = np.array([[cubic(*row).at(t) for t in np.linspace(0.0, 1.0, SMOOTHNESS)] for row in rows])
    curves, wide = curves[:, :, [-1, component]], cells.radius[:, [-1, component]][:, None]
    lo, hi = (sign * np.maximum(sign * curves[:, 1:], sign * curves[:, :-1]) + sign * wide for sign in (-1.0, 1.0))
    corners = [np.stack([x[..., 0], y[..., 1]], axis=-1) for x, y in ((lo, lo), (hi, lo), (hi, hi), (lo, hi))]
    boxes = np.stack(corners, axis=2).reshape(-1, 4, 2)
    # Most tubes are thinner than a line: their edges are drawn.
    axes.add_collection(PolyCollection(list(boxes), color=COLOURS[0], alpha=0.35, linewidth=2.0))
    axes.plot(*curves.reshape(-1, 2).T, ".-", markevery=SMOOTHNESS, color=COLOURS[0], linewidth=0.8)
    axes.set(xlabel="parameter", ylabel=f"y[{component}]", title=f"{len(gaps)} gaps" if gaps else "complete")
    return tidy(axes)
