"""Series and derivatives of functions written in plain NumPy."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np

from continuation.arrays import Array
from continuation.numbers.algebra import GRADIENT, TAYLOR, Beside, Coefficients, joined, lengthened
from continuation.numbers.array import Jet
from continuation.numbers.truncated import Truncated, alike, common, wrap

BLOCK = 128
"""Jacobian columns per call; more cost memory and save no time."""


def variable(x0: Any, direction: Any, order: int) -> Jet:
    """Line x0 + s * direction as a jet.

    Parameters
    ----------
    x0 : array_like
    direction : array_like
        Broadcast to the shape of `x0`.
    order : int
        Highest power of s.
    """
    x0, order = _numbers(x0, "x0"), _order(order, 0)
    both = np.stack([x0, np.broadcast_to(_numbers(direction, "direction"), x0.shape)])
    line: Jet = wrap(lengthened(both[: order + 1], order + 1), TAYLOR)
    return line


def taylor(f: Callable[[Any], Any], x0: Any, order: int, direction: Any = 1.0) -> Array:
    """Coefficients of s -> f(x0 + s * direction).

    Parameters
    ----------
    f : callable
        A function of an array, written in numpy functions that jets support.
    x0, direction : array_like
        `direction` is broadcast.
    order : int
        Highest power of s.

    Returns
    -------
    ndarray, (order + 1, *shape of f)

    Raises
    ------
    TypeError
        If `f` uses an unsupported operation; the message names it.
    JetDomainError
        If `f` has no Taylor series.
    """
    return np.asarray(_image(f, variable(x0, direction, order)))


def jacobian(f: Callable[[Any], Any], x: Any) -> Array:
    """The Jacobian of f: R^m -> R^n at x, without truncation error.

    One call of f yields up to 128 columns.

    Parameters
    ----------
    f : callable
        As in `taylor`; an image of any shape gives ``(*shape, m)``.
    x : array_like, shape (m,)

    Returns
    -------
    ndarray, (n, m)

    Raises
    ------
    TypeError, JetDomainError
        As in `taylor`.
    ValueError
        If x is no vector.
    """
    x = _numbers(x, "x")
    if x.ndim != 1 or len(x) == 0:
        raise ValueError(f"x has shape {x.shape}; expected (m,) with m >= 1")
    return derivatives_along(f, x, np.eye(len(x)))


def derivatives_along(f: Callable[[Any], Any], x: Array, directions: Array) -> Array:
    """f'(x) times each of k directions, (k, m), as columns: shape (*shape of f, k)."""
    return _columns(f, directions, lambda some: wrap(np.concatenate((x[None], some)), GRADIENT))


def second_derivatives(f: Callable[[Any], Any], x: Any, v: Any) -> Array:
    """f''(x)[v, .] of f: R^m -> R^n, without truncation error.

    Parameters
    ----------
    f : callable
        As in `taylor`.
    x, v : array_like, shape (m,)

    Returns
    -------
    ndarray, (n, m)

    Raises
    ------
    TypeError, JetDomainError
        As in `taylor`.
    """
    x, v = _numbers(x, "x"), _numbers(v, "v")

    def line(directions: Array) -> Any:
        return wrap(np.vstack([x, directions, v, np.zeros_like(directions)]), Beside(GRADIENT))

    return _columns(f, np.eye(len(x)), line)


def _columns(f: Callable[[Any], Any], directions: Array, line: Callable[[Array], Any]) -> Array:
    blocks = [directions[k : k + BLOCK] for k in range(0, len(directions), BLOCK)]
    columns = [np.moveaxis(_image(f, line(block))[-len(block) :], 0, -1) for block in blocks]
    return np.concatenate(columns, axis=-1)


def path_series(
    residual: Callable[[Any, Any], Any], u0: Any, tangent: Any, solve: Callable[[Array, float], Array], order: int
) -> Array:
    """Taylor coefficients of the path u(s) with H(u(s)) = H(u0) and border . (u(s) - u0) = s.

    Coefficient k solves the bordered system for (-R_k, 0), with coefficient k, R_k, of H along the lower terms: one
    factorisation serves all (Cochelin, Computers & Structures 53 (1994) 1181-1192).

    Parameters
    ----------
    residual : callable
        ``residual(y, lam) -> (N,)`` in plain numpy.
    u0 : (N + 1,) array
        The point (y, lam).
    tangent : (N + 1,) array
        H' tangent = 0 and border . tangent = 1.
    solve : callable
        ``solve(r, rho) -> (N + 1,)`` solves ``[H'; border'] z = (r, rho)``.
    order : int
        1 or more.

    Returns
    -------
    ndarray, (order + 1, N + 1)

    Raises
    ------
    TypeError, JetDomainError
        As in `taylor`.
    """
    u0, tangent = _numbers(u0, "u0"), _numbers(tangent, "tangent")
    if u0.ndim != 1 or len(u0) < 2 or tangent.shape != u0.shape:
        raise ValueError(f"u0 and tangent have shapes {u0.shape} and {tangent.shape}; expected (N + 1,) twice, N >= 1")
    order = _order(order, 1)
    u = np.zeros((order + 1, len(u0)))
    u[0], u[1] = u0, tangent
    for k in range(2, order + 1):
        y, lam = wrap(u[: k + 1, :-1].copy(), TAYLOR), wrap(u[: k + 1, -1].copy(), TAYLOR)
        defect = lengthened(y.lifted(residual(y, lam)).c, k + 1)[k]
        if defect.size != len(u0) - 1:
            raise ValueError(f"residual has shape {defect.shape}; expected ({len(u0) - 1},)")
        u[k] = solve(-defect.reshape(-1), 0.0)
    return u


def derivative_along(f: Callable[[Any], Any], x: Any, v: Any) -> tuple[Any, Any]:
    """f(x) and f'(x) v for numbers, jets or interval arrays.

    Parameters
    ----------
    f : callable
        As in `taylor`.
    x, v : array_like, Jet or Interval, of one shape

    Returns
    -------
    tuple
        Two arrays of the kind of x and v.

    Raises
    ------
    TypeError, JetDomainError
        As in `taylor`.
    """
    like = next((a for a in (x, v) if isinstance(a, Truncated)), None)
    if like is None:
        line = wrap(np.stack([np.asarray(part) for part in (x, v)]), TAYLOR)
        value, slope = _image(f, line)
        return value, slope
    both = [like.lifted(a) for a in (x, v)]
    algebra = common(both)
    line = wrap(joined(*alike(both)), Beside(algebra))
    image = _image(f, line)
    half = len(image) // 2
    return wrap(image[:half], algebra), wrap(image[half:], algebra)


def _image(f: Callable[[Any], Any], line: Any) -> Coefficients:
    return lengthened(line.lifted(f(line)).c, len(line.c))


def _numbers(x: Any, name: str) -> Array:
    if isinstance(x, Truncated):
        raise TypeError(f"{name} is a {type(x).__name__}; expected plain numbers (jets of jets are not supported)")
    return np.array(x, dtype=float)


def _order(order: Any, least: int) -> int:
    order = operator.index(order)
    if order < least:
        raise ValueError(f"order is {order}; expected {least} or more")
    return int(order)
