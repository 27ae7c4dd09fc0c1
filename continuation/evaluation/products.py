"""Products H'(u) w of a homotopy that gives only its residual: by jets, the complex step, or differences."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, ClassVar, Protocol

import numpy as np
from attrs import evolve, frozen

from continuation.arrays import Array
from continuation.citation.bibliography import GRIEWANK_WALTHER, SQUIRE_TRAPP
from continuation.evaluation.pattern import generic

Residual = Callable[..., Any]
"""``residual(y, lam) -> (N,)``."""


class Products(Protocol):
    """A way to get H' without its author."""

    @property
    def name(self) -> str:
        """How it is called."""
        ...

    @property
    def agreement(self) -> float:
        """How far two sums of the same products may differ, beside the sum of their terms."""
        ...

    @property
    def references(self) -> tuple[str, ...]:
        """Where it was published, in BibTeX."""
        ...

    @property
    def even(self) -> Array | float:
        """In units of `scale`, what moves each component as far as the others, beside its size."""
        ...

    def scale(self, u: Array) -> Array | None:
        """What directions are measured in at u, shape (N + 1,); None for 1."""
        ...

    def __call__(self, residual: Residual, u: Array, directions: Array) -> Array:
        """H'(u) times each of the directions, in units of `scale`: (k, N + 1) gives (N, k)."""
        ...

    def whole(self, residual: Residual, u: Array) -> Array:
        """All of H'(u), shape (N, N + 1)."""
        ...


@frozen
class Exact:
    """Products to round-off.

    `function`: The residual, u and directions (k, N + 1) to (N, k). `entire`: The same for all unit vectors, where that
    can be done better.
    """

    name: str
    function: Callable[[Residual, Array, Array], Array]
    references: tuple[str, ...] = ()
    entire: Callable[[Residual, Array], Array] | None = None
    agreement: ClassVar[float] = float(np.sqrt(np.finfo(float).eps))
    even: ClassVar[float] = 1.0

    def scale(self, u: Array) -> None:
        """None: units do not matter to it."""

    def __call__(self, residual: Residual, u: Array, directions: Array) -> Array:
        """H'(u) times each of the directions."""
        return self.function(residual, u, directions)

    def whole(self, residual: Residual, u: Array) -> Array:
        """All of H'(u)."""
        return self(residual, u, np.eye(u.size)) if self.entire is None else self.entire(residual, u)


def _by_jets(residual: Residual, u: Array, directions: Array) -> Array:
    """All directions go through the residual together."""
    from continuation import jets

    def along(s: Any) -> Any:
        at = u + s @ directions
        return residual(at[:-1], at[-1])

    return jets.jacobian(along, np.zeros(len(directions)))


def _all_by_jets(residual: Residual, u: Array) -> Array:
    from continuation import jets

    return jets.jacobian(lambda at: residual(at[:-1], at[-1]), u)


def _by_complex_step(residual: Residual, u: Array, directions: Array) -> Array:
    moved = (u + 1e-200j * w for w in directions)
    return np.stack([np.asarray(residual(at[:-1], at[-1])).imag * 1e200 for at in moved], axis=1)


BY_JETS = Exact("jets", _by_jets, (GRIEWANK_WALTHER,), _all_by_jets)
"""By truncated Taylor arithmetic, `continuation.jets`."""

BY_COMPLEX_STEP = Exact("complex step", _by_complex_step, (SQUIRE_TRAPP,))
"""One complex residual a direction (Squire and Trapp, SIAM Review 40, 1998)."""


def given(differential: Callable[[Array, float, Array], Array]) -> Exact:
    """By the homotopy's own `differential`."""

    def function(residual: Residual, u: Array, directions: Array) -> Array:
        y, lam = u[:-1], float(u[-1])
        return np.stack([np.asarray(differential(y, lam, w), dtype=float) for w in directions], axis=1)

    return Exact("differential", function)


DIFFERENCE_STEPS = 6e-6 * 100.0 ** np.arange(2, -5, -1)
"""Steps of central differences beside the size of a component (or 1, where it is 0): eps^(1/3), the best one where that
is how far the function sees it, and others, since zero may lie anywhere and units may be any."""


CHANCE = float(np.finfo(float).eps) ** (2.0 / 3.0)
"""Two differences that agree better do so by chance, as where all is linear: that is the accuracy of the best one."""


def sizes(u: Array) -> Array:
    """What the steps of differences are measured by: a component's size, or 1."""
    return np.where(u != 0.0, np.abs(u), 1.0)


