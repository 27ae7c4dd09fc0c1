"""Floquet multipliers, from one block A x_0 + B x_N = 0 that orthogonal transformations have left of an orbit's."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import frozen
from scipy.linalg import eig

from continuation.arrays import Array

FOLD_ANGLE = 1e-4
"""A pair with less than this for its argument belongs to a fold of cycles, not to a torus: there two multipliers are 1,
and round-off makes a pair of them whose argument is its root."""

OUTSIDE_CIRCLE = 1e-6
"""A multiplier counts as unstable where its modulus is above 1 by more: at the folds of a family, where it is 1, it is
known to the root of round-off, as the one that is always there is."""


TRIVIAL_FOUND = 0.5
"""Multipliers of which the first, that is 1, is off by more are not known."""


LEAST_NORMAL = float(np.finfo(float).tiny)


@frozen(eq=False, slots=False)
class Multipliers:
    """The eigenvalues of the pencil A + mu B, by the QZ method: no block is inverted, none multiplied by another."""

    A: Array
    B: Array

    @cached_property
    def _pencil(self) -> tuple[Array, Array]:
        values, vectors = eig(self.A, -self.B, homogeneous_eigvals=True)
        return values, vectors

    @cached_property
    def values(self) -> Array:
        """All of them, that of the phase, which is 1, first; shape (n,), complex."""
        alpha, beta = self._pencil[0]
        # One that is beyond all numbers is the largest.
        found = alpha / np.where(np.abs(beta) < LEAST_NORMAL, LEAST_NORMAL, beta)
        first = int(np.argmin(np.abs(found - 1.0)))
        rest = np.delete(found, first)
        return np.append(found[first], rest[np.argsort(-np.abs(rest))])

    @property
    def unstable(self) -> int:
        """How many lie outside of the unit circle."""
        return int((np.abs(self.values[1:]) > 1.0 + OUTSIDE_CIRCLE).sum())

    @property
    def lost(self) -> bool:
        """Whether multipliers of moderate size are round-off of another one: 1 is not among them, or by chance."""
        eps = float(np.finfo(float).eps)
        return bool(abs(self.values[0] - 1.0) > TRIVIAL_FOUND or eps * np.abs(self.values).max() > 1.0)

    @property
    def doubling(self) -> float:
        """The product of mu + 1 over all but the first, each divided by its size: it changes its sign where one is -1.

        The first, 1, is left out, since orbits that are nearly homoclinic have another that is larger than the inverse
        of round-off, beside which it is lost.
        """
        if self.lost:
            return 1.0
        rest = self.values[1:]
        return float(np.prod((rest + 1.0) / np.hypot(1.0, np.abs(rest))).real)

    @property
    def torus(self) -> float:
        """Of the pair nearest to the unit circle how far outside it lies; -1 where there is no pair."""
        if self.lost:
            return -1.0
        pairs = self.values[(self.values.imag > 0.0) & (np.angle(self.values) > FOLD_ANGLE)]
        if not pairs.size:
            return -1.0
        outside = np.log(np.abs(pairs))
        return float(outside[np.argmin(np.abs(outside))])

    def vector(self, mu: float) -> Array:
        """The real eigenvector of the multiplier nearest to a number, x_0."""
        alpha, beta = self._pencil[0]
        nearest = int(np.argmin(np.abs(alpha - mu * beta) / np.hypot(np.abs(alpha), np.abs(beta))))
        x = self._pencil[1][:, nearest]
        return np.asarray((x * np.exp(-1j * np.angle(x[np.argmax(np.abs(x))]))).real)
