"""An orbit's equations at one point."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array
from problems.orbits.blocks import Condensed
from problems.orbits.field import Field
from problems.orbits.grid import Grid
from problems.orbits.multipliers import Multipliers


@frozen(eq=False, slots=False)
class Here:
    """The collocation equations, their derivatives and the multipliers at one point (X, T, p), each computed once.

    `times`: the inner mesh points among the unknowns; equations pin them to the grid's. `reference`: the reference
    orbit's derivative over `scale` squared, for the phase condition.
    """

    field: Field
    grid: Grid
    scale: Array
    reference: Array
    X: Array
    T: float
    times: Array
    p: float

    @cached_property
    def _values(self) -> Array:
        return self.grid.values(self.X)

    @cached_property
    def _columns(self) -> Array:
        return np.ascontiguousarray(self._values.reshape(-1, self.scale.size).T)

    @cached_property
    def flow(self) -> Array:
        """Vector field, shape (N, m, n)."""
        return np.asarray(self.field(self._columns, self.p), dtype=float).T.reshape(self._values.shape)

    @cached_property
    def _derivatives(self) -> tuple[Array, Array]:
        by_x, by_p = self.field.derivatives(self._columns, self.p)
        shape = self._values.shape
        return by_x.reshape(*shape, shape[-1]), by_p.reshape(shape)

    def residual(self) -> Array:
        """X' - T f, phase condition and mesh deviation."""
        equations = self.grid.slopes(self.X) - self.T * self.flow
        phase = np.einsum("ig,ign,ign->", self.grid.quadrature, self._values, self.reference)
        return np.concatenate([equations.ravel(), [phase], self.times - self.grid.mesh[1:-1]])

    @cached_property
    def _blocks(self) -> Array:
        grid, n = self.grid, self.scale.size
        by_x = self.T * grid.widths[:, None, None, None] * self._derivatives[0]
        found = -grid.value[None, :, None, :, None] * by_x[:, :, :, None, :]
        found[:, :, np.arange(n), :, np.arange(n)] += grid.slope
        return found

    @cached_property
    def _phase_row(self) -> Array:
        row = np.zeros_like(self.X)
        each = np.einsum("ig,ign,gk->ikn", self.grid.quadrature, self.reference, self.grid.value)
        np.add.at(row, self.grid.index, each)
        return row.ravel()

    @cached_property
    def matrices(self) -> tuple[sp.csc_array, Array]:
        """Derivatives of the collocation equations by the unknowns, sparse, and by the parameter p."""
        grid, n = self.grid, self.scale.size
        blocks = self._blocks / grid.widths[:, None, None, None, None]
        size = self.X.size
        rows = np.broadcast_to(np.arange(size).reshape(*self._values.shape, 1, 1), blocks.shape)
        columns = np.broadcast_to((grid.index[:, :, None] * n + np.arange(n))[:, None, None], blocks.shape)
        whole = size + 1 + self.times.size
        each, pinned = np.arange(size), np.arange(size + 1, whole)
        entries = np.concatenate([blocks.ravel(), -self.flow.ravel(), self._phase_row, np.ones(pinned.size)])
        i = np.concatenate([rows.ravel(), each, np.full(size, size), pinned])
        j = np.concatenate([columns.ravel(), np.full(size, size), each, pinned])
        by_p = np.zeros(whole)
        by_p[:size] = -self.T * self._derivatives[1].ravel()
        return sp.csc_array((entries, (i, j)), shape=(whole, whole)), by_p

    @cached_property
    def _condensed(self) -> Condensed:
        N, m, n = self._values.shape
        blocks = self._blocks * (self.scale / self.scale[:, None])[:, None, :]
        return Condensed.of(blocks.reshape(N, m * n, -1))

    @cached_property
    def multipliers(self) -> Multipliers:
        """The Floquet multipliers."""
        return Multipliers(self._condensed.A, self._condensed.B)

    def mode(self, mu: float) -> Array:
        """Eigenfunction of the multiplier nearest to `mu`, shape (N m, n)."""
        x = self.multipliers.vector(mu)
        return self._condensed.all_from(np.stack([x, mu * x])) * self.scale

    @property
    def amplitude(self) -> float:
        """Scaled root mean square deviation from the mean."""
        X, weights = self.X / self.scale, np.zeros(len(self.X))
        np.add.at(weights, self.grid.index, self.grid.quadrature @ self.grid.value)
        return float(np.sqrt(np.abs(weights @ (X - weights @ X) ** 2).mean()))

    @property
    def phase_cosine(self) -> float:
        """See `PHASE_COSINE`."""
        root = np.sqrt(self.grid.quadrature)[:, :, None]
        own, reference = root * self.flow / self.scale, root * self.reference * self.scale
        return float((own * reference).sum() / (np.linalg.norm(own) * np.linalg.norm(reference)))

    def observed(self) -> dict[str, float]:
        """Period, extreme values, unstable multipliers, error estimates."""
        (low, high), values = self.grid.extremes(self.X), self.multipliers.values
        found = {"period": self.T}
        for k in range(self.scale.size):
            found |= {f"min {k}": float(low[k]), f"max {k}": float(high[k])}
        return found | {
            "unstable": float(self.multipliers.unstable),
            "multiplier": float(np.abs(values[1:]).max(initial=0.0)),
            "trivial": float(np.abs(values[0] - 1.0)),
            "error": self.grid.error(self.X / self.scale),
        }
