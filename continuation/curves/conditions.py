"""Conditions on H_y: that it is singular, that H' is, that it has a pair of imaginary eigenvalues."""

from __future__ import annotations

from functools import cache
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.curves.calculus import Calculus
from continuation.curves.local import Local, Scaled, Tangential, last_column
from continuation.events.singularity import full_derivative
from continuation.linear.nullspace import null_vectors


@frozen(eq=False)
class Singular:
    """H_y is singular: a fold; with `branches`, H' = [H_y, H_lam] loses a rank: a branch point.

    Folds: s = 0 in [[H_y, b], [c', 0]] (v, s) = (0, 1) (Griewank and Reddien, SIAM J. Numer. Anal. 21, 1984).

    Branch points: w'H_lam = 0 besides, one equation too many, since H = 0 loses a rank. It is added to H, along b:
    H + (w'H_lam) b = 0 and s = 0 are regular at every simple branch point whose branches cross at an angle,
    pitchforks among them, and no symmetry has to be named. Where the family keeps its branch points, as symmetric ones
    do, w'H_lam is zero all along. (Moore, SIAM J. Numer. Anal. 17, 1980, has an unknown of its own for that number.)
    """

    scaled: Scaled
    b: Array
    c: Array
    branches: bool
    beside: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def at_start(cls, calculus: Calculus, branches: bool) -> Singular:
        """With borders made for the start."""
        scaled = Scaled.at_start(calculus)
        u, mu = calculus.u0[:-1], float(calculus.u0[-1])
        b, c = scaled.first(scaled.times(full_derivative(calculus.evaluator(mu), u)[:, :-1]))
        return cls(scaled, b, c, branches)

    def null_vector(self, u: Array) -> Array:
        """Of H_y at a point of the curve, behind which is mu; of length one in the extents of the start."""
        full = full_derivative(self.scaled.calculus.evaluator(float(u[-1])), u[:-1])
        right = null_vectors(self.scaled.times(full[:, :-1]), self.b, self.c).right
        return right / float(np.linalg.norm(right))

    def at(self, u: Array, beside: float, mu: float) -> Local:
        """The condition at a point."""
        scaled, calculus = self.scaled, self.scaled.calculus
        full = full_derivative(calculus.evaluator(mu), u)
        near = null_vectors(scaled.times(full[:, :-1]), self.b, self.c)
        base = scaled.unscaled(near.factors)
        sign = base.sign
        v, w = np.append(scaled.extent * near.right, 0.0), near.left / scaled.rows

        def gradient() -> Array:
            return -sign * calculus.second(u, mu, v, w)

        values, empty = np.array([sign * near.s.real]), np.empty((w.size, 0))
        if not self.branches:
            signs = {
                "cusp": lambda rows: float(-sign * rows[0, :-1] @ v),
                # The sign of the determinant changes with either border's side, as the product of the vectors does.
                "Bogdanov-Takens": lambda _: float(sign * (w @ v[:-1])),
            }
            return Local(values, lambda: gradient()[None, :], lambda: base, empty, signs=signs)
        # By the extent of lam: what is added to H is then of its size, in any unit.
        reach = calculus.extent[-1]
        z = base.solve(reach * last_column(full), 0.0)

        def gradients() -> Array:
            other = calculus.second(u, mu, np.append(-z[:-1], reach), w)
            return np.array([np.insert(gradient(), u.size, 0.0), np.insert(-other, u.size, 1.0)])

        return Local(values, gradients, lambda: base, (scaled.rows * near.border)[:, None], hidden=float(z[-1]))


@frozen(eq=False)
class HopfCondition:
    """i omega is an eigenvalue of H_y; omega is an unknown.

    s = 0 in [[H_y - i omega I, b], [c*, 0]] (v, s) = (0, 1): two equations, the real and the imaginary part
    (Griewank and Reddien, IMA J. Numer. Anal. 3, 1983). No square of H_y is formed, so it stays sparse.
    """

    scaled: Scaled
    b: Array
    c: Array
    tangential: Tangential
    beside: ClassVar[tuple[str, ...]] = ("frequency",)

    @classmethod
    def at_start(cls, calculus: Calculus, frequency: float) -> HopfCondition:
        """With borders made for the start."""
        scaled, empty = Scaled.at_start(calculus), np.empty(0)
        u, mu = calculus.u0[:-1], float(calculus.u0[-1])
        found = cls(scaled, empty, empty, Tangential.at_start(calculus))
        b, c = scaled.first(found._matrix(u, frequency, mu))
        return cls(scaled, b, c, found.tangential)

    def null_vector(self, u: Array) -> Array:
        """Of H_y - i omega at a point of the curve, complex, in the extents of the start."""
        return null_vectors(self._matrix(u[:-2], float(u[-2]), float(u[-1])), self.b, self.c).right

    def _matrix(self, u: Array, omega: float, mu: float) -> Matrix:
        full = full_derivative(self.scaled.calculus.evaluator(mu), u)[:, :-1]
        eye = sp.eye_array(u.size - 1) if sp.issparse(full) else np.eye(u.size - 1)
        return self.scaled.times(full - 1j * omega * eye)

    def at(self, u: Array, beside: float, mu: float) -> Local:
        """The condition at a point."""
        scaled, calculus = self.scaled, self.scaled.calculus
        near = null_vectors(self._matrix(u, beside, mu), self.b, self.c)
        v, w = scaled.extent * near.right, near.left.conj() / scaled.rows

        def gradients() -> Array:
            real, imaginary = (calculus.second(u, mu, np.append(part, 0.0), w) for part in (v.real, v.imag))
            row = np.insert(-(real + 1j * imaginary), u.size, 1j * (w @ v))
            return np.array([row.real, row.imag])

        values, signs = np.array([near.s.real, near.s.imag]), {"zero-Hopf": lambda _: float(kernel()[1][-1])}

        @cache
        def kernel() -> tuple[Any, Array]:
            return self.tangential.factored(u, mu)

        return Local(values, gradients, lambda: kernel()[0], np.zeros((w.size, 1)), signs=signs)
