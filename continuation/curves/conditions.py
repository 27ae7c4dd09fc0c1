"""Conditions of folds, Hopf and branch points."""

from __future__ import annotations

from functools import cache

import numpy as np
import scipy.sparse as sp
from attrs import evolve, frozen

from continuation.arrays import Array, Matrix
from continuation.curves.calculus import Calculus
from continuation.curves.here import CurvePoint
from continuation.curves.local import Tangential, last_column
from continuation.events.singularity import full_derivative
from continuation.linear.nullspace import NearlySingular, null_vectors
from continuation.status import Kind


@frozen(eq=False)
class Eigenvalue:
    """H_y is singular (fold), has an eigenvalue i omega (Hopf point), or H' loses a rank (branch point).

    The condition is s = 0 in [[H_y - i omega I, b], [c*, 0]] (v, s) = (0, 1); omega is 0 for folds (Griewank and
    Reddien, SIAM J. Numer. Anal. 21, 1984) and unknown for Hopf points (IMA J. Numer. Anal. 3, 1983).

    At branch points w'H_lam = 0 too, with the left null vector w: H + (w'H_lam) b = 0 and s = 0 are regular at simple
    ones with transversal branches, and w'H_lam stays zero if the family keeps them (Moore, SIAM J. Numer. Anal. 17,
    1980, makes it an unknown).
    """

    calculus: Calculus
    kind: Kind
    tangential: Tangential | None
    b: Array
    c: Array

    @classmethod
    def at_start(cls, calculus: Calculus, kind: Kind, frequency: float) -> Eigenvalue:
        """Make borders at the start."""
        tangential = Tangential.at_start(calculus) if kind == Kind.HOPF else None
        found = cls(calculus, kind, tangential, np.empty(0), np.empty(0))
        u, mu = calculus.u0[:-1], float(calculus.u0[-1])
        b, c = calculus.borders(found.matrix(full_derivative(calculus.evaluator(mu), u), frequency))
        return evolve(found, b=b, c=c)

    @property
    def beside(self) -> tuple[str, ...]:
        """Name of the additional unknown, if any."""
        return () if self.tangential is None else ("frequency",)

    def matrix(self, full: Matrix, omega: float) -> Matrix:
        """H_y - i omega, scaled, from [H_y, H_lam]."""
        matrix = full[:, :-1]
        if self.kind == Kind.HOPF:
            matrix = matrix - 1j * omega * (
                sp.eye_array(len(self.calculus.rows)) if sp.issparse(full) else np.eye(len(full))
            )
        return self.calculus.scaled(matrix)

    def near(self, full: Matrix, omega: float) -> NearlySingular:
        """The null vectors."""
        return null_vectors(self.matrix(full, omega), self.b, self.c)

    def null_vector(self, u: Array) -> Array:
        """Null vector, of unit length in extents."""
        member, beside = np.split(u[:-1], [self.calculus.extent.size])
        full = full_derivative(self.calculus.evaluator(float(u[-1])), member)
        right = self.near(full, float(beside.sum())).right
        return right / float(np.linalg.norm(right))

    def at(self, u: Array, beside: float, mu: float) -> CurvePoint:
        """The condition at a point."""
        calculus = self.calculus
        full = full_derivative(calculus.evaluator(mu), u)
        near = self.near(full, beside)
        v, w = np.append(calculus.extent[:-1] * near.right, 0.0), near.left.conj() / calculus.rows

        def gradient(part: Array) -> Array:
            return -calculus.second(u, mu, part, w)

        if (tangential := self.tangential) is not None:
            kernel = cache(lambda: tangential.factored(u, mu))

            def both() -> Array:
                row = np.insert(gradient(v.real) + 1j * gradient(v.imag), u.size, 1j * (w @ v[:-1]))
                return np.array([row.real, row.imag])

            values, signs = np.array([near.s.real, near.s.imag]), {"zero-Hopf": lambda _: float(kernel()[1][-1])}
            return CurvePoint(calculus, u, mu, values, both, lambda: kernel()[0], np.zeros((w.size, 1)), signs=signs)
        base = calculus.unscaled(near.factors)
        sign = base.sign
        values = np.array([sign * near.s.real])
        if self.kind == Kind.TURNING_POINT:
            # det and the product of null vectors change sign with a border.
            signs = {
                "cusp": lambda here: float(-sign * here.rows[0, :-1] @ v),
                "Bogdanov-Takens": lambda _: float(sign * (w @ v[:-1])),
            }
            one = np.empty((w.size, 0))
            return CurvePoint(
                calculus, u, mu, values, lambda: sign * gradient(v)[None, :], lambda: base, one, signs=signs
            )
        # The extent of lam makes the term comparable to H in any unit.
        reach = calculus.extent[-1]
        z = base.solve(reach * last_column(full), 0.0)

        def gradients() -> Array:
            other = gradient(np.append(-z[:-1], reach))
            return np.array([np.insert(sign * gradient(v), u.size, 0.0), np.insert(other, u.size, 1.0)])

        column = (calculus.rows * near.border)[:, None]
        return CurvePoint(calculus, u, mu, values, gradients, lambda: base, column, hidden=float(z[-1]))
