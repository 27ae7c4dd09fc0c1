"""PARDISO of the MKL by way of pypardiso: factors of any sparse matrix."""

from __future__ import annotations

import weakref
from typing import ClassVar

import numpy as np
from attrs import frozen
from scipy.sparse import csr_matrix

from continuation.arrays import Array
from continuation.linear.look import Look
from continuation.linear.superlu import SparseFactor

UNSYMMETRIC = 11
"""PARDISO's word for real matrices without symmetry, which are all that pypardiso tests."""

ENTRIES, PERTURBED = 18, 14
"""Where PARDISO counts entries of the factors, and pivots that it moved away from zero."""


@frozen
class PardisoMethod:
    """Factorisations by PARDISO.

    References
    ----------
    Schenk and Gartner, "Solving Unsymmetric Sparse Systems of Linear Equations with PARDISO", Future Gener. Comput.
    Syst. 20 (2004).
    """

    name: ClassVar[str] = "pardiso"
    needs: ClassVar[str] = "pypardiso"
    signed: ClassVar[bool] = False
    least: ClassVar[float] = np.inf
    """Only by name: on one thread it took SuperLU's time at n = 1e5 and more above, 30 ms at any order; several threads
    are what it is for."""

    def suits(self, look: Look) -> bool:
        """Whether no diagonal entry is zero: a pivot that is gets another value in place of an exchange."""
        return bool(look.diagonal.all())

    def factor(self, look: Look) -> SparseFactor | None:
        """The factors; None where a pivot was zero, about."""
        from pypardiso import PyPardisoSolver
        from pypardiso.pardiso_wrapper import PyPardisoError

        solver, matrix = PyPardisoSolver(mtype=UNSYMMETRIC), csr_matrix(look.matrix)
        try:
            solver.factorize(matrix)
        except PyPardisoError:
            return None

        def solve(rhs: Array) -> Array:
            x: Array = solver.solve(matrix, rhs)
            return x.ravel()

        # Pivots are static, and their signs are not told.
        factors = SparseFactor("PARDISO", solve, int(solver.get_iparm(ENTRIES)), lambda: 0)
        weakref.finalize(factors, solver.free_memory, everything=True)
        return None if solver.get_iparm(PERTURBED) else factors