def _trials(residual: Residual, u: Array, w: Array, rows: Array | float = 0.0) -> tuple[list[Array], Array]:
    """Central differences along w at all steps, and how much each changes from one step to the next: (steps - 1, N).

    The change is beside its own size, or that of its `rows`, shape (N,), the sizes of differences in other directions:
    of an equation that does not change along w noise would choose the step.
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
        # Two zeros agree where an equation does not depend on w, and not where it only does not see so short a step, as
        # one in single precision does.
        seen = (np.array(found) != 0.0).any(axis=0)
        changes = []
        for one, other in pairwise(found):
            size = np.maximum(np.abs(one) + np.abs(other), rows)
            change = np.where(
                (one == 0.0) & (other == 0.0) & seen, 1.0, np.abs(one - other) / np.where(size > 0.0, size, 1.0)
            )
            changes.append(np.maximum(np.where(np.isfinite(change), change, 1.0), CHANCE))
    return found, np.array(changes)


def difference_along(residual: Residual, u: Array, w: Array) -> tuple[Array, float]:
    """The central difference of a residual along w, and its step.

    Of several steps that one is taken at which the difference changes least from this to the next, in the mean over
    the equations, each beside its own size.

    `u`, `w` of shape (N + 1,).
    """
    found, changes = _trials(residual, u, w)
    best = int(_best(changes.mean(axis=1)))
    return found[best], float(DIFFERENCE_STEPS[best])


def _best(changes: Array) -> Any:
    """The step behind the smallest change along the last axis; of several, the one nearest to the usual step."""
    order = np.argsort(np.abs(np.arange(changes.shape[-1]) - 1), kind="stable")
    return order[np.argmin(changes[..., order], axis=-1)] + 1


@frozen(eq=False)
class ByDifferences:
    """Central differences, about eight to ten digits.

    `u0`, of shape (N + 1,): Where the steps were found. `steps`, of shape (N + 1,): Of each component, beside its size.
    `usual`, of shape (N,): How much each equation changes there, for a move of all components by their sizes.
    """

    u0: Array
    steps: Array
    usual: Array
    name: str = "differences"
    agreement: float = 1e-3
    references: tuple[str, ...] = ()

    def over(self, noise: Array) -> ByDifferences:
        """The same over steps in which noise of the equations, shape (N,), and curvature count about alike."""
        known = self.usual > 0.0
        least = float(np.cbrt((noise[known] / self.usual[known]).max(initial=0.0)))
        return evolve(self, steps=np.maximum(self.steps, min(least, float(DIFFERENCE_STEPS[0]))))

    @property
    def even(self) -> Array:
        """Steps may differ by orders of magnitude."""
        return np.asarray(np.median(self.steps) / self.steps)

    def scale(self, u: Array) -> Array:
        """The steps at u, as round-off leaves them."""
        reach = self.steps * np.maximum(sizes(self.u0), np.abs(u))
        return np.asarray(0.5 * ((u + reach) - (u - reach)))

    def __call__(self, residual: Residual, u: Array, directions: Array) -> Array:
        """Two residuals a direction."""
        found = []
        for w in directions * self.scale(u):
            ahead, behind = u + w, u - w
            change = np.array(residual(ahead[:-1], float(ahead[-1]))) - residual(behind[:-1], float(behind[-1]))
            found.append(0.5 * change)
        return np.stack(found, axis=1)

    def whole(self, residual: Residual, u: Array) -> Array:
        """All of H'(u), column by column."""
        return self(residual, u, np.eye(u.size)) / self.scale(u)


def by_differences(residual: Residual, u0: Array, groups: Any = None, rows: Any = None) -> ByDifferences:
    """Differences with steps found at `u0`, shape (N + 1,): each component has the one that suits its equations best.

    Parameters
    ----------
    residual : callable
    u0 : ndarray, shape (N + 1,)
    groups : ndarray of int, shape (N + 1,), optional
        Components of one group are moved together; by default each by itself.
    rows : sparse array, shape (N + 1, N), optional
        Of ones: the equations in which a component stands, no two of one group in the same. By default all.
    """
    steps, size = np.empty_like(u0), sizes(u0)
    groups = np.arange(u0.size) if groups is None else groups
    usual = np.nan_to_num(np.abs(difference_along(residual, u0, size * generic(u0.size))[0]))
    for group in range(int(groups.max()) + 1):
        own = groups == group
        changes = _trials(residual, u0, np.where(own, size, 0.0), usual)[1].T
        seen = changes.sum(axis=0)[None] if rows is None else rows[own] @ changes
        steps[own] = DIFFERENCE_STEPS[_best(seen)]
    return ByDifferences(u0, steps, usual)
