"""Bifurcation diagrams."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np

from continuation.arrays import Array
from continuation.plot.drawing import (
    Axes,
    Drawing,
    Drawn,
    across,
    axes_or_new,
    check_path,
    chosen_components,
    height,
    interpolated,
    label_axis,
    line_style,
    mark_events,
    tidy,
)
from continuation.plot.stretches import Stretch, by_stability, draw_line, stretches

Value: TypeAlias = int | str | Callable[[Array, float], float] | None
"""Component, name, function of (y, lam), or None (maximum norm)."""

Stable: TypeAlias = str | Callable[[Array, float], bool] | None


def plot_bifurcation(
    path: Drawn | Iterable[Drawn],
    axes: Axes | None = None,
    component: int | None = None,
    *,
    value: Value = None,
    against: str = "lam",
    stable: Stable = None,
    names: Sequence[str] | None = None,
    legend: bool = True,
) -> Axes:
    """Draw one number of y against the parameter, with named events.

    Parameters
    ----------
    path : Path or sequence of Path
    axes : matplotlib Axes, optional
    component : int, optional
        Same as `value`.
    value : int, str or callable, optional
        A component, the name of an unknown or observed scalar, or a function of (y, lam); default: maximum norm.
    against : {"lam", "arclength"}
    stable : str or callable, optional
        Observed scalar positive, or function of (y, lam) true, on stable (solid) parts; default: from
        `continuation.Stability`.
    names : sequence of str, optional
        One per path.
    legend : bool

    Returns
    -------
    Axes

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for an empty path or unknown `component`, `value`, `stable`.
    """
    paths = list(path) if isinstance(path, Iterable) else [path]
    if not paths:
        raise ValueError("path: expected at least one, found none")
    for one in paths:
        check_path(one)
    wanted = value if component is None else component
    axes = axes_or_new(axes)
    for k, one in enumerate(paths):
        drawing = Drawing.of(one)
        horizontal, heights = across(against, drawing), values_along(one, drawing, wanted)
        label = (names[k] if names is not None else None) or "_"
        draw_line(axes, horizontal, heights, label, line_style(k), drawing.s, _parts(one, drawing, stable))
        places = [
            (event, event.lam if against == "lam" else event.arclength, at_event(event, one, wanted))
            for event in one.events
        ]
        mark_events(axes, places)
    label_axis(axes, against, paths)
    axes.set_ylabel(_named(paths[0], wanted))
    if legend and axes.get_legend_handles_labels()[1]:
        axes.legend(frameon=False, fontsize="small")
    return tidy(axes)


def values_along(path: Drawn, drawing: Drawing, value: Value) -> Array:
    """The drawn number at each point."""
    measured = _measured(path, value)
    return _observed(path, drawing, str(value)) if measured is None else np.array([*map(measured, drawing.u)])


def at_event(event: Any, path: Drawn, value: Value) -> float:
    """The drawn number at an event of `path`."""
    measured = _measured(path, value)
    return float(event.observed.get(value, np.nan)) if measured is None else measured(event.u)


def _measured(path: Drawn, value: Value) -> Callable[[Array], float] | None:
    """Function of (y, lam), or None for an observed scalar."""
    if value is None:
        return lambda u: float(height(u[:-1]))
    if not isinstance(value, int | str):
        function = value
        return lambda u: float(function(u[:-1], float(u[-1])))
    if isinstance(value, str):
        if value in path.steps[0].observed:
            return None
        if value not in path.labels.names:
            known = ", ".join((*path.labels.names, *path.steps[0].observed)) or "no names"
            raise ValueError(f"value: expected one of {known}, found {value!r}")
        value = int(path.labels.index(value))
    (component,) = chosen_components([value], path.u[:, :-1])
    return lambda u: float(u[component])


def _observed(path: Drawn, drawing: Drawing, name: str) -> Array:
    known = [(step.arclength, step.observed[name]) for step in path.steps]
    known += [(event.arclength, event.observed[name]) for event in path.events if name in event.observed]
    s, values = np.array(known).T
    return interpolated(s, values, drawing.s)


def _parts(path: Drawn, drawing: Drawing, stable: Stable) -> list[Stretch] | None:
    if stable is None:
        return by_stability(path, drawing.s)
    if callable(stable):
        solid = np.array([bool(stable(u[:-1], float(u[-1]))) for u in drawing.u])
    elif stable in path.steps[0].observed:
        solid = _observed(path, drawing, stable) > 0.0
    else:
        raise ValueError(f"stable: expected one of {', '.join(path.steps[0].observed) or 'nothing'}, found {stable!r}")
    return stretches(drawing.s, drawing.s[np.flatnonzero(np.diff(solid))], bool(solid[0]))


def _named(path: Drawn, value: Value) -> str:
    if value is None:
        return r"$\max_i |y_i|$"
    if callable(value):
        return str(getattr(value, "__name__", "")).replace("<lambda>", "")
    if isinstance(value, str):
        return str(path.labels.with_unit(value))
    name = path.labels.unknown(value)
    return str(path.labels.with_unit(name)) if name else f"$y_{{{value}}}$"
