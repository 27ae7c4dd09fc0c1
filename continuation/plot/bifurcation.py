"""Bifurcation diagrams."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np

from continuation.arguments.checks import expect
from continuation.arrays import Array
from continuation.plot.drawing import (
    Axes,
    Drawing,
    Drawn,
    StableParts,
    check_path,
    chosen_components,
    draw,
    known_along,
    sampled,
    stable_parts,
)

Value: TypeAlias = int | str | Callable[[Array, float], float] | None
"""Component, name, function of (y, lam), or None (maximum norm)."""

Stable: TypeAlias = Callable[[Array, float], bool] | None


def plot_bifurcation(
    path: Drawn | Iterable[Drawn],
    axes: Axes | None = None,
    value: Value = None,
    *,
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
    value : int, str or callable, optional
        A component, the name of an unknown or observed scalar, or a function of (y, lam); default: maximum norm.
    against : {"lam", "arclength"}
    stable : callable, optional
        A function of (y, lam) that is true on stable (solid) parts; default: from `continuation.Stability`.
    names : sequence of str, optional
        One per path.
    legend : bool

    Raises
    ------
    ImportError, ValueError
        Without matplotlib; for an empty path or unknown `value`.
    """
    paths = list(path) if isinstance(path, Iterable) else [path]
    expect(paths, "path", "at least one", paths)
    curves: list[list[Drawing]] = []
    for k, one in enumerate(paths):
        check_path(one)
        s, u = sampled(one)
        label = (names[k] if names is not None else None) or "_"
        heights = [at_event(event, one, value) for event in one.events]
        curves.append([Drawing(one, s, u, _along(one, s, u, value), heights, label, k, _parts(one, s, u, stable))])
    axes = draw(axes, curves, against, legend)
    axes.set_ylabel(_named(paths[0], value))
    return axes


def at_event(event: Any, path: Drawn, value: Value) -> float:
    """Drawn number at an event of `path`."""
    measured = _measured(path, value)
    return float(event.observed.get(value, np.nan)) if measured is None else measured(event.u)


def _along(path: Drawn, s: Array, u: Array, value: Value) -> Array:
    measured = _measured(path, value)
    if measured is not None:
        return np.array([*map(measured, u)])
    return known_along(path, lambda point: point.observed.get(value, np.nan), s)


def _measured(path: Drawn, value: Value) -> Callable[[Array], float] | None:
    """A function of (y, lam), or None for an observed scalar."""
    if value is None:
        return lambda u: float(np.fmax.reduce(np.abs(u[:-1])))
    if callable(value):
        function = value
        return lambda u: float(function(u[:-1], float(u[-1])))
    if isinstance(value, str):
        if value in path.steps[0].observed:
            return None
        known = ", ".join((*path.labels.names, *path.steps[0].observed)) or "no names"
        expect(value in path.labels.names, "value", f"one of {known}", value)
        value = int(path.labels.index(value))
    (component,) = chosen_components([value], path.u[:, :-1])
    return lambda u: float(u[component])


def _parts(path: Drawn, s: Array, u: Array, stable: Stable) -> StableParts:
    if stable is None:
        return stable_parts(path)
    solid = np.array([bool(stable(point[:-1], float(point[-1]))) for point in u])
    return s[1:][np.diff(solid)].tolist(), bool(solid[0])


def _named(path: Drawn, value: Value) -> str:
    if value is None:
        return r"$\max_i |y_i|$"
    if callable(value):
        return str(getattr(value, "__name__", "")).replace("<lambda>", "")
    name = value if isinstance(value, str) else path.labels.unknown(value)
    return str(path.labels.with_unit(name)) if name else f"$y_{{{value}}}$"
