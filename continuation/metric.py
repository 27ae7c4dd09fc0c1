"""The inner product that defines arclength: <a, b> = sum_i w_i a_i b_i with positive weights w."""

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
    return dot(weights * a, b)


def norm(weights: Array, a: Array) -> float:
    """The length of `a` in the metric of `weights`."""
    return sqrt(dot(weights * a, a))


def share(weights: Array, v: Array) -> float:
    """The parameter's share of the squared length of v, between 0 and 1."""
    return float(weights[-1] * v[-1] ** 2 / dot(weights * v, v))


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
    lam: float = field(default=1.0, validator=POSITIVE_FINITE)

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

    floor: float = field(default=1e-12, validator=POSITIVE_FINITE)
    lam: float = field(default=1.0, validator=POSITIVE_FINITE)

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """1/max(|u_i|, floor)^2, and `lam` for the parameter."""
        weights: Array = np.maximum(np.abs(u), self.floor) ** -2
        weights[-1] = self.lam
        return weights


@frozen
class Automatic:
    """Each component measured by how far the path has gone in it: the same path in any units, and wherever zero is.

    ``|v|^2 = (1 - share) mean_i (v_i / S_i)^2 + share (v_{N+1} / S_{N+1})^2``, where S is the extent: at the start how
    far each component goes until the path has turned noticeably (`continuation.step.extent`), from then on at least its
    distance from the start. A change of units y -> D y + c, lam -> a lam + b, H -> E H changes neither lengths nor
    angles, so a trace takes the same steps.

    The mean over y makes the length independent of N. The parameter's share decides how sharp a turning point looks;
    measured on twelve problems (examples/benchmarks/units), factorisations differ by less than a tenth between shares
    of 0.1 and 0.3.

    Parameters
    ----------
    share : float
        Weight of the parameter's change beside the mean of all others.
    blocks : ndarray of int, shape (N,), optional
        A label for each unknown. Those of one label are samples of one field, and are measured alike: by what goes
        farthest.
    """

    share: float = field(default=0.2, validator=FRACTION)
    blocks: NDArray[np.int64] | None = field(default=None, eq=False, kw_only=True)

    @property
    def longest(self) -> float:
        """The longest step: at most doubles what is known of the path. Farther ahead nothing has been seen yet."""
        return 1.0

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """The current weights; without any, each component is measured by its share in the direction `v`."""
        if current is not None:
            return current
        size = np.abs(v)
        return self.of_extent(np.where(size > 0.0, size, float(size.max())))

    def of_extent(self, extent: Array) -> Array:
        """The weights for the extent of each component.

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
        return weights

    def grown(self, current: Array, origin: Array, u: Array) -> Array:
        """The weights where the path, which began at `origin`, has come to `u`.

        Parameters
        ----------
        current, origin, u : ndarray, shape (N + 1,)
        """
        return np.minimum(current, self.of_extent(np.maximum(np.abs(u - origin), INVERTIBLE)))


@frozen(eq=False)
class Inherited:
    """`Automatic` for a branch that leaves another: no component is measured by less than a part of what it was there.

    What stands still where a branch begins has no scale of its own; the median of what moves, which is little beside a
    branch point, would become less with each branch that leaves a branch.

    Parameters
    ----------
    before : ndarray, shape (N + 1,)
        The weights where it leaves.
    part : float
        Measured on four pitchforks that leave each other: with 0.01 the third generation begins a thousandth as far
        away as the first, with 0.1 all begin well.
    """

    before: Array
    part: float = field(default=0.1, validator=FRACTION)
    automatic: Automatic = field(factory=Automatic, init=False)

    @property
    def longest(self) -> float:
        """As of `Automatic`."""
        return self.automatic.longest

    def weights(self, u: Array, v: Array, current: Array | None) -> Array:
        """As of `Automatic`, no more than those before allow."""
        return self._bounded(self.automatic.weights(u, v, current))

    def of_extent(self, extent: Array) -> Array:
        """As of `Automatic`, no more than those before allow.

        Parameters
        ----------
        extent : ndarray, shape (N + 1,)
        """
        return self._bounded(self.automatic.of_extent(extent))

    def grown(self, current: Array, origin: Array, u: Array) -> Array:
        """As of `Automatic`.

        Parameters
        ----------
        current, origin, u : ndarray, shape (N + 1,)
        """
        return self.automatic.grown(current, origin, u)

    def _bounded(self, weights: Array) -> Array:
        return np.minimum(weights, self.before / self.part**2)


INVERTIBLE = 1e-150
"""Below this a distance counts as this: its square can still be inverted."""


@runtime_checkable
class SupportsExtent(Protocol):
    """A metric that measures components by how far the path has gone in them; found by presence."""

    @property
    def longest(self) -> float:
        """The longest step, in its own length."""
        ...

    def of_extent(self, extent: Array) -> Array:
        """The weights for the extent of each component.

        Parameters
        ----------
        extent : ndarray, shape (N + 1,)
            How far the path goes in each component; positive.

        Returns
        -------
        ndarray, shape (N + 1,)
        """
        ...

    def grown(self, current: Array, origin: Array, u: Array) -> Array:
        """The weights where a path has come to `u`.

        Parameters
        ----------
        current : ndarray, shape (N + 1,)
            The weights before.
        origin, u : ndarray, shape (N + 1,)
            The start of the path, and where it is.

        Returns
        -------
        ndarray, shape (N + 1,)
        """
        ...
