"""The inner product that defines arclength: <a, b> = sum_i w_i a_i b_i with positive weights w."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np
from attrs import field, frozen
from attrs.validators import gt

from continuation.arrays import Array


class Metric(Protocol):
    """Weights of the inner product at a point of the path."""

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """Positive weights, shape (N + 1,).

        Parameters
        ----------
        u, v : ndarray, shape (N + 1,)
            The point (y, lam) and a direction of the path there (of any length and sign).
        current : ndarray or None
            The weights of the step before; None at the start. A metric that stays as it began returns them.
        """
        ...


def inner(weights: Array, a: Array, b: Array) -> float:
    """<a, b> in the metric of `weights`."""
    return float(np.dot(weights * a, b))


def norm(weights: Array, a: Array) -> float:
    """The length of `a` in the metric of `weights`."""
    return math.sqrt(np.dot(weights * a, a))


def share(weights: Array, v: Array) -> float:
    """The parameter's share of the squared length of v, between 0 and 1."""
    return float(weights[-1] * v[-1] ** 2 / np.dot(weights * v, v))


@frozen
class Euclidean:
    """Every component counts alike."""

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """Ones."""
        return np.ones_like(u) if current is None else current


@frozen
class Weighted:
    """Given weights: one for y (a number, or one a component) and one for the parameter.

    ``Weighted(1 / N, 1)`` is the root-mean-square metric of discretised functions.
    """

    y: float | Array = 1.0
    lam: float = field(default=1.0, validator=gt(0))

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """The given weights, as one array."""
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
    """Weights 1/N on y and 1 on the parameter: what a discretised function has as its L2 norm."""

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """1/N for each component of y, 1 for the parameter."""
        return Weighted(1.0 / (u.size - 1)).weights(u, v, current)


@frozen
class Relative:
    """Components measured by their own size, 1/max(|u_i|, floor)^2, anew at each point; the parameter absolutely.

    Made for interior paths, whose components live in orders of magnitude.
    """

    floor: float = field(default=1e-12, validator=gt(0))
    lam: float = field(default=1.0, validator=gt(0))

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """1/max(|u_i|, floor)^2, and `lam` for the parameter."""
        weights: Array = np.maximum(np.abs(u), self.floor) ** -2
        weights[-1] = self.lam
        return weights


@frozen
class Automatic:
    """Components of y measured absolutely while below 1 and relatively above, like a mixed tolerance; lam absolutely.

    It follows curves whose components have very different sizes in few steps, and it is nearly Euclidean where all
    are moderate. The parameter's weight is raised once, at the start, if its share of the tangent would be below
    `share` there: without that, steps on a fine discretisation would be blind to the parameter. At a start on a
    turning point there is nothing to raise.
    """

    share: float = field(default=0.01, validator=[gt(0)])

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """1/max(|y_i|, 1)^2 for y, and one fixed weight for the parameter."""
        size = np.maximum(np.abs(u), 1.0)
        weights: Array = 1.0 / (size * size)
        if current is not None:
            weights[-1] = current[-1]
            return weights
        rest, own = float(np.dot(weights[:-1] * v[:-1], v[:-1])), float(v[-1] ** 2)
        balance = self.share / (1.0 - self.share) * rest
        weights[-1] = min(max(1.0, balance / own), 1e6) if own > 0.0 else 1.0
        return weights
