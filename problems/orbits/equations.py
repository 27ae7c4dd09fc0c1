"""Collocation equations near an orbit."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache

import numpy as np
from attrs import frozen

from continuation.arrays import Array
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
        """Cached equations at a point."""
        return self._at(np.append(y, lam).tobytes())

    @cached_property
    def _at(self) -> Callable[[bytes], Here]:
        return lru_cache(ORBITS_KEPT)(self._made)

    def _made(self, key: bytes) -> Here:
        u, size = np.frombuffer(key), self.states.size
        X, times = u[:size].reshape(self.states.shape), u[size + 1 : -1]
        return Here(self.flow, self.grid, self.scale, self._reference, X, float(u[size]), times, float(u[-1]))
