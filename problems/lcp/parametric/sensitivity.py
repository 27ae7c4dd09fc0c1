"""Derivatives of a solution by A and q."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import frozen
from numpy.typing import NDArray

from continuation.arguments.checks import expect
from continuation.arrays import EPS, Array
from problems.lcp.data.problem import MixedLCP
from problems.lcp.parametric.basis import Basis, SingularBasisError
from problems.lcp.parametric.corner import rays
from problems.options import finite_vector, real_array

BIACTIVE = 1e-10
"""Smaller |w_i|, relative to its row's terms, is zero."""


class NotDifferentiableError(ValueError):
    """The solution is not isolated, or moves in no or several directions."""


@frozen(eq=False)
class Gradient:
    """Derivative of a loss with gradient g by x: ``d loss = q . dq + sum(A * dA)``.

    Attributes
    ----------
    q : ndarray, shape (n,)
    A : ndarray, shape (n, n)
    one_sided : bool
        Whether biactive indices exist; they are held at bounds.
    """

    q: Array
    A: Array
    one_sided: bool


@frozen(eq=False)
class Sensitivity:
    """Derivatives of a solution by A and q.

    Attributes
    ----------
    x : ndarray, shape (n,)
    moving : ndarray of int
        Indices off their bounds, with w_i = 0.
    biactive : ndarray of int
        Indices at a bound with w_i = 0.
    side : ndarray, shape (n,)
        1 if the lower bound is nearer, else -1.
    basis : Basis
        LU of A on the moving indices.
    A : ndarray, shape (n, n)
    """

    x: Array
    moving: NDArray[np.intp]
    biactive: NDArray[np.intp]
    side: Array
    basis: Basis
    A: Array

    @property
    def differentiable(self) -> bool:
        """Whether no index is biactive."""
        return not self.biactive.size

    def jvp(self, dq: Any = None, dA: Any = None) -> Array:
        """The derivative of x along (dq, dA), one-sided at biactive indices.

        Parameters
        ----------
        dq : array_like, shape (n,), optional
        dA : array_like, shape (n, n), optional

        Raises
        ------
        NotDifferentiableError
            If biactive x move in no direction, or in several.

        References
        ----------
        Cottle, Pang and Stone, section 7.4; Robinson, Math. Oper. Res. 5, 1980.
        """
        n, at, side = self.x.size, self.biactive, self.side[self.biactive]
        moved = np.zeros(n) if dq is None else finite_vector("dq", dq, n)
        if dA is not None:
            moved = moved + _square("dA", dA, n) @ self.x
        z, left = self.basis.solve(np.column_stack([self.A[:, at] * side, moved]))
        small = side[:, None] * left[at]
        grown = _only(small[:, :-1], small[:, -1])
        dx = np.zeros(n)
        dx[at] = side * grown
        dx[self.moving] = z @ np.append(grown, 1.0)
        return dx

    def vjp(self, g: Any) -> Gradient:
        """The gradient by A and q of a loss with gradient g by x.

        Parameters
        ----------
        g : array_like, shape (n,)
        """
        n, inside = self.x.size, self.moving
        q = np.zeros(n)
        q[inside] = -self.basis.inverse(finite_vector("g", g, n)[inside], transposed=1)
        return Gradient(q, np.outer(q, self.x), not self.differentiable)


def sensitivity(problem: MixedLCP, x: Array) -> Sensitivity:
    """Derivatives of a solution by the data.

    Parameters
    ----------
    problem : LCP or MixedLCP
    x : ndarray, shape (n,)

    Raises
    ------
    NotDifferentiableError
        If A is singular on the indices that are between their bounds.
    """
    w = problem.w(x)
    A = problem.A.toarray() if problem.sparse else problem.A
    terms = np.abs(A) @ np.abs(x) + np.abs(problem.q)
    room = np.minimum(x - problem.lower, problem.upper - x)
    with np.errstate(invalid="ignore"):
        off = (np.abs(A) * room > BIACTIVE * terms[:, None]).any(axis=0) | np.isinf(room)
    inside = np.flatnonzero(off)
    at = np.flatnonzero(~off & ~problem.fixed & (np.abs(w) <= BIACTIVE * terms))
    size = np.abs(A[np.ix_(inside, inside)]).max(initial=0.0)
    try:
        basis = Basis.of(inside, inside, A[:, inside], EPS * inside.size * size)
    except SingularBasisError:
        said = "x: expected an isolated solution, found A singular where x is off its bounds"
        raise NotDifferentiableError(said) from None
    side = np.where(x - problem.lower <= problem.upper - x, 1.0, -1.0)
    return Sensitivity(x, inside, at, side, basis, A)


def _only(S: Array, r: Array) -> Array:
    found = [ray.grown / ray.driven for ray in rays(S, r) if ray.driven > 0.0]
    if len(found) != 1:
        raise NotDifferentiableError(
            f"dq, dA: expected a direction in which the solution moves one way, found {len(found) or 'no'} ways"
        )
    return found[0]


def _square(name: str, value: Any, n: int) -> Array:
    matrix = real_array(name, value)
    expect(matrix.shape == (n, n) and np.isfinite(matrix).all(), name, f"finite numbers of shape {(n, n)}", matrix)
    return matrix
