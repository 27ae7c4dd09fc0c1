"""Derivatives of a homotopy that gives only its residual, and the check of one that gives more."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix
from continuation.bibliography import GRIEWANK_WALTHER, SQUIRE_TRAPP


@frozen
class Derivative:
    """A way to get (H_y, H_lam), what it costs in residual evaluations, its name and where it was published."""

    function: Callable[[Array, float], tuple[Matrix, Array]]
    evaluations: int
    source: str
    references: tuple[str, ...] = ()

    def __call__(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam) at a point."""
        return self.function(y, lam)


def check_derivative(answer: Any, n: int) -> None:
    """Raise unless a homotopy's answer is a pair (H_y, H_lam) of the right shapes, of real numbers."""
    wanted = f"a pair (H_y, H_lam) of real numbers, shapes ({n}, {n}) and ({n},)"
    if not isinstance(answer, (tuple, list)) or len(answer) != 2:
        raise TypeError(f"jacobian: expected {wanted}, found {type(answer).__name__}")
    parts = answer[0], np.asarray(answer[1])
    found = [getattr(part, "shape", type(part).__name__) for part in parts]
    if found != [(n, n), (n,)]:
        raise ValueError(f"jacobian: expected {wanted}, found {found[0]} and {found[1]}")
    for part in parts:
        kind = getattr(part, "dtype", None)
        if kind is not None and np.dtype(kind).kind not in "fiub":
            raise TypeError(f"jacobian: expected {wanted}, found some of the type {kind}")


def _split(full: Array) -> tuple[Array, Array]:
    return full[:, :-1], full[:, -1]


def by_jets(residual: Callable[..., Any]) -> Callable[[Array, float], tuple[Array, Array]]:
    """Exact derivatives by truncated Taylor arithmetic, `continuation.jets`."""
    from continuation import jets

    def function(y: Array, lam: float) -> tuple[Array, Array]:
        return _split(jets.jacobian(lambda u: residual(u[:-1], u[-1]), np.append(y, lam)))

    return function


def by_complex_step(residual: Callable[..., Any]) -> Callable[[Array, float], tuple[Array, Array]]:
    """Derivatives to round-off by the complex step (Squire and Trapp, SIAM Review 40, 1998)."""

    def function(y: Array, lam: float) -> tuple[Array, Array]:
        u = np.append(y, lam).astype(complex)
        columns = []
        for i in range(u.size):
            u[i] += 1e-200j
            columns.append(np.asarray(residual(u[:-1], u[-1])).imag * 1e200)
            u[i] = u[i].real
        return _split(np.stack(columns, axis=1))

    return function


def by_differences(residual: Callable[..., Any]) -> Callable[[Array, float], tuple[Array, Array]]:
    """Derivatives by central differences, step eps^(1/3) relative: about ten digits."""

    def function(y: Array, lam: float) -> tuple[Array, Array]:
        u = np.append(y, lam)
        columns = []
        for i in range(u.size):
            h = 6e-6 * max(1.0, abs(u[i]))
            ahead, behind = u.copy(), u.copy()
            ahead[i] += h
            behind[i] -= h
            # A copy of the first: a residual may return the same array every time.
            difference = np.array(residual(ahead[:-1], float(ahead[-1]))) - residual(behind[:-1], float(behind[-1]))
            columns.append(difference / (ahead[i] - behind[i]))
        return _split(np.stack(columns, axis=1))

    return function


def from_residual(residual: Callable[..., Any], start: tuple[Array, float]) -> Derivative:
    """The best derivative that a residual allows: jets, else complex step, else central differences.

    Each is tried at the start, and believed when it agrees with differences there, since a residual may well run on
    complex numbers and be wrong on them (``abs``, ``np.real``).
    """
    y, lam = np.array(start[0], dtype=float, ndmin=1), float(start[1])
    m = y.size + 1
    with np.errstate(all="ignore"):
        reference = np.column_stack(by_differences(residual)(y, lam))
    ways = (
        ("jets", by_jets, -(-m // 128), GRIEWANK_WALTHER),
        ("complex step", by_complex_step, m, SQUIRE_TRAPP),
    )
    for name, maker, cost, source in ways:
        try:
            function = maker(residual)
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("error", np.exceptions.ComplexWarning)
                found = np.column_stack(function(y, lam))
        except (TypeError, ArithmeticError, ValueError, AttributeError, np.exceptions.ComplexWarning):
            continue
        scale = 1.0 + float(np.abs(reference).max())
        if found.shape == reference.shape and np.allclose(found, reference, rtol=1e-4, atol=1e-4 * scale):
            return Derivative(function, cost, name, (source,))
    return Derivative(by_differences(residual), 2 * m, "differences")
