"""Linear complementarity problems."""

from __future__ import annotations

import math
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from attrs import Attribute, Factory, field, frozen
from numpy.typing import NDArray

from continuation.arguments.checks import expect, integer
from continuation.arrays import Array, Matrix
from problems.lcp.data.bounds import bound_vector, ordered_bounds
from problems.options import finite_matrix, finite_vector

State = NDArray[np.int8]
"""For each index `LOWER`, `BETWEEN` (which imposes w_i = 0) or `UPPER`."""

LOWER, BETWEEN, UPPER = np.int8(-1), np.int8(0), np.int8(1)


def _q(value: Any) -> Array:
    nothing = (isinstance(value, (list, tuple)) and not value) or getattr(value, "shape", None) == (0,)
    return np.zeros(0) if nothing else finite_vector("q", value)


def square_matrix(value: Any) -> Matrix:
    """A finite square float matrix, dense or CSR."""
    matrix = finite_matrix("A", value)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise ValueError(f"A: expected a square matrix, found shape {matrix.shape}")
    return matrix


@frozen(eq=False, slots=False)
class MixedLCP:
    """Find x in [lower, upper] with w = A x + q >= 0 where x = lower, w <= 0 where x = upper, and w = 0 between.

    This is the affine variational inequality over a box; where lower_i = upper_i, w_i is free.

    Parameters
    ----------
    A : array_like or scipy sparse, shape (n, n)
        Sparse input stays sparse (CSR).
    q : array_like, shape (n,)
    lower, upper : array_like, shape (n,), or one number for all, optional
        Default -inf and inf.
    primal : int, optional
        Number of variables of a quadratic program among the unknowns, which come first; default 0: unknown.

    References
    ----------
    Cottle, Pang and Stone, The Linear Complementarity Problem, 1992, section 1.5; Dirkse and Ferris, "The PATH Solver",
    Optim. Methods Softw. 5, 1995.
    """

    A: Matrix = field(converter=square_matrix)
    q: Array = field(converter=_q)
    lower: Array = field(default=None)
    upper: Array = field(default=None)
    primal: int = field(default=0, kw_only=True, repr=False, validator=integer(0))
    known: dict[str, Any] = field(factory=dict, init=False, repr=False)
    """What is known of A, by name."""

    @q.validator
    def _same_order(self, attribute: Attribute[Any] | None, q: Array) -> None:
        expect(q.size == self.A.shape[0], "q", f"{self.A.shape[0]} numbers, one a row of A", q.size)

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "lower", bound_vector("lower", self.lower, self.q.size, -math.inf))
        object.__setattr__(self, "upper", bound_vector("upper", self.upper, self.q.size, math.inf))
        ordered_bounds(self.lower, self.upper)

    @property
    def n(self) -> int:
        """The order of A."""
        return self.q.size

    @property
    def sparse(self) -> bool:
        """Whether A is sparse."""
        return not isinstance(self.A, np.ndarray)

    @cached_property
    def standard(self) -> bool:
        """Whether all bounds are 0 and infinity."""
        return not self.lower.any() and bool(np.isposinf(self.upper).all())

    @cached_property
    def fixed(self) -> NDArray[np.bool_]:
        """Whether lower_i = upper_i, shape (n,)."""
        same: NDArray[np.bool_] = self.lower == self.upper
        return same

    @cached_property
    def pieces(self) -> int:
        """Number of complementary pieces."""
        ends = np.isfinite(self.lower).astype(int) + np.isfinite(self.upper) - 2 * self.fixed
        return math.prod((ends + 1).tolist())

    @property
    def near_zero(self) -> Array:
        """Point between the bounds nearest to zero, shape (n,)."""
        return self.clipped(np.zeros(self.n))

    def clipped(self, x: Array) -> Array:
        """Nearest point between the bounds.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        above: Array = np.maximum(x, self.lower)
        return above if self.standard else np.minimum(above, self.upper)

    def w(self, x: Array) -> Array:
        """A x + q.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        product: Array = self.A @ x + self.q
        return product

    def natural_map(self, x: Array, w: Array) -> Array:
        """The residual x - mid(lower, x - w, upper), for an LCP min(x, w).

        Parameters
        ----------
        x, w : ndarray, shape (n,)
        """
        return np.maximum(np.minimum(x - self.lower, w), x - self.upper)

    def states(self, x: Array, w: Array) -> State:
        """The piece of the natural map that holds a point.

        Parameters
        ----------
        x, w : ndarray, shape (n,)
        """
        if self.standard:
            return active_state(x > w)
        moved = x - w
        return _stated(moved <= self.lower, moved >= self.upper)

    def corrected(self, state: State, x: Array, w: Array) -> State:
        """The piece that signs ask for in Newton's method.

        Parameters
        ----------
        state : State
        x, w : ndarray, shape (n,)
            A point on this piece.
        """
        if self.standard:
            return active_state(np.where(state == BETWEEN, x > 0.0, w < 0.0))
        inside, above = state == BETWEEN, state == UPPER
        low = np.where(inside, x <= self.lower, ~above & ((w >= 0.0) | self.fixed))
        return _stated(low, np.where(inside, x >= self.upper, above & (w <= 0.0)))

    def at(self, state: State) -> Array:
        """Bounds that a state imposes on x, zero between.

        Parameters
        ----------
        state : State
        """
        return np.where(state == LOWER, self.lower, np.where(state == UPPER, self.upper, 0.0))

    def natural_residual(self, x: Array) -> float:
        """max_i |x - mid(lower, x - w, upper)|_i.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        return float(np.abs(self.natural_map(x, self.w(x))).max(initial=0.0))

    def scale(self, x: Array) -> float:
        """The divisor of `relative_residual`: 1 + max(|q|_inf, |A|_inf |x|_inf).

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        return 1.0 + self.size_of_terms(x)

    def size_of_terms(self, x: Array) -> float:
        """The bound max(|q|_inf, |A|_inf |x|_inf) of terms.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        return max(float(np.abs(self.q).max(initial=0.0)), self._norm * float(np.abs(x).max(initial=0.0)))

    @cached_property
    def _norm(self) -> float:
        return float(np.max(abs(self.A).sum(axis=1), initial=0.0))

    def relative_residual(self, x: Array) -> float:
        """Natural residual divided by `scale`.

        Parameters
        ----------
        x : ndarray, shape (n,)
        """
        return self.natural_residual(x) / self.scale(x)


def active_state(active: NDArray[np.bool_]) -> State:
    """The state of an LCP with w_i = 0 on an active set."""
    return np.where(active, BETWEEN, LOWER)


def _stated(low: NDArray[np.bool_], high: NDArray[np.bool_]) -> State:
    return np.where(low, LOWER, np.where(high, UPPER, BETWEEN))


@lru_cache(maxsize=64)
def _all(value: float, n: int) -> Array:
    return np.broadcast_to(value, n)


@frozen(eq=False, slots=False)
class LCP(MixedLCP):
    """LCP(q, A): find x with x >= 0, w = A x + q >= 0 and x_i w_i = 0 for all i.

    Parameters
    ----------
    A : array_like or scipy sparse, shape (n, n)
        Sparse input stays sparse (CSR).
    q : array_like, shape (n,)
        n may be 0.

    References
    ----------
    Cottle, Pang and Stone, The Linear Complementarity Problem, 1992.
    """

    # Views of one number: an LCP stores no bounds.
    lower: Array = field(init=False, repr=False, default=Factory(lambda self: _all(0.0, self.n), takes_self=True))
    upper: Array = field(init=False, repr=False, default=Factory(lambda self: _all(math.inf, self.n), takes_self=True))

    def __attrs_post_init__(self) -> None:
        """`standard` is known, and asked for at every residual."""
        vars(self)["standard"] = True

    def with_q(self, q: Any) -> LCP:
        """LCP(q, A) for another q, with what is known of A.

        Parameters
        ----------
        q : array_like, shape (n,)
        """
        vector, other = _q(q), object.__new__(LCP)
        self._same_order(None, vector)
        vars(other).update(vars(self) | {"q": vector, "known": dict(self.known)})
        return other


def require_lcp(problem: Any) -> None:
    """Raise TypeError unless `problem` is an LCP."""
    expect(isinstance(problem, LCP), "problem", "an LCP", problem, TypeError)


def require_problem(problem: Any) -> None:
    """Raise TypeError unless `problem` is a MixedLCP."""
    expect(isinstance(problem, MixedLCP), "problem", "an LCP", problem, TypeError)
