"""Projected Gauss-Seidel, for time stepping: compiled where numba is installed."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from continuation.arrays import Array

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function) -> Function:
    """By numba, if that is there."""
    try:
        from numba import njit
    except ImportError:
        return function
    fast: Function = njit(function)
    return fast


@compiled
def tridiagonal(A: Array, q: Array, x: Array, residual: float, most: int = 2000) -> Array:
    """LCP(q, A) with a tridiagonal A, from a start, to a residual."""
    x = x.copy()
    for _ in range(most):
        for i in range(len(q)):
            near = slice(max(0, i - 1), i + 2)
            x[i] = max(0.0, x[i] - ((A[i, near] * x[near]).sum() + q[i]) / A[i, i])
        if np.abs(np.minimum(x, A @ x + q)).max() <= residual:
            break
    return x


@compiled
def impulses(W: Array, u: Array, p: Array, friction: float, residual: float, most: int) -> tuple[Array, int]:
    """Impulses of a time step, normal and tangential in turns, from a start, to a residual; and how many sweeps.

    The velocities are W p + u; a tangential impulse is at most `friction` times the normal one. The residual is what an
    impulse differs by from that of a unit step of projection.
    """
    p = p.copy()
    for sweep in range(most):
        for i in range(0, len(u), 2):
            p[i] = max(0.0, p[i] - (W[i] @ p + u[i]) / W[i, i])
            limit = friction * p[i]
            p[i + 1] = min(limit, max(-limit, p[i + 1] - (W[i + 1] @ p + u[i + 1]) / W[i + 1, i + 1]))
        v, off = W @ p + u, 0.0
        for i in range(0, len(u), 2):
            limit = friction * p[i]
            off = max(off, abs(p[i] - max(0.0, p[i] - v[i])))
            off = max(off, abs(p[i + 1] - min(limit, max(-limit, p[i + 1] - v[i + 1]))))
        if off <= residual:
            return p, sweep + 1
    return p, most
