"""Collocation equations near an orbit, and events on its path."""

from __future__ import annotations

from functools import cached_property
from operator import attrgetter
from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array
from continuation.status import Kind
from problems.orbits.field import Field
from problems.orbits.grid import Grid
from problems.orbits.here import Here

PHASE_COSINE = 0.1
"""Mean cosine between velocities of orbit and reference at which the phase condition has lost a digit."""

ORBITS_KEPT = 4
"""Computations of one step share a cached point."""


@frozen(eq=False, slots=False)
class Equations:
    """Collocation equations; `states`, shape (N m, n), is the phase reference."""

    flow: Field
    grid: Grid
    scale: Array
    states: Array
    _recent: dict[bytes, Here] = field(factory=dict, init=False, repr=False)

    @cached_property
    def _reference(self) -> Array:
        return self.grid.slopes(self.states) / self.scale**2

    def unknowns(self, y: Array) -> tuple[Grid, Array, float]:
        """The grid, X of shape (N m, n), and T."""
        size = self.states.size
        mesh = np.concatenate([[0.0], y[size + 1 :], [1.0]])
        grid = self.grid if np.array_equal(mesh, self.grid.mesh) else Grid(mesh, self.grid.degree)
        return grid, y[:size].reshape(self.states.shape), float(y[size])

    def here(self, y: Array, lam: float) -> Here:
        """The equations at a point, cached."""
        key = np.append(y, lam).tobytes()
        if key not in self._recent:
            y, size = np.array(y, dtype=float), self.states.size
            X, T, times = y[:size].reshape(self.states.shape), float(y[size]), y[size + 1 :]
            self._recent[key] = Here(self.flow, self.grid, self.scale, self._reference, X, T, times, float(lam))
            if len(self._recent) > ORBITS_KEPT:
                del self._recent[next(iter(self._recent))]
        return self._recent[key]


@frozen
class Watch:
    """An event: `quantity`, an attribute path of `Here`, takes a value."""

    orbit: Any
    quantity: str
    name: str
    value: float = 0.0
    terminal: int = 0
    direction: int = 0
    kind: Kind = field(default=Kind.EVENT, init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """The quantity minus the value."""
        return float(attrgetter(self.quantity)(self.orbit.equations.here(u[:-1], float(u[-1])))) - self.value
