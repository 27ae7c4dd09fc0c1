"""Robinson's normal map: complementarity with a parameter."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp
from attrs import field, frozen

from continuation.arguments.checks import expect
from continuation.arrays import Array, Matrix
from continuation.evaluation.derivatives import check_derivative, from_residual
from continuation.linear import Banded
from problems.bibliography import ROBINSON
from problems.lcp.data.bounds import bound_vector, ordered_bounds, without_equal_bounds
from problems.lcp.data.matrix_structure import scaled
from problems.options import finite, finite_or_none, finite_vector, quiet, real_array

Force = Callable[[Any, Any], Any]
"""``F(x, lam) -> (n,)``; jets pass through plain numpy."""

Slope = Callable[[Array, float], tuple[Matrix, Array]]
"""``(F_x, F_lam)``: dense, scipy sparse or `Banded`, and a vector."""


def _start(x: Any) -> Array:
    return finite_vector("x0", x)


@frozen(eq=False)
class AffineForce:
    """F(x, lam) = A x + q + lam d."""

    A: Matrix
    q: Array
    d: Array

    def __call__(self, x: Any, lam: Any) -> Any:
        """The value."""
        return self.A @ x + self.q + lam * self.d

    def slope(self, x: Array, lam: float) -> tuple[Matrix, Array]:
        """(A, d)."""
        return self.A, self.d


@frozen(eq=False, slots=False)
class NormalMap:
    """Solutions x(lam) in [lower, upper]: F_i(x, lam) >= 0 at a lower bound, <= 0 at an upper one, else 0.

    H(z, lam) = F(x, lam) + z - x, where x projects z onto the bounds, is smooth while no z_i is on a bound.

    Parameters
    ----------
    F : callable
        ``F(x, lam) -> (n,)``.
    jacobian : callable or None
        ``jacobian(x, lam) -> (F_x, F_lam)``, F_x dense, sparse or `Banded`. By default Taylor arithmetic, else
        differences.
    x0 : array_like, shape (n,)
        Approximate solution at `lam0`.
    lam0 : float
    lower, upper : array_like, shape (n,), or float
        May be infinite; default 0 and inf.
    lower_rate, upper_rate : array_like, shape (n,), or float
        Bounds are lower + lam * lower_rate and upper + lam * upper_rate.
    target : float or None, default 0

    References
    ----------
    Robinson, Math. Oper. Res. 17 (1992) 691-714.
    """

    F: Force
    jacobian_of_F: Slope | None = field(default=None, alias="jacobian")
    x0: Array = field(kw_only=True, converter=_start)
    lam0: float = field(kw_only=True, validator=finite)
    lower: Any = field(default=0.0, kw_only=True)
    upper: Any = field(default=None, kw_only=True)
    lower_rate: Any = field(default=0.0, kw_only=True)
    upper_rate: Any = field(default=0.0, kw_only=True)
    target: float | None = field(default=0.0, kw_only=True, validator=finite_or_none)
    references: ClassVar[tuple[str, ...]] = (ROBINSON,)
    problem_class: ClassVar[str] = "complementarity problems with a parameter"

    def __attrs_post_init__(self) -> None:
        n = self.x0.size
        for name, default in (("lower", -np.inf), ("upper", np.inf)):
            object.__setattr__(self, name, bound_vector(name, getattr(self, name), n, default))
            rate = bound_vector(f"{name}_rate", getattr(self, f"{name}_rate"), n, np.inf)
            object.__setattr__(self, f"{name}_rate", finite_vector(f"{name}_rate", rate))
        lower, upper = self.bounds(self.lam0)
        ordered_bounds(lower, upper)
        without_equal_bounds(lower, upper)
        expect(callable(self.F), "F", "a function", self.F, TypeError)
        x = np.clip(self.x0, lower, upper)
        finite_vector("F(x0, lam0)", quiet(self.F)(x, self.lam0))
        if self.jacobian_of_F is None:
            object.__setattr__(self, "jacobian_of_F", from_residual(self.F, (x, self.lam0)))
        assert self.jacobian_of_F is not None
        expect(callable(self.jacobian_of_F), "jacobian", "a function", self.jacobian_of_F, TypeError)
        check_derivative(quiet(self.jacobian_of_F)(x.copy(), self.lam0), n)

    @classmethod
    def affine(cls, A: Matrix, q: Any, d: Any, **more: Any) -> NormalMap:
        """F(x, lam) = A x + q + lam d, with any bounds.

        Parameters
        ----------
        A : array_like, scipy sparse array or Banded, shape (n, n)
        q, d : array_like, shape (n,)
        **more
            `x0`, `lam0` and others.
        """
        if not isinstance(A, Banded):
            A = sp.csc_array(A) if sp.issparse(A) else real_array("A", A)
        force = AffineForce(A, finite_vector("q", q), finite_vector("d", d))
        found, n = (A.shape, force.q.shape, force.d.shape), force.q.size
        expect(found == ((n, n), (n,), (n,)), "A", "a square matrix, and q and d of its size, by their shapes", found)
        return cls(force, force.slope, **more)

    def bounds(self, lam: float) -> tuple[Array, Array]:
        """Lower and upper bounds at lam.

        Parameters
        ----------
        lam : float
        """
        return self.lower + lam * self.lower_rate, self.upper + lam * self.upper_rate

    def x(self, z: Array, lam: float = 0.0) -> Array:
        """Project z onto the bounds at lam.

        Parameters
        ----------
        z : ndarray, shape (n,)
        lam : float
        """
        return np.clip(z, *self.bounds(lam))

    def start(self) -> tuple[Array, float]:
        """The start z = x - F(x, lam)."""
        x = self.x(self.x0, self.lam0)
        z = x - np.asarray(self.F(x, self.lam0), dtype=float)
        return z, self.lam0

    @quiet
    def residual(self, y: Array, lam: float) -> Array:
        """F(x, lam) + z - x."""
        x = self.x(y, lam)
        value: Array = self.F(x, lam) + y - x
        return value

    def switches(self, y: Any, lam: float) -> Any:
        """Distances from finite bounds; negative beyond."""
        below, above = np.isfinite(self.lower), np.isfinite(self.upper)
        lower = self.lower[below] + lam * self.lower_rate[below]
        upper = self.upper[above] + lam * self.upper_rate[above]
        return np.concatenate([y[below] - lower, upper - y[above]])

    def piece(self, signs: Array) -> NormalPiece:
        """The smooth map with unknowns at the bounds whose `switches` have negative `signs`."""
        below, above = np.isfinite(self.lower), np.isfinite(self.upper)
        m = int(below.sum())
        low, high = np.zeros(self.lower.shape, dtype=bool), np.zeros(self.lower.shape, dtype=bool)
        low[below], high[above] = signs[:m] < 0, signs[m:] < 0
        clamped = np.where(low, self.lower, np.where(high, self.upper, 0.0))
        moving = np.where(low, self.lower_rate, np.where(high, self.upper_rate, 0.0))
        return NormalPiece(self, ~(low | high), clamped, moving)


@frozen(eq=False)
class NormalPiece:
    """The normal map with some unknowns at clamped + lam * moving."""

    whole: NormalMap
    free: Any
    clamped: Array
    moving: Array

    def start(self) -> tuple[Array, float]:
        """The start."""
        return self.whole.start()

    @quiet
    def residual(self, y: Any, lam: Any) -> Any:
        """The residual."""
        on, held = 1.0 * self.free, self.clamped + lam * self.moving
        return self.whole.F(y * on + held, lam) + y * (1.0 - on) - held

    @quiet
    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """Columns of F_x for free unknowns, else of the identity."""
        assert self.whole.jacobian_of_F is not None
        F_x, F_lam = self.whole.jacobian_of_F(np.where(self.free, y, self.clamped + lam * self.moving), lam)
        column, on = np.asarray(F_lam, dtype=float), 1.0 * self.free
        if self.moving.any():
            column = column + F_x @ self.moving - self.moving
        return scaled(F_x, on, 1.0 - on), column
