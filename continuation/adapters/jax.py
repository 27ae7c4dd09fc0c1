"""A residual in JAX: compiled, with its derivatives, products and Taylor coefficients."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import factorial
from typing import Any

import numpy as np
from attrs import field, frozen
from scipy.sparse.linalg import LinearOperator

from continuation.adapters.given import library, started
from continuation.arguments.checks import complain
from continuation.arrays import Array, Matrix
from continuation.homotopy import TangentPoint

KINDS = ("dense", "sparse", "operator")


@frozen(eq=False)
class JaxHomotopy:
    """A homotopy whose residual is JAX's; see `from_jax`."""

    function: Callable[[Any, Any], Any]
    y0: Array
    lam0: float
    target: float | None
    kind: str
    jacobian: Callable[[Array, float], tuple[Matrix, Array]] = field(init=False)
    """Not there where products make it."""
    taylor: Callable[[TangentPoint, int], Array] = field(init=False)
    """Not there where `jax.experimental.jet` does not know a function that is used."""
    _residual: Any = field(init=False)
    _whole: Any = field(init=False)
    _product: Any = field(init=False)
    _series: Any = field(init=False)

    def __attrs_post_init__(self) -> None:
        jax, jet = library("jax"), library("jax.experimental.jet")

        def at(u: Any) -> Any:
            return self.function(u[:-1], u[-1])

        def product(u: Any, v: Any) -> Any:
            return jax.jvp(at, (u,), (v,))[1]

        def series(u: Any, terms: Any) -> Any:
            return jax.numpy.stack(jet.jet(at, (u,), (list(terms),))[1])

        put = partial(object.__setattr__, self)
        put("_residual", jax.jit(at))
        put("_whole", jax.jit(jax.jacfwd(at)))
        put("_product", jax.jit(product))
        put("_series", jax.jit(series))
        u = np.append(self.y0, self.lam0)
        found = jax.eval_shape(at, u)
        if getattr(found, "shape", None) != self.y0.shape or found.dtype != np.float64:
            wanted = f"a function of (y, lam) that gives float64 numbers, shape {self.y0.shape}"
            raise complain(ValueError, "residual", wanted, found)
        try:
            jax.eval_shape(series, u, np.zeros((2, u.size)))
            put("taylor", self._taylor)
        except (KeyError, NotImplementedError, TypeError, ValueError):
            # A function without a rule in jet: points of the path serve then. Nested forward derivatives would, too,
            # but of three unknowns order 4, 6, 8 take 0.5, 2.4, 18 s to compile.
            pass
        if self.kind != "sparse":
            put("jacobian", self._dense if self.kind == "dense" else self._operator)

    def __reduce__(self) -> Any:
        more = partial(from_jax, target=self.target, jacobian=self.kind)
        return more, (self.function, (self.y0, self.lam0))

    def start(self) -> tuple[Array, float]:
        """The given start."""
        return self.y0.copy(), self.lam0

    def residual(self, y: Array, lam: float) -> Array:
        """H, compiled."""
        return np.asarray(self._residual(np.append(np.asarray(y, dtype=float), lam)))

    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """H'(y, lam) v, one forward derivative."""
        return np.asarray(self._product(np.append(y, lam), v))

    def _dense(self, y: Array, lam: float) -> tuple[Array, Array]:
        whole = np.asarray(self._whole(np.append(y, lam)))
        return whole[:, :-1], whole[:, -1]

    def _operator(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        n, u = y.size, np.append(y, lam)

        def matvec(v: Array) -> Array:
            return np.asarray(self._product(u, np.append(np.ravel(v), 0.0)))

        return LinearOperator((n, n), matvec=matvec, dtype=float), np.asarray(self._product(u, np.eye(n + 1)[n]))

    def _taylor(self, point: TangentPoint, order: int) -> Array:
        coefficients = np.zeros((order + 1, point.u.size))
        coefficients[:2] = point.u, point.tangent
        factorials = np.array([float(factorial(k)) for k in range(order + 1)])[:, None]
        for k in range(2, order + 1):
            # All orders each time, zeros beyond k: a series of another length would be compiled anew.
            defect = self._series(point.u, (coefficients * factorials)[1:])[k - 1]
            coefficients[k] = point.solve(-np.asarray(defect) / factorials[k, 0])
        return coefficients


def from_jax(
    residual: Callable[[Any, Any], Any],
    start: tuple[Any, float],
    *,
    target: float | None = 0.0,
    jacobian: str = "dense",
) -> JaxHomotopy:
    """Make a homotopy of a residual in JAX.

    It is compiled; the derivative, products with it, and the coefficients of SERIES are JAX's, and leave its device
    only as numbers.

    Parameters
    ----------
    residual : callable
        ``residual(y, lam) -> (N,)`` of `jax.numpy`, pure.
    start : tuple
    target : float or None
        As of `continuation.from_functions`.
    jacobian : str
        "dense" by forward derivatives (there is one column more than rows); "sparse" by products, in groups of columns
        that share no equation; "operator" for GMRES.

    Raises
    ------
    ImportError
        If JAX is not installed.
    TypeError, ValueError
        If JAX is not set to double precision, or an argument does not fit.
    """
    jax = library("jax")
    if not jax.config.read("jax_enable_x64"):
        wanted = 'jax.config.update("jax_enable_x64", True) before any array of JAX is made'
        raise ValueError(f"jax: expected double precision, by {wanted}, found single")
    if not callable(residual):
        raise complain(TypeError, "residual", "a function of (y, lam)", residual)
    if jacobian not in KINDS:
        raise complain(ValueError, "jacobian", f"one of {', '.join(KINDS)}", jacobian)
    return JaxHomotopy(residual, *started(start), target, jacobian)
