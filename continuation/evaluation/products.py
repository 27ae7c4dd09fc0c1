"""Products H'(u) w, by jets, complex step or differences."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, ClassVar, TypeAlias

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import EPS, ROOT_OF_ROUND_OFF, SIX_DIGITS, Array
from continuation.citation.bibliography import GRIEWANK_WALTHER, SQUIRE_TRAPP
from continuation.evaluation.pattern import generic
from continuation.numbers.derivatives import derivatives_along

Residual = Callable[..., Any]
"""``residual(y, lam) -> (N,)``."""

AGREEMENT = float(np.sqrt(SIX_DIGITS))
"""Largest error of differences, relative to the terms."""


@frozen
class Exact:
    """Products to round-off.

    `function` maps residual, u and directions (k, N + 1) to (N, k). `agreement`: tolerance when a sparsity pattern is
    checked, relative to terms. `scale`, `even`: see `ByDifferences`.
    """

    name: str
    function: Callable[[Residual, Array, Array], Array]
    references: tuple[str, ...] = ()
    agreement: float = ROOT_OF_ROUND_OFF
    even: ClassVar[float] = 1.0

    def scale(self, u: Array) -> Array:
        """Ones: products need no units."""
        return np.ones_like(u)

    def __call__(self, residual: Residual, u: Array, directions: Array) -> Array:
        """H'(u) times each direction."""
        return self.function(residual, u, directions)

    def whole(self, residual: Residual, u: Array) -> Array:
        """H'(u)."""
        return self(residual, u, np.eye(u.size))


def _by_jets(residual: Residual, u: Array, directions: Array) -> Array:
    return derivatives_along(lambda at: residual(at[:-1], at[-1]), u, directions)


def _by_complex_step(residual: Residual, u: Array, directions: Array) -> Array:
    moved = (u + 1e-200j * w for w in directions)
    return np.stack([np.asarray(residual(at[:-1], at[-1])).imag * 1e200 for at in moved], axis=1)


BY_JETS = Exact("jets", _by_jets, (GRIEWANK_WALTHER,))
"""Truncated Taylor arithmetic."""

BY_COMPLEX_STEP = Exact("complex step", _by_complex_step, (SQUIRE_TRAPP,))
"""One complex residual for each direction (Squire and Trapp, SIAM Review 40, 1998)."""


def given(differential: Callable[[Array, float, Array], Array]) -> Exact:
    """Products by the homotopy's own `differential`."""

    def function(residual: Residual, u: Array, directions: Array) -> Array:
        y, lam = u[:-1], float(u[-1])
        return np.stack([np.asarray(differential(y, lam, w), dtype=float) for w in directions], axis=1)

    # The homotopy's products may be differences.
    return Exact("differential", function, agreement=AGREEMENT)


USUAL_STEP = float(np.cbrt(EPS))
"""Best step of a smooth function, relative to a component's size (or 1); its square is the difference's accuracy."""

DIFFERENCE_STEPS = USUAL_STEP * 100.0 ** np.arange(2, -5, -1)
"""Steps tried, since origin and units are arbitrary."""


def sizes(u: Array) -> Array:
    """Units of difference steps: sizes of the components, or 1."""
    return np.where(u != 0.0, np.abs(u), 1.0)


def _central(residual: Residual, u: Array, w: Array) -> Array:
    ahead, behind = u + w, u - w
    # Residuals may reuse their arrays.
    change = np.array(residual(ahead[:-1], float(ahead[-1]))) - residual(behind[:-1], float(behind[-1]))
    return np.asarray(0.5 * change, dtype=float)


def _trials(residual: Residual, u: Array, w: Array, rows: Array | float = 0.0) -> tuple[Array, Array]:
    """Central differences along w at all steps, (steps, N), and their relative changes, (steps - 1, N).

    `rows`, shape (N,): least unit of a change; without, noise decides for equations constant along w.
    """

    def at(h: float) -> Array:
        try:
            return _central(residual, u, h * w) / h
        except (ArithmeticError, ValueError):
            return np.full(u.size - 1, np.nan)

    with np.errstate(all="ignore"):
        found = np.array([at(float(h)) for h in DIFFERENCE_STEPS])
        one, other = found[:-1], found[1:]
        size = np.maximum(np.abs(one) + np.abs(other), rows)
        changes = np.abs(one - other) / np.where(size > 0.0, size, 1.0)
    # Too short steps show no change: equal zeros are no agreement.
    changes[(one == 0.0) & (other == 0.0) & (found != 0.0).any(axis=0)] = 1.0
    changes[~np.isfinite(changes)] = 1.0
    # Closer agreement than a difference's accuracy is chance.
    return found, np.maximum(changes, USUAL_STEP**2)


