"""Checks of an orbit's arguments."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import POSITIVE_FINITE, expect, integer, real_vector
from continuation.arrays import EPS, Array
from continuation.evaluation.products import sizes
from problems.orbits.grid import Grid

DEGREES = integer(2, 12)
"""Degree 1 has no interior nodes; above 12 the power basis loses digits."""


@frozen
class Asked:
    """Checked grid size and first radius."""

    intervals: int = field(validator=integer(2))
    degree: int = field(validator=DEGREES)
    radius: float = field(default=1.0, validator=POSITIVE_FINITE)

    @property
    def grid(self) -> Grid:
        """Grid of equal intervals."""
        return Grid(np.linspace(0.0, 1.0, self.intervals + 1), self.degree)


def as_table(value: Any) -> Array:
    """A finite table of states."""
    found = real_vector("states", value)
    fine = found.ndim == 2 and np.isfinite(found).all()
    expect(fine, "states", "a table of finite numbers, a row for each node", value)
    return found


def as_mesh(value: Any) -> Array:
    """Mesh points, from a number of intervals or points."""
    found = np.linspace(0.0, 1.0, value + 1) if isinstance(value, int) and value > 1 else real_vector("mesh", value)
    rises = found.ndim == 1 and found.size > 2 and found[0] == 0.0 and found[-1] == 1.0 and (np.diff(found) > 0.0).all()
    expect(rises, "mesh", "a number of intervals, at least 2, or times that rise from 0 to 1", value)
    return found


def check_times(times: Array, states: Array) -> None:
    """Raise ValueError unless times, four or more, rise."""
    expect(times.shape == states.shape[:1], "x", f"a row for each of the times, {times.shape}", states.shape)
    expect(len(times) > 3 and (np.diff(times) > 0.0).all(), "t", "four times or more that rise", times)


def spread(states: Array) -> Array:
    """Standard deviations, or `sizes` of components that are constant but for round-off."""
    deviations, round_off = states.std(axis=0), len(states) * EPS * np.abs(states).max(axis=0)
    return np.where(deviations > round_off, deviations, sizes(states[0]))
