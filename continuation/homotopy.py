"""What a plug-in is: three methods, and capabilities that are found by their presence."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from attrs import field, frozen

from continuation.arrays import Array, Matrix

if TYPE_CHECKING:
    from continuation.events import Event
    from continuation.linear import BorderedSystem
    from continuation.linearization import Linearization
    from continuation.metric import Metric


class Homotopy(Protocol):
    """A map H: R^N x R -> R^N whose zero set holds the path. No base class is needed."""

    def start(self) -> tuple[Array, float]:
        """A point (y0, lam0) on, or near, the path."""
        ...

    def residual(self, y: Array, lam: float) -> Array:
        """H(y, lam), shape (N,). Must not modify `y`."""
        ...


@runtime_checkable
class SupportsJacobian(Protocol):
    """The derivative; without it jets, complex step or differences serve, at a cost shown in the counts."""

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam): an (N, N) matrix (dense, sparse, Banded, LinearOperator) and an (N,) array."""
        ...


@runtime_checkable
class SupportsTarget(Protocol):
    """The parameter value at which the path ends; 0 where a homotopy does not say, None for no target."""

    target: float | None


@runtime_checkable
class SupportsBordered(Protocol):
    """A factorisation of its own for [[H_y, H_lam], [border]], which replaces the library's."""

    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix at (y, lam); `border` has shape (N + 1,)."""
        ...


@runtime_checkable
class SupportsDifferential(Protocol):
    """H' applied to a direction, for a homotopy with `bordered` that never forms its matrix."""

    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """H_y v_y + H_lam v_lam, shape (N,)."""
        ...


@runtime_checkable
class SupportsTaylor(Protocol):
    """Path coefficients of its own, usually by convolutions, from the factorisation of the point."""

    def taylor(self, point: Linearization, order: int) -> Array:
        """Coefficients c, shape (order + 1, N + 1): u(s) = sum_k c[k] s^k, border . (u(s) - u(0)) = s."""
        ...


@runtime_checkable
class SupportsMaxStep(Protocol):
    """An interior path: how far one may go along v and stay inside."""

    def max_step(self, u: Array, v: Array) -> float:
        """The largest h >= 0 (or inf) for which u + t v is admissible for every t in [0, h)."""
        ...


@runtime_checkable
class SupportsMetric(Protocol):
    """The inner product in which this homotopy's arclength makes sense."""

    metric: Metric


@runtime_checkable
class SupportsFinish(Protocol):
    """A problem's own way to end, tried after accepted steps; returns the end y at the target, or None."""

    def finish(self, y: Array, lam: float) -> Array | None:
        """The end point, certified by the problem, or None to go on tracing."""
        ...


@runtime_checkable
class SupportsObserve(Protocol):
    """Extra scalars, stored with every point of an archive."""

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """Named scalars at a point; the same names at every point."""
        ...


@runtime_checkable
class SupportsEvents(Protocol):
    """Events that belong to the homotopy, added to those of the call."""

    events: Sequence[Event]


@runtime_checkable
class SupportsReferences(Protocol):
    """Where the method was published."""

    references: Sequence[str]
    """BibTeX entries."""


def _start_vector(y: object) -> Array:
    return np.array(y, dtype=float, ndmin=1)


@frozen(eq=False)
class FunctionHomotopy:
    """A homotopy made of a residual alone; see `from_functions`."""

    function: Callable[[Any, Any], Any]
    y0: Array = field(converter=_start_vector)
    lam0: float = field(converter=float)
    target: float | None = 0.0

    def start(self) -> tuple[Array, float]:
        """The given start."""
        return self.y0.copy(), self.lam0

    def residual(self, y: Array, lam: float) -> Array:
        """The given residual."""
        value: Array = self.function(y, lam)
        return value


@frozen(eq=False)
class DifferentiableHomotopy:
    """A homotopy made of a residual and its derivative; see `from_functions`."""

    plain: FunctionHomotopy
    derivative: Callable[[Any, Any], tuple[Matrix, Array]]

    @property
    def target(self) -> float | None:
        """Where the path is to end."""
        return self.plain.target

    def start(self) -> tuple[Array, float]:
        """The given start."""
        return self.plain.start()

    def residual(self, y: Array, lam: float) -> Array:
        """The given residual."""
        return self.plain.residual(y, lam)

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """The given derivative."""
        return self.derivative(y, lam)


def from_functions(
    residual: Callable[[Any, Any], Any],
    jacobian: Callable[[Any, Any], tuple[Any, Any]] | None = None,
    *,
    start: tuple[Any, float],
    target: float | None = 0.0,
) -> FunctionHomotopy | DifferentiableHomotopy:
    """Make a homotopy of functions.

    Parameters
    ----------
    residual : callable
        ``residual(y, lam) -> (N,)``.
    jacobian : callable, optional
        ``jacobian(y, lam) -> (H_y, H_lam)``; without it derivatives come from `residual`.
    start : tuple
        ``(y0, lam0)``, a point on or near the path.
    target : float or None
        Where the path is to end; None for a curve that is followed for its own sake.
    """
    y0, lam0 = start
    plain = FunctionHomotopy(residual, y0, lam0, target)
    return plain if jacobian is None else DifferentiableHomotopy(plain, jacobian)