def difference_along(residual: Residual, u: Array, w: Array) -> tuple[Array, float]:
    """The central difference along w that changes least as the step shrinks, and this step.

    `u`, `w` of shape (N + 1,).
    """
    found, changes = _trials(residual, u, w)
    best = _best(changes.mean(axis=1))
    return found[best], float(DIFFERENCE_STEPS[best])


def _best(changes: Array) -> int:
    """The step with the least change; of equals, the nearest to the usual one."""
    return min(range(changes.size), key=lambda k: (changes[k], abs(k - 1))) + 1


@frozen(eq=False)
class ByDifferences:
    """Central differences, eight to ten digits.

    `steps`, relative to the larger of `unit` and component, of shape (N + 1,). `usual`, shape (N,): each equation's
    change as all components move by their sizes.
    """

    unit: Array
    steps: Array
    usual: Array
    name: str = "differences"
    agreement: float = AGREEMENT
    references: tuple[str, ...] = ()

    def over(self, noise: Array) -> ByDifferences:
        """Differences with steps that balance noise, shape (N,), and curvature."""
        known = self.usual > 0.0
        least = float(np.cbrt((noise[known] / self.usual[known]).max(initial=0.0)))
        return evolve(self, steps=np.maximum(self.steps, min(least, float(DIFFERENCE_STEPS[0]))))

    @property
    def even(self) -> Array:
        """Factors of `scale` that move all components alike, relative to size."""
        return np.asarray(np.median(self.steps) / self.steps)

    def scale(self, u: Array) -> Array:
        """Difference steps at u, as rounding leaves them, shape (N + 1,)."""
        reach = self.steps * np.maximum(self.unit, np.abs(u))
        return np.asarray(0.5 * ((u + reach) - (u - reach)))

    def __call__(self, residual: Residual, u: Array, directions: Array) -> Array:
        """H'(u) times directions in units of `scale`, (k, N + 1) to (N, k), by two residuals each."""
        return np.stack([_central(residual, u, w) for w in directions * self.scale(u)], axis=1)

    def whole(self, residual: Residual, u: Array) -> Array:
        """H'(u), column by column."""
        return self(residual, u, np.eye(u.size)) / self.scale(u)


def by_differences(residual: Residual, u0: Array, groups: Any = None) -> ByDifferences:
    """Differences with the best step for each component at `u0`.

    `groups`, shape (N + 1,): labels of components with a common step; default: none.
    """
    steps, size = np.empty_like(u0), sizes(u0)
    unit = size.copy()
    groups = np.arange(u0.size) if groups is None else groups
    usual = np.nan_to_num(np.abs(difference_along(residual, u0, size * generic(u0.size))[0]))
    for group in range(int(groups.max()) + 1):
        own, reach = groups == group, size.copy()
        while True:
            changes = _trials(residual, u0, np.where(own, reach, 0.0), usual)[1]
            seen = changes.sum(axis=1)
            steps[own], unit[own] = DIFFERENCE_STEPS[_best(seen)], reach[own]
            # An almost zero component has no unit: try longer steps that agree as well.
            longer = own & (size < USUAL_STEP) & (reach < 1.0)
            longer &= (seen[0] <= seen.min()) | (changes.min() == 1.0)
            if not longer.any():
                break
            reach[longer] = np.minimum(reach[longer] / DIFFERENCE_STEPS[3], 1.0)
    return ByDifferences(unit, steps, usual)


Products: TypeAlias = Exact | ByDifferences


def agree(products: Exact, residual: Residual, u: Array, w: Array) -> bool:
    """Whether a product with w agrees with a difference in each row; ``abs`` of complex numbers does not."""
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("error", np.exceptions.ComplexWarning)
            found = products(residual, u, w[None])[:, 0]
    except (TypeError, ArithmeticError, ValueError, AttributeError, IndexError, np.exceptions.ComplexWarning):
        return False
    expected = _trials(residual, u, w)[0]
    expected = expected[np.isfinite(expected).all(axis=1)]
    if not len(expected) or found.shape != expected.shape[1:]:
        return False
    # A zero row takes the others' unit.
    size = AGREEMENT * (np.abs(found) + np.abs(expected))
    least = AGREEMENT * size.max(axis=1, initial=0.0, keepdims=True)
    return bool((np.abs(found - expected) <= np.maximum(size, least)).any(axis=0).all())


def exact(residual: Residual, u: Array, w: Array) -> Exact | None:
    """Products H' v without truncation error, by jets, else complex steps; None if neither agrees with differences
    along w.
    """
    return next((products for products in (BY_JETS, BY_COMPLEX_STEP) if agree(products, residual, u, w)), None)
