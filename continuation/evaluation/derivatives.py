"""Derivatives of a homotopy that gives only its residual, and the check of one that gives more."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from attrs import frozen

from continuation.arrays import Array, Matrix, generic_vector
from continuation.citation.bibliography import GRIEWANK_WALTHER, SQUIRE_TRAPP


@frozen
class Derivative:
    """A way to get (H_y, H_lam), its name and where it was published."""

    function: Callable[[Array, float], tuple[Matrix, Array]]
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


DIFFERENCE_STEPS = 6e-6 * 100.0 ** np.arange(2, -5, -1)
"""Steps of central differences beside the size of a component (or 1, where it is 0): eps^(1/3), the best one where that
is how far the function sees it, and others, since zero may lie anywhere and units may be any."""


def difference_along(
    residual: Callable[..., Any], u: Array, w: Array, rows: Array | float = 0.0
) -> tuple[Array, float]:
    """The central difference of a residual along w, and its step.

    Of several steps that one is taken at which the difference changes least from this to the next, in the mean over
    the equations, each beside its own size, or that of its `rows`: one that does not change along w knows no step.

    `u`, `w` of shape (N + 1,); `rows` of shape (N,), the sizes of differences in other directions.
    """

    def at(h: float) -> Array:
        ahead, behind = u + h * w, u - h * w
        # A copy of the first: a residual may return the same array every time.
        try:
            change = np.array(residual(ahead[:-1], float(ahead[-1]))) - residual(behind[:-1], float(behind[-1]))
        except (ArithmeticError, ValueError):
            # Outside the domain; shorter steps stay inside.
            return np.full(u.size - 1, np.nan)
        return np.asarray(change / (2.0 * h), dtype=float)

    with np.errstate(all="ignore"):
        found = [at(float(h)) for h in DIFFERENCE_STEPS]
        changes = []
        for one, other in pairwise(found):
            size = np.maximum(np.abs(one) + np.abs(other), rows)
            change = np.abs(one - other) / np.where(size > 0.0, size, 1.0)
            changes.append(float(np.where(np.isfinite(change), change, 1.0).mean()))
    best = int(np.argmin(changes)) + 1
    return found[best], float(DIFFERENCE_STEPS[best])


NOISE_SAMPLES = 7
"""Samples on a line: three fourth differences, of which a smooth function leaves the fourth power of their distance."""

NOISE_REACH, NOISE_FINER, NOISE_TRIES = 1e-5, 1e-3, 3
"""The samples' distance, in lengths in which a path may turn, and by what it is divided until the differences no longer
shrink with it: a thousandth makes a smooth fourth difference 1e12 times as small."""

NOISE_STEADY = 30.0
"""What is noise at two distances agrees to this factor: each is the largest of three samples of it."""


def noise_along(residual: Callable[[Array], Array], u: Array, w: Array, here: Array) -> Array:
    """The noise of each equation, shape (N,): what stays of its differences along w however near the samples are.

    Round-off of terms that do not move with u is part of it, and so is what an inner solver or a measurement leaves
    (More and Wild, Estimating computational noise, SIAM J. Sci. Comput. 33, 2011).

    `u`, `w` of shape (N + 1,): w is a way on which the function may change. `here`, of shape (N,): residual(u).
    """
    least, steady = np.full(here.size, np.inf), np.zeros(here.size, dtype=bool)
    near = float(np.median((np.spacing(np.abs(u)) / np.abs(w))[w != 0.0]))
    for k in range(NOISE_TRIES):
        h = max(NOISE_REACH * NOISE_FINER**k, DISTINCT_ULPS * near)
        samples = np.stack([here, *(residual(u + j * h * w) for j in range(1, NOISE_SAMPLES))])
        # A fourth difference of noise of variance 1 has the variance 70.
        found = np.abs(np.diff(samples, 4, axis=0)).max(axis=0) / np.sqrt(70.0)
        now = least <= NOISE_STEADY * found
        least = np.where(steady, least, np.minimum(least, found))
        steady |= now
        if steady.all():
            break
    return least


def _rounding(residual: Callable[..., Any], u: Array, w: Array, h: float) -> Array:
    """What a difference along w cannot tell from zero: u + h w is rounded, and the function's slope there shows it."""
    with np.errstate(all="ignore"):
        here, ahead, behind = (np.array(residual(at[:-1], float(at[-1]))) for at in (u, u + h * w, u - h * w))
    return np.asarray(ULPS * np.finfo(float).eps * (np.abs(ahead - here) + np.abs(behind - here)) / h**2, dtype=float)


def sizes(u: Array) -> Array:
    """What the steps of differences are measured by: a component's size, or 1."""
    return np.where(u != 0.0, np.abs(u), 1.0)


def by_differences(residual: Callable[..., Any], u0: Array) -> Callable[[Array, float], tuple[Array, Array]]:
    """Derivatives by central differences, about eight to ten digits, with steps found at `u0`, shape (N + 1,)."""
    steps = np.empty_like(u0)
    rows = np.nan_to_num(np.abs(difference_along(residual, u0, sizes(u0) * generic_vector(u0.size))[0]))
    for i, size in enumerate(sizes(u0)):
        w = np.zeros_like(u0)
        w[i] = size
        steps[i] = difference_along(residual, u0, w, rows)[1]

    def function(y: Array, lam: float) -> tuple[Array, Array]:
        u = np.append(y, lam)
        reach = steps * np.maximum(sizes(u0), np.abs(u))
        columns = []
        for i in range(u.size):
            ahead, behind = u.copy(), u.copy()
            ahead[i] += reach[i]
            behind[i] -= reach[i]
            difference = np.array(residual(ahead[:-1], float(ahead[-1]))) - residual(behind[:-1], float(behind[-1]))
            columns.append(difference / (ahead[i] - behind[i]))
        return _split(np.stack(columns, axis=1))

    return function


DISTINCT_ULPS = 64.0
"""Units in the last place between two samples: what rounds their places is then a small part of their difference."""

ULPS = 8.0
"""Units in the last place by which the ends of a difference may be off, in all."""

AGREEMENT = 1e-3
"""Of a derivative with a difference, beside the sum of its terms: what is wrong is wrong by more."""


def from_residual(residual: Callable[..., Any], start: tuple[Array, float]) -> Derivative:
    """The best derivative that a residual allows: jets, else complex step, else central differences.

    The first two are tried at the start, and believed when they agree with a difference there, since a residual may
    well run on complex numbers and be wrong on them (``abs``, ``np.real``).

    `start` of shape (N,).
    """
    y, lam = np.array(start[0], dtype=float, ndmin=1), float(start[1])
    u = np.append(y, lam)
    w = sizes(u) * generic_vector(u.size)
    reference: Array | None = None
    for name, maker, source in (("jets", by_jets, GRIEWANK_WALTHER), ("complex step", by_complex_step, SQUIRE_TRAPP)):
        try:
            function = maker(residual)
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("error", np.exceptions.ComplexWarning)
                found = np.column_stack(function(y, lam))
        except (TypeError, ArithmeticError, ValueError, AttributeError, np.exceptions.ComplexWarning):
            continue
        if found.shape != (y.size, u.size):
            continue
        if reference is None:
            reference, step = difference_along(residual, u, w)
            rounding = _rounding(residual, u, w, step)
        allowed = AGREEMENT * np.abs(found) @ np.abs(w)
        allowed = np.maximum(allowed, AGREEMENT * float(allowed.max())) + rounding
        if (np.abs(found @ w - reference) <= allowed).all():
            return Derivative(function, name, (source,))
    return Derivative(by_differences(residual, u), "differences")
