"""Sparse factorisations by SuperLU, or by CHOLMOD if installed."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
from attrs import define, evolve, field

from continuation.arrays import Array, Matrix
from continuation.linear.look import Look
from continuation.linear.superlu import SparseFactor, SuperLUMethod

METHODS = ("auto", SuperLUMethod.name, "cholmod")

CHOLMOD_FROM = 1000
"""Least order for CHOLMOD: on five-point Laplacians it takes half of SuperLU's time from 2,000 on, more below 400."""


def check_method(argument: str, name: object) -> str:
    """The method's name; ValueError if unknown, ImportError if not installed."""
    if not isinstance(name, str) or name not in METHODS:
        found = repr(name) if isinstance(name, str) else type(name).__name__
        raise ValueError(f"{argument}: expected one of {', '.join(METHODS)}, found {found}")
    if name == "cholmod" and find_spec("cvxopt") is None:
        raise ImportError(f"{argument}={name!r} needs cvxopt: pip install 'pseudoarclength[{name}]'")
    return name


@define(eq=False)
class Factoring:
    """Factors sparse matrices.

    `method`: "auto", "superlu", or "cholmod" for definite matrices. `direct`: for the others. `used`: matrices and
    largest fill by name.
    """

    method: str = "auto"
    direct: SuperLUMethod = field(factory=SuperLUMethod)
    used: dict[str, tuple[int, int]] = field(factory=dict, init=False)

    def factor(self, matrix: Matrix) -> SparseFactor | None:
        """Factors of a square matrix, csc, in canonical format; None if singular."""
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
    """Factors of a positive or negative definite matrix, or None."""
    # A discretised Laplacian is negative definite; det A = (-1)^n det(-A).
    negative = bool((look.diagonal < 0.0).all())
    look = Look(-look.matrix) if negative else look
    factor = factor_cholmod(look.matrix) if look.definite_perhaps else None
    if factor is None or not negative:
        return factor
    solve, sign = factor.solve, -1 if look.n % 2 else 1
    return evolve(factor, solve=lambda rhs: -solve(rhs), tell_sign=lambda: sign)


def factor_cholmod(matrix: Matrix) -> SparseFactor | None:
    """Supernodal Cholesky factors (Chen et al., ACM Trans. Math. Softw. 35 (2008)); None if a pivot is not positive."""
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

    # cvxopt does not tell the fill.
    return SparseFactor("CHOLMOD", solve, 0, lambda: 1)
