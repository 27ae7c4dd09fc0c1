"""Factorisations along a curve, in extents."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import frozen

from continuation.arrays import Array, Matrix, generic_vector
from continuation.curves.calculus import Calculus
from continuation.linear.nullspace import LONG, REFRESHED


@frozen(eq=False)
class Tangential:
    """[H_y, H_lam] with a border not orthogonal to the kernel."""

    calculus: Calculus
    row: Array

    @classmethod
    def at_start(cls, calculus: Calculus) -> Tangential:
        """Take the kernel at the start as border."""
        first = cls(calculus, generic_vector(calculus.u0.size - 1) / calculus.extent)
        u, mu = calculus.u0[:-1], float(calculus.u0[-1])
        t = first.factored(u, mu)[1] / calculus.extent
        return cls(calculus, t / float(np.linalg.norm(t)) / calculus.extent)

    def factored(self, u: Array, mu: float) -> tuple[Any, Array]:
        """Factorisation by the family, and oriented unit kernel."""
        extent, row = self.calculus.extent, self.row
        evaluator = self.calculus.evaluator(mu)
        for _ in range(REFRESHED):
            system = evaluator.factor(u, row)
            t = system.solve(np.zeros(u.size - 1), 1.0)
            size = float(np.linalg.norm(t / extent))
            if size * float(np.linalg.norm(row * extent)) <= LONG:
                break
            row = t / extent**2 / size
        return system, t / size * (system.sign or 1)


def last_column(full: Matrix) -> Array:
    """H_lam of [H_y, H_lam], dense."""
    return np.asarray(full[:, [-1]].toarray().ravel() if sp.issparse(full) else full[:, -1])
