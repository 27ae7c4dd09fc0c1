"""One door to sparse factorisations: SuperLU, and CHOLMOD where it is installed, chosen by a look at the matrix."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
from attrs import define, evolve, field

from continuation.arrays import Array, Matrix
from continuation.linear.look import Look
from continuation.linear.superlu import SparseFactor, SuperLUMethod

METHODS = ("auto", SuperLUMethod.name, "cholmod")
"""What may be asked for."""

CHOLMOD_FROM = 1000
"""The order from which on "auto" means CHOLMOD: of five-point Laplacians it takes half of SuperLU's time from n = 2,000
on, a third at 1e5; below 400 SuperLU is quicker."""


def check_method(argument: str, name: object) -> str:
    """The name of a method, or "auto".

    `argument`: What an error calls it. Raises `ValueError` if there is no such method. Raises `ImportError` if its
    package is not installed.
    """
    if not isinstance(name, str) or name not in METHODS:
        found = repr(name) if isinstance(name, str) else type(name).__name__
        raise ValueError(f"{argument}: expected one of {', '.join(METHODS)}, found {found}")
    if name == "cholmod" and find_spec("cvxopt") is None:
        raise ImportError(f"{argument}={name!r} needs cvxopt: pip install 'pseudoarclength[{name}]'")
    return name


@define(eq=False)
class Factoring:
    """Factors sparse matrices, and keeps account of what did it.

    Attributes
    ----------
    method : str
        "auto", "superlu", or "cholmod" for what is definite.
    direct : SuperLUMethod
        What is left where nothing else suits.
    used : dict
        By name, how many matrices were factored, and the largest fill.
    """

    method: str = "auto"
    direct: SuperLUMethod = field(factory=SuperLUMethod)
    used: dict[str, tuple[int, int]] = field(factory=dict, init=False)

    def factor(self, matrix: Matrix) -> SparseFactor | None:
        """Factors of a square matrix by itself; None where it is singular.

        What turns out not to be definite is left to SuperLU.

        Parameters
        ----------
        matrix : csc_array of shape (N, N)
            In canonical format.
        """
        look = Look(matrix)
        wanted = look.n >= CHOLMOD_FROM and find_spec("cvxopt") is not None
        definite = self.method == "cholmod" or (self.method == "auto" and wanted)
        factor = (factor_definite(look) if definite else None) or self.direct.factor(look)
        if factor is not None:
            count, fill = self.used.get(factor.name, (0, 0))
            self.used[factor.name] = count + 1, max(fill, factor.fill)
        return factor

    def __str__(self) -> str:
        parts = []
        for name, (count, fill) in self.used.items():
            held = f", at most {fill:.2g} numbers" if fill else ""
            parts.append(f"{count} by {name}{held}")
        return f"Sparse factorisations: {'; '.join(parts)}." if parts else ""


def factor_definite(look: Look) -> SparseFactor | None:
    """Factors of a matrix that is positive or negative definite; None where it is neither."""
    # A discretised Laplacian is negative definite; det A = (-1)^n det(-A).
    negative = bool((look.diagonal < 0.0).all())
    look = Look(-look.matrix) if negative else look
    factor = factor_cholmod(look.matrix) if look.definite_perhaps else None
    if factor is None or not negative:
        return factor
    solve, sign = factor.solve, -1 if look.n % 2 else 1
    return evolve(factor, solve=lambda rhs: -solve(rhs), tell_sign=lambda: sign)


def factor_cholmod(matrix: Matrix) -> SparseFactor | None:
    """Supernodal Cholesky factors, by way of cvxopt; None where a pivot is not positive.

    Chen, Davis, Hager and Rajamanickam, "Algorithm 887: CHOLMOD", ACM Trans. Math. Softw. 35 (2008).
    """
    from cvxopt import cholmod, spmatrix
    from cvxopt import matrix as column

    entries = matrix.tocoo()
    lower = entries.row >= entries.col
    data, rows, columns = (np.ascontiguousarray(part[lower]) for part in (entries.data, entries.row, entries.col))
    whole = spmatrix(data, rows.astype(np.int64), columns.astype(np.int64), matrix.shape)
    factors = cholmod.symbolic(whole)
    try:
        cholmod.numeric(whole, factors)
    except ArithmeticError:
        return None

    def solve(rhs: Array) -> Array:
        x = column(rhs)
        cholmod.solve(factors, x)
        return np.array(x).ravel()

    # How many numbers they are cvxopt does not say.
    return SparseFactor("CHOLMOD", solve, 0, lambda: 1)
