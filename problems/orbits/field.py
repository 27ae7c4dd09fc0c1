"""The right-hand side of x' = f(x, p) and its derivatives."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import evolve, frozen

from continuation.arguments.checks import expect
from continuation.arrays import Array, generic_vector
from continuation.evaluation.products import (
    AGREEMENT,
    BY_COMPLEX_STEP,
    ByDifferences,
    agree,
    by_differences,
    sizes,
)

COMPLEX_STEP = 1e-200
"""Imaginary step; its square underflows (Squire and Trapp 1998)."""


@frozen(eq=False)
class Field:
    """`function` takes x of shape (n,), or (n, k) if `columns`. `own` gives (f_x, f_p); `steps` are those of
    differences.
    """

    function: Callable[..., Any]
    columns: bool
    own: Callable[..., Any] | None = None
    beside: tuple[Any, ...] = ()
    steps: ByDifferences | None = None

    def __call__(self, x: Array, p: Any) -> Array:
        """The value."""
        if self.columns:
            found: Array = np.asarray(self.function(x, p, *self.beside))
            return found
        return np.stack([np.asarray(self.function(one, p, *self.beside)) for one in x.T], axis=1)

    def derivatives(self, x: Array, p: float) -> tuple[Array, Array]:
        """(f_x, f_p) at the columns of x, shapes (k, n, n) and (k, n)."""
        n, k = x.shape
        if self.own is not None:
            ways = [self.own(x, p, *self.beside)] if self.columns else [self.own(one, p, *self.beside) for one in x.T]
            by_x, by_p = (np.stack([np.asarray(way[j]) for way in ways], axis=-1) for j in (0, 1))
            by_x, by_p = by_x.reshape(n, n, -1), by_p.reshape(n, -1)
            return np.moveaxis(np.broadcast_to(by_x, (n, n, k)), 2, 0), np.broadcast_to(by_p, (n, k)).T
        copies, aside = np.repeat(x[:, :, None], n, axis=2), np.eye(n)[:, None, :]
        if self.steps is None:
            by_x = self((copies + COMPLEX_STEP * 1j * aside).reshape(n, -1), p).imag / COMPLEX_STEP
            by_p = self(x, complex(p, COMPLEX_STEP)).imag / COMPLEX_STEP
        else:
            *h, step = self.steps.scale(np.append(np.abs(x).max(axis=1), p))
            ahead, behind = ((copies + sign * aside * h).reshape(n, -1) for sign in (1.0, -1.0))
            by_x = (self(ahead, p) - self(behind, p)) / np.tile(2.0 * np.array(h), k)
            by_p = (self(x, p + step) - self(x, p - step)) / (2.0 * step)
        return np.moveaxis(by_x.reshape(n, k, n), 1, 0), by_p.T


TRIED_ASIDE = 0.1
"""Offset of trial points: at an equilibrium nonlinear terms may vanish."""


def field_of(function: Any, jacobian: Any, second: Any, point: Array, size: Array, p: float) -> Field:
    """Find how to call and differentiate f by trial calls near a point, shape (n,).

    Raises `TypeError`, `ValueError` unless f returns n numbers.
    """
    for name, given in (("f", function), ("jacobian", jacobian)):
        expect(callable(given) or (given is None and name != "f"), name, "a function of (x, p)", given, TypeError)
    x = point[:, None] + TRIED_ASIDE * size[:, None] * np.cos(
        np.outer(np.arange(1.0, point.size + 1.0), np.arange(3.0))
    )
    beside = () if second is None else (second,)
    single = np.asarray(function(x[:, 0].copy(), p, *beside))
    expect(single.shape == (len(x),) and single.dtype.kind in "fiu", "f", f"{len(x)} real numbers, as x has", single)
    alone = Field(function, False, jacobian, beside)
    found = evolve(alone, columns=_agrees(lambda: evolve(alone, columns=True)(x.copy(), p), alone(x, p)))
    if jacobian is not None:
        return found
    u = np.append(x[:, 0], p)

    def residual(y: Array, lam: Any) -> Array:
        return found(y[:, None], lam)[:, 0]

    if agree(BY_COMPLEX_STEP, residual, u, sizes(u) * generic_vector(u.size)):
        return found
    return evolve(found, steps=by_differences(residual, u))


def _agrees(make: Callable[[], Array], known: Array) -> bool:
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("error", np.exceptions.ComplexWarning)
            found = make()
    except (TypeError, ArithmeticError, ValueError, AttributeError, IndexError, np.exceptions.ComplexWarning):
        return False
    if found.shape != known.shape:
        return False
    return bool((np.abs(found - known) <= AGREEMENT * float(np.abs(known).max(initial=0.0))).all())
