"""What an orbit is made of: its table of states, its mesh, and how large its components are."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import POSITIVE_FINITE, complain, integer, real_vector
from continuation.arrays import Array
from continuation.evaluation.products import sizes
from problems.orbits.grid import Grid

DEGREES = integer(2, 12)
"""Below two an interval has nothing inside; beyond twelve powers on an interval, by which values are found between the
nodes, lose more digits to round-off than another degree gains."""


@frozen
class Asked:
    """How fine a grid is asked for, and how far from where a branch begins; checked."""

    intervals: int = field(validator=integer(2))
    degree: int = field(validator=DEGREES)
    radius: float = field(default=1.0, validator=POSITIVE_FINITE)

    @property
    def grid(self) -> Grid:
        """Of equal intervals."""
        return Grid(np.linspace(0.0, 1.0, self.intervals + 1), self.degree)


def as_table(value: Any) -> Array:
    """States as a table."""
    found = real_vector("states", value)
    if found.ndim != 2 or not np.isfinite(found).all():
        raise complain(ValueError, "states", "a table of finite numbers, a row for each node", value)
    return found


def as_mesh(value: Any) -> Array:
    """A number of equal intervals, or a mesh."""
    found = np.linspace(0.0, 1.0, value + 1) if isinstance(value, int) and value > 1 else real_vector("mesh", value)
    if found.ndim != 1 or found.size < 3 or found[0] != 0.0 or found[-1] != 1.0 or not (np.diff(found) > 0.0).all():
        raise complain(ValueError, "mesh", "a number of intervals, at least 2, or times that rise from 0 to 1", value)
    return found


def check_times(times: Array, states: Array) -> None:
    """Raise ValueError unless a simulation's times belong to its states and rise."""
    if times.shape != (len(states),) or len(times) < 4 or not (np.diff(times) > 0.0).all():
        raise complain(ValueError, "t", f"{len(states)} times that rise, one a state", times)


def spread(states: Array) -> Array:
    """Standard deviations; of what stands still its own size, or 1."""
    spread = states.std(axis=0)
    return np.where(spread > 0.0, spread, sizes(states[0]))
