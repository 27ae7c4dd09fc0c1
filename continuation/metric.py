"""Metrics: arclength from <a, b> = sum_i w_i a_i b_i with positive weights w."""

from __future__ import annotations

from math import sqrt
from typing import Protocol, runtime_checkable

import numpy as np
from attrs import field, frozen
from numpy.typing import NDArray
from scipy.linalg.blas import dscal

from continuation.arguments.checks import FRACTION, POSITIVE_FINITE
from continuation.arrays import Array, dot


class Metric(Protocol):
    """Gives the weights of the inner product at a point."""

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """Return positive weights, shape (N + 1,).

        Parameters
        ----------
        u, v : ndarray, shape (N + 1,)
            Point (y, lam), and a path direction of any length and sign.
        current : ndarray or None
            Last weights; None at the start.
        """
        ...


def inner(weights: Array, a: Array, b: Array) -> float:
    """<a, b> in the metric."""
    return dot(weights * a, b)


def norm(weights: Array, a: Array) -> float:
    """Length of `a` in the metric."""
    return sqrt(dot(weights * a, a))


def share(weights: Array, v: Array) -> float:
    """The parameter's part of the squared length of v, between 0 and 1."""
    return float(weights[-1] * v[-1] ** 2 / dot(weights * v, v))


@frozen
class Euclidean:
    """Weights 1."""

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """Ones."""
        return np.ones_like(u) if current is None else current


@frozen
class Weighted:
    """Given weights, one or one each for y, and one for the parameter."""

    y: float | Array = 1.0
    lam: float = field(default=1.0, validator=POSITIVE_FINITE)

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """The given weights."""
        if current is not None:
            return current
        weights = np.empty_like(u)
        weights[:-1] = self.y
        weights[-1] = self.lam
        if not (np.isfinite(weights).all() and (weights > 0).all()):
            raise ValueError("y: expected positive finite weights")
        return weights


@frozen
class RootMeanSquare:
    """The L2 norm of a discretised function: weights 1/N on y, 1 on the parameter."""

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """The weights."""
        return Weighted(1.0 / (u.size - 1)).weights(u, v, current)


@frozen
class Relative:
    """Weights 1/max(|u_i|, floor)^2 at each point, and a fixed one for the parameter: for interior paths."""

    floor: float = field(default=1e-12, validator=POSITIVE_FINITE)
    lam: float = field(default=1.0, validator=POSITIVE_FINITE)

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """The weights."""
        weights: Array = np.maximum(np.abs(u), self.floor) ** -2
        weights[-1] = self.lam
        return weights


@frozen
class Automatic:
    """Each component in units of how far the path has gone in it.

    ``|v|^2 = (1 - share) mean_i (v_i / S_i)^2 + share (v_{N+1} / S_{N+1})^2``. The extent S is how far a component goes
    until the path turns, later at least its distance from the start. Units and origin do not change the steps.

    Parameters
    ----------
    share : float
        Weight of the parameter. Between 0.1 and 0.3 factorisations on twelve problems differ by less than a tenth.
    blocks : ndarray of int, shape (N,), optional
        Labels; a label's unknowns get its largest scale.
    before : ndarray, shape (N + 1,), optional
        On a branch: the weights where it leaves another, whose scales bound its own from below. Otherwise those of
        components that stand still would shrink from branch to branch.
    """

    share: float = field(default=0.2, validator=FRACTION)
    blocks: NDArray[np.int64] | None = field(default=None, eq=False, kw_only=True)
    before: Array | None = field(default=None, eq=False, kw_only=True)

    @property
    def longest(self) -> float:
        """Longest step: one extent, so that a step at most doubles how far the path is known."""
        return 1.0

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """The current weights, else those for `v`."""
        if current is not None:
            return current
        size = np.abs(v)
        return self.of_extent(np.where(size > 0.0, size, float(size.max())))

    def of_extent(self, extent: Array) -> Array:
        """Return the weights for an extent.

        Parameters
        ----------
        extent : ndarray, shape (N + 1,)
        """
        if self.blocks is not None:
            farthest = np.zeros(int(self.blocks.max()) + 1)
            np.maximum.at(farthest, self.blocks, extent[:-1])
            extent = np.append(farthest[self.blocks], extent[-1])
        weights: Array = extent**-2.0
        last = self.share * weights.item(-1)
        dscal((1.0 - self.share) / (extent.size - 1), weights)
        weights[-1] = last
        return weights if self.before is None else np.minimum(weights, self.before / OF_BEFORE**2)

    def grown(self, current: Array, origin: Array, u: Array) -> Array:
        """Return the weights at `u`.

        Parameters
        ----------
        current, origin, u : ndarray, shape (N + 1,)
        """
        return np.minimum(current, self.of_extent(np.maximum(np.abs(u - origin), INVERTIBLE)))


OF_BEFORE = 0.1
"""Least scale on a branch, over the scale before: on four successive pitchforks 0.01 starts the third a thousandth as
far away as the first."""

INVERTIBLE = 1e-150
"""Least distance whose square has a finite inverse."""


@runtime_checkable
class SupportsExtent(Protocol):
    """A metric with scales from the path's extent."""

    @property
    def longest(self) -> float:
        """Longest step."""
        ...

    def of_extent(self, extent: Array) -> Array:
        """Return the weights for an extent.

        Parameters
        ----------
        extent : ndarray, shape (N + 1,)
            How far the path goes in each component.

        Returns
        -------
        ndarray, shape (N + 1,)
        """
        ...

    def grown(self, current: Array, origin: Array, u: Array) -> Array:
        """Return the weights at `u`.

        Parameters
        ----------
        current : ndarray, shape (N + 1,)
        origin, u : ndarray, shape (N + 1,)
            The path's start, and its point.

        Returns
        -------
        ndarray, shape (N + 1,)
        """
        ...
