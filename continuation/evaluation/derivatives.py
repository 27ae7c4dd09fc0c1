"""Derivatives of a residual by products H' w: dense, or by groups of columns."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import define, field

from continuation.arguments.checks import complain
from continuation.arrays import Array, Matrix, generic_vector
from continuation.evaluation.pattern import Pattern, found, generic, pattern_of
from continuation.evaluation.products import (
    DIFFERENCE_STEPS,
    ByDifferences,
    Products,
    Residual,
    by_differences,
    exact,
    sizes,
)

SPARSE_FROM = 64
"""Number of unknowns from which sparse factorisations are faster."""


def check_derivative(answer: Any, n: int) -> None:
    """Raise unless `answer` is a pair (H_y, H_lam) of real arrays of the right shapes."""
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


@define(eq=False)
class Derivative:
    """(H_y, H_lam) of a residual, by products.

    One more product checks each sparse derivative; if it differs, the pattern is searched again.
    """

    residual: Residual
    products: Products
    pattern: Pattern | None = None
    notes: set[str] = field(factory=set)

    def know(self, noise: Array) -> None:
        """Adapt difference steps to the residual's noise, shape (N,)."""
        if isinstance(self.products, ByDifferences):
            self.products = self.products.over(noise)

    def __call__(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """The pair (H_y, H_lam), dense or sparse."""
        u = np.append(y, lam)
        if self.pattern is not None:
            answer = self._by_groups(u, self.pattern)
            if answer is None:
                self.notes.add("a sparsity pattern that changed, looked for again")
                more = _looked_for(self.residual, u)
                self.pattern = None if more is None else _worth(self.pattern.joined(more))
                answer = None if self.pattern is None else self._by_groups(u, self.pattern)
            if answer is not None:
                return answer
            self.pattern = None
            self.notes.add("a sparsity pattern that could not be found")
        full = self.products.whole(self.residual, u)
        return full[:, :-1], full[:, -1]

    def _by_groups(self, u: Array, pattern: Pattern) -> tuple[Matrix, Array] | None:
        scale, directions = self.products.scale(u), pattern.directions.copy()
        directions[-1] *= self.products.even
        seen = self.products(self.residual, u, directions)
        entries, column, product = pattern.entries(seen), seen[:, -2], seen[:, -1]
        terms, more = entries * directions[-1][pattern.columns], column * directions[-1, -1]
        gap = np.abs(product - more - np.bincount(pattern.rows, terms, pattern.n))
        size = np.bincount(pattern.rows, np.abs(terms), pattern.n) + np.abs(more)
        # A NaN, outside the domain, is no fault of the pattern.
        allowed = self.products.agreement * size
        if (gap > np.maximum(allowed, self.products.agreement * float(allowed.max()))).any():
            return None
        return pattern.matrix(entries / scale[pattern.columns]), column / scale[-1]


def _worth(pattern: Pattern | None) -> Pattern | None:
    return pattern if pattern is not None and 4 * pattern.count <= pattern.n else None


def _looked_for(residual: Residual, u: Array) -> Pattern | None:
    """The pattern at a generic point near u, where no entry vanishes."""
    size = sizes(u)

    def at(v: Array) -> Array:
        try:
            return np.array(residual(v[:-1], float(v[-1])), dtype=float)
        except (ArithmeticError, ValueError):
            return np.full(u.size - 1, np.nan)

    with np.errstate(all="ignore"):
        for h in DIFFERENCE_STEPS[:3]:
            base = u + h * size * generic(u.size)
            before = at(base)
            if np.isfinite(before).all():
                break
        else:
            return None

    def touched(labels: Any, count: int) -> Any:
        seen = np.empty((before.size, count), bool)
        for k in range(count):
            own = np.flatnonzero(labels == k)
            moved = base.copy()
            moved[own] += h * size[own] * generic(u.size)[::-1][own]
            seen[:, k] = at(moved) != before
        return seen

    with np.errstate(all="ignore"):
        return _worth(found(touched, before.size))


def given_pattern(sparsity: Any, n: int) -> Pattern:
    """Pattern of a homotopy's `sparsity`."""
    try:
        places = sp.coo_array(sparsity)
    except (TypeError, ValueError):
        raise complain(TypeError, "sparsity", f"a matrix of shape ({n}, {n})", sparsity) from None
    if places.shape != (n, n):
        raise complain(ValueError, "sparsity", f"a matrix of shape ({n}, {n})", sparsity)
    places.eliminate_zeros()
    return pattern_of(places.coords[0], places.coords[1], n)


def from_residual(
    residual: Residual,
    start: tuple[Array, float],
    pattern: Pattern | None = None,
    notes: set[str] | None = None,
    products: Products | None = None,
) -> Derivative:
    """The best derivative: jets, else complex step, else central differences.

    `pattern`: searched for if None and N is large. `notes`: receives the method. `products`: the homotopy's own.
    """
    y, lam = np.array(start[0], dtype=float, ndmin=1), float(start[1])
    u = np.append(y, lam)
    said: set[str] = set() if notes is None else notes
    if pattern is None and y.size >= SPARSE_FROM:
        pattern = _looked_for(residual, u)
    products = products or exact(residual, u, sizes(u) * generic_vector(u.size))
    if products is None:
        groups = None if pattern is None else np.append(pattern.groups, pattern.count)
        products = by_differences(residual, u, groups)
    said.add(f"H' by {products.name}" + ("" if pattern is None else f" in {pattern.count} groups of columns"))
    return Derivative(residual, products, pattern, said)
