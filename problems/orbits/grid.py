"""Periodic piecewise polynomials and adapted meshes."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from attrs import field, frozen
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from continuation.arrays import Array

MESH_FLOOR = 0.05
"""Part of the mean density added everywhere, so that resting parts are resolved. The period error of van der Pol's
oscillator (mu = 10) is 1.2e-8 without it, 0.8e-8 with it, 2e-8 with twice as much."""


BETWEEN_NODES = 8
"""Samples between nodes for extreme values; parabolas have fourth-order errors."""


@frozen(eq=False, slots=False)
class Grid:
    """A mesh of [0, 1], shape (N + 1,), with continuous periodic polynomials of degree m.

    Functions are values at m Chebyshev-Lobatto nodes per interval, left end first, shape (N m, ...).
    """

    mesh: Array
    degree: int
    widths: Array = field(init=False)

    @widths.default
    def _widths(self) -> Array:
        return np.diff(self.mesh)

    @property
    def intervals(self) -> int:
        """The number N."""
        return self.widths.size

    @cached_property
    def inner(self) -> Array:
        """Nodes of [0, 1], shape (m + 1,)."""
        return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(self.degree + 1) / self.degree))

    @cached_property
    def gauss(self) -> tuple[Array, Array]:
        """The m Gauss points of [0, 1], and weights."""
        points, weights = leggauss(self.degree)
        return np.asarray(0.5 * points + 0.5), np.asarray(0.5 * weights)

    @cached_property
    def coefficients(self) -> Array:
        """Maps nodal values to power coefficients."""
        return np.asarray(np.linalg.inv(np.vander(self.inner, increasing=True)))

    @cached_property
    def value(self) -> Array:
        """Maps nodal values to values at Gauss points."""
        return self._powers(self.gauss[0]) @ self.coefficients

    @cached_property
    def slope(self) -> Array:
        """Maps nodal values to derivatives at Gauss points."""
        powers = np.zeros((self.degree, self.degree + 1))
        powers[:, 1:] = self._powers(self.gauss[0])[:, :-1] * np.arange(1, self.degree + 1)
        return powers @ self.coefficients

    @cached_property
    def index(self) -> NDArray[np.intp]:
        """Nodes of each interval, shape (N, m + 1)."""
        found = np.arange(self.intervals)[:, None] * self.degree + np.arange(self.degree + 1)
        return found % (self.intervals * self.degree)

    @cached_property
    def nodes(self) -> Array:
        """All nodes, shape (N m,)."""
        return (self.mesh[:-1, None] + self.widths[:, None] * self.inner[:-1]).ravel()

    @cached_property
    def quadrature(self) -> Array:
        """Gauss weights, shape (N, m)."""
        return self.widths[:, None] * self.gauss[1]

    def values(self, X: Array) -> Array:
        """Values at the Gauss points, shape (N, m, n)."""
        return np.asarray(self.value @ X[self.index])

    def slopes(self, X: Array) -> Array:
        """Derivatives at the Gauss points."""
        return np.asarray(self.slope @ X[self.index] / self.widths[:, None, None])

    def at(self, X: Array, t: Array) -> Array:
        """Values at times, shape (len(t), n)."""
        t = np.asarray(t) % 1.0
        i = np.clip(np.searchsorted(self.mesh, t, side="right") - 1, 0, self.intervals - 1)
        powers = self._powers((t - self.mesh[i]) / self.widths[i]) @ self.coefficients
        return np.asarray(np.einsum("tk,tkn->tn", powers, X[self.index[i]]))

    def extremes(self, X: Array) -> tuple[Array, Array]:
        """Minimum and maximum of each component."""
        edges = np.append(self.nodes, 1.0)
        t = (edges[:-1, None] + np.diff(edges)[:, None] * np.arange(BETWEEN_NODES) / BETWEEN_NODES).ravel()
        X = self.at(X, t)
        found = []
        for sign in (-1.0, 1.0):
            k = np.argmax(sign * X, axis=0)
            three = [np.take_along_axis(X, (k + j)[None] % len(t), axis=0)[0] for j in (-1, 0, 1)]
            times = [t[(k + j) % len(t)] + (k + j) // len(t) for j in (-1, 0, 1)]
            left, right = ((three[1] - three[j]) / (times[1] - times[j]) for j in (0, 2))
            bend = (right - left) / (times[2] - times[0])
            middle = left + bend * (times[1] - times[0])
            found.append(three[1] - np.where(bend != 0.0, middle**2 / np.where(bend != 0.0, 4.0 * bend, 1.0), 0.0))
        return found[0], found[1]

    def _powers(self, t: Array) -> Array:
        return np.vander(t, self.degree + 1, increasing=True)

    def highest(self, X: Array) -> Array:
        """Size of derivative m + 1, shape (N,), from jumps of derivative m.

        (de Boor, in: Conference on the Numerical Solution of Differential Equations, 1973; as in AUTO.)
        """
        top = np.einsum("k,ikn->in", self.coefficients[-1], X[self.index]) / self.widths[:, None] ** self.degree
        between = 0.5 * (self.widths + np.roll(self.widths, 1))
        jumps = np.linalg.norm(top - np.roll(top, 1, axis=0), axis=1) / between
        return np.asarray(0.5 * (jumps + np.roll(jumps, -1)))

    def error(self, X: Array) -> float:
        """Interpolation error in X's units."""
        nodal = np.polynomial.polynomial.polyfromroots(self.inner)
        t = np.linspace(0.0, 1.0, 101)
        largest = np.abs(np.polynomial.polynomial.polyval(t, nodal)).max()
        return float((self.highest(X) * self.widths ** (self.degree + 1)).max() * largest)

    def suited(self, X: Array, intervals: int, degree: int) -> tuple[Grid, Array]:
        """A grid with about equal errors on all intervals, and its nodes' times here.

        It begins where the orbit is fastest: near an equilibrium, velocity and growing perturbations are nearly
        parallel.
        """
        density = self.highest(X) ** (1.0 / (self.degree + 1))
        density = density + MESH_FLOOR * float(density @ self.widths) if density.any() else np.ones_like(density)
        grown = np.append(0.0, np.cumsum(density * self.widths))
        mesh = np.interp(np.linspace(0.0, grown[-1], intervals + 1), grown, self.mesh)
        widths = np.diff(mesh)
        k = int(np.argmax(np.linalg.norm(np.diff(self.at(X, mesh), axis=0), axis=1) / widths))
        turned = np.append(0.0, np.cumsum(np.roll(widths, -k)))
        turned[-1] = 1.0
        new = Grid(turned, degree)
        return new, new.nodes + mesh[k]
