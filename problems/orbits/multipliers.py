"""Floquet multipliers from the condensed block A x_0 + B x_N = 0."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen
from scipy.linalg import eig

from continuation.arrays import SIX_DIGITS, Array

FOLD_ANGLE = 1e-4
"""Pairs with smaller arguments belong to folds of cycles: round-off splits a double multiplier by its root."""

TRIVIAL_FOUND = 0.5
"""If the trivial multiplier is off by more, all are lost."""


LEAST_NORMAL = float(np.finfo(float).tiny)


@frozen(eq=False, slots=False)
class Multipliers:
    """Eigenvalues of the pencil A + mu B by the QZ method."""

    A: Array
    B: Array

    @cached_property
    def _pencil(self) -> tuple[Array, Array]:
        values, vectors = eig(self.A, -self.B, homogeneous_eigvals=True)
        return values, vectors

    @cached_property
    def values(self) -> Array:
        """All, shape (n,): the trivial one, then by falling modulus."""
        alpha, beta = self._pencil[0]
        # A multiplier beyond all numbers is the largest.
        found = alpha / np.where(np.abs(beta) < LEAST_NORMAL, LEAST_NORMAL, beta)
        first = int(np.argmin(np.abs(found - 1.0)))
        rest = np.delete(found, first)
        return np.append(found[first], rest[np.argsort(-np.abs(rest))])

    @property
    def unstable(self) -> int:
        """Number of multipliers outside the unit circle, which folds split by the root of round-off."""
        return int((np.abs(self.values[1:]) > 1.0 + SIX_DIGITS).sum())

    @property
    def lost(self) -> bool:
        """Whether round-off of the largest multiplier hides others."""
        eps = float(np.finfo(float).eps)
        return bool(abs(self.values[0] - 1.0) > TRIVIAL_FOUND or eps * np.abs(self.values).max() > 1.0)

    @property
    def doubling(self) -> float:
        """Product of (mu + 1) / hypot(1, |mu|) over nontrivial mu: negative after a period doubling."""
        if self.lost:
            return 1.0
        rest = self.values[1:]
        return float(np.prod((rest + 1.0) / np.hypot(1.0, np.abs(rest))).real)

    @property
    def torus(self) -> float:
        """Log modulus of the complex pair nearest to the unit circle, or -1."""
        if self.lost:
            return -1.0
        pairs = self.values[(self.values.imag > 0.0) & (np.angle(self.values) > FOLD_ANGLE)]
        if not pairs.size:
            return -1.0
        outside = np.log(np.abs(pairs))
        return float(outside[np.argmin(np.abs(outside))])

    def vector(self, mu: float) -> Array:
        """Real eigenvector x_0 of the multiplier nearest to `mu`."""
        alpha, beta = self._pencil[0]
        nearest = int(np.argmin(np.abs(alpha - mu * beta) / np.hypot(np.abs(alpha), np.abs(beta))))
        x = self._pencil[1][:, nearest]
        return np.asarray((x * np.exp(-1j * np.angle(x[np.argmax(np.abs(x))]))).real)
