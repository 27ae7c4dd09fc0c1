"""Residuals in JAX, with derivatives, products and Taylor coefficients."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import factorial
from typing import Any

import numpy as np

from continuation.adapters.given import Adapted, library, started
from continuation.arguments.checks import complain, expect
from continuation.arrays import Array
from continuation.homotopy import TangentPoint

JACOBIANS = ("dense", "sparse")


def from_jax(
    residual: Callable[[Any, Any], Any],
    start: tuple[Any, float],
    *,
    target: float | None = 0.0,
    jacobian: str = "dense",
) -> Adapted:
    """Make a homotopy of a residual in JAX, with its derivatives and the coefficients of SERIES.

    Parameters
    ----------
    residual : callable
        ``residual(y, lam) -> (N,)``, a pure function in `jax.numpy`.
    start : tuple
    target : float or None
        As of `continuation.from_functions`.
    jacobian : str
        "dense", or "sparse": by groups of columns that share no equation.

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
    expect(callable(residual), "residual", "a function of (y, lam)", residual, TypeError)
    expect(jacobian in JACOBIANS, "jacobian", f"one of {', '.join(JACOBIANS)}", jacobian)
    y0, lam0 = started(start)

    def at(u: Any) -> Any:
        return residual(u[:-1], u[-1])

    value, whole = jax.jit(at), jax.jit(jax.jacfwd(at))
    product = jax.jit(lambda u, v: jax.jvp(at, (u,), (v,))[1])
    series = _series(jax, at)
    u = np.append(y0, lam0)
    found = jax.eval_shape(at, u)
    if getattr(found, "shape", None) != y0.shape or found.dtype != np.float64:
        wanted = f"a function of (y, lam) that gives float64 numbers, shape {y0.shape}"
        raise complain(ValueError, "residual", wanted, found)

    def differential(y: Array, lam: float, v: Array) -> Array:
        return np.asarray(product(np.append(y, lam), v))

    def dense(y: Array, lam: float) -> tuple[Array, Array]:
        full = np.asarray(whole(np.append(y, lam)))
        return full[:, :-1], full[:, -1]

    more: dict[str, Any] = {"differential": differential}
    if jacobian == "dense":
        more["jacobian"] = dense
    try:
        jax.eval_shape(series, u, np.zeros((2, u.size)))
        more["taylor"] = partial(_taylor, series)
    except (KeyError, NotImplementedError, TypeError, ValueError):
        # JAX's `jet` lacks a rule: no series, as nested derivatives of order 4, 6, 8 take 0.5, 2.4, 18 s to compile.
        pass
    again = partial(from_jax, target=target, jacobian=jacobian), (residual, (y0, lam0))

    def computed(y: Array, lam: float) -> Array:
        return np.asarray(value(np.append(np.asarray(y, dtype=float), lam)))

    return Adapted(computed, y0, lam0, target, more=more, again=again)


def _series(jax: Any, at: Callable[[Any], Any]) -> Any:
    """Taylor coefficients of the residual, times factorials."""
    jet = library("jax.experimental.jet")
    return jax.jit(lambda u, terms: jax.numpy.stack(jet.jet(at, (u,), (list(terms),))[1]))


def _taylor(series: Callable[[Any, Any], Any], point: TangentPoint, order: int) -> Array:
    coefficients = np.zeros((order + 1, point.u.size))
    coefficients[:2] = point.u, point.tangent
    factorials = np.array([float(factorial(k)) for k in range(order + 1)])[:, None]
    for k in range(2, order + 1):
        # Zeros beyond k avoid another compilation.
        defect = series(point.u, (coefficients * factorials)[1:])[k - 1]
        coefficients[k] = point.solve(-np.asarray(defect) / factorials[k, 0])
    return coefficients
