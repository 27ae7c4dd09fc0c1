"""Protocols of plug-ins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from inspect import get_annotations
from typing import Any, Protocol, runtime_checkable

from continuation.arrays import Array, Matrix
from continuation.events import Event
from continuation.events.box import Box
from continuation.linear import BorderedSystem
from continuation.metric import Metric


class Homotopy(Protocol):
    """A map H: R^N x R -> R^N whose zeros form the path; no base class."""

    def start(self) -> tuple[Array, float]:
        """Return a point (y0, lam0) on or near the path."""
        ...

    def residual(self, y: Array, lam: float) -> Array:
        """Return H(y, lam), shape (N,), without modifying `y`.

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float

        Returns
        -------
        ndarray, shape (N,)
        """
        ...


@runtime_checkable
class SupportsJacobian(Protocol):
    """The derivative; default: `differential`, jets, complex step or differences."""

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """Return (H_y, H_lam).

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float

        Returns
        -------
        H_y : ndarray, sparse array, Banded or LinearOperator, shape (N, N)
        H_lam : ndarray, shape (N,)
        """
        ...


@runtime_checkable
class SupportsSparsity(Protocol):
    """Sparsity of H_y without `jacobian`; default: searched from 64 unknowns on.

    Shape (N, N), dense or sparse; nonzeros count. Columns without common equations are differentiated together.
    """

    sparsity: Matrix


@runtime_checkable
class SupportsTarget(Protocol):
    """Final parameter value, or None; default 0."""

    target: float | None


@runtime_checkable
class SupportsBordered(Protocol):
    """The homotopy's own factorisation of [[H_y, H_lam], [border]]."""

    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix.

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float
        border : ndarray, shape (N + 1,)
            Last row.

        Returns
        -------
        BorderedSystem
        """
        ...


@runtime_checkable
class SupportsDifferential(Protocol):
    """H' times a vector; without `bordered` the library builds H' from products."""

    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """Return H_y v_y + H_lam v_lam.

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float
        v : ndarray, shape (N + 1,)

        Returns
        -------
        ndarray, shape (N,)
        """
        ...


class TangentPoint(Protocol):
    """A point of the path for plug-ins."""

    @property
    def u(self) -> Array:
        """(y, lam) as one vector, shape (N + 1,)."""
        ...

    @property
    def tangent(self) -> Array:
        """Unit vector in the metric, shape (N + 1,)."""
        ...

    def solve(self, r: Array, rho: float = 0.0) -> Array:
        """Return z with ``H' z = r``, ``border . z = rho``; the border is dual to the tangent.

        Parameters
        ----------
        r : ndarray, shape (N,)
        rho : float

        Returns
        -------
        ndarray, shape (N + 1,)
        """
        ...


@runtime_checkable
class SupportsTaylor(Protocol):
    """The homotopy's own path coefficients."""

    def taylor(self, point: TangentPoint, order: int) -> Array:
        """Return c: u(s) = sum_k c[k] s^k, border . (u(s) - u(0)) = s.

        Parameters
        ----------
        point : TangentPoint
        order : int
            Of the last coefficient, at least 1.

        Returns
        -------
        ndarray, shape (order + 1, N + 1)
        """
        ...


@runtime_checkable
class SupportsMaxStep(Protocol):
    """The path stays inside a domain."""

    def max_step(self, u: Array, v: Array) -> float:
        """Return the largest h >= 0 (or inf) such that u + t v is inside for t in [0, h).

        Parameters
        ----------
        u : ndarray, shape (N + 1,)
            A point inside.
        v : ndarray, shape (N + 1,)
            Of any length.

        Returns
        -------
        float
        """
        ...


@runtime_checkable
class SupportsMetric(Protocol):
    """The inner product for arclength."""

    metric: Metric


@runtime_checkable
class SupportsExtents(Protocol):
    """Positive sizes of unknowns and parameter, shape (N + 1,), which scale those that stand still at the start."""

    extents: Array


@runtime_checkable
class SupportsBlocks(Protocol):
    """Unknowns that sample one field and share a scale of the default metric."""

    blocks: Sequence[int]


@runtime_checkable
class SupportsFinish(Protocol):
    """The problem's own end, tried after accepted steps."""

    def finish(self, y: Array, lam: float) -> Array | None:
        """Return the solution at the target, found from a point of the path and verified; None to trace on.

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float

        Returns
        -------
        ndarray, shape (N,), or None
        """
        ...


@runtime_checkable
class SupportsObserve(Protocol):
    """Extra scalars stored with each point."""

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """Return scalars, the same names at every point.

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float

        Returns
        -------
        dict of str to float
        """
        ...


@runtime_checkable
class SupportsNames(Protocol):
    """Names for axes, tables and archives; all optional."""

    parameter_name: str
    names: Sequence[str]
    """One for each unknown."""
    units: Mapping[str, str]
    """By name of parameter, unknown or observed scalar."""


@runtime_checkable
class SupportsEvents(Protocol):
    """Events of the homotopy, added to the caller's."""

    events: Sequence[Event]


@runtime_checkable
class SupportsBound(Protocol):
    """An event that needs the path's evaluator."""

    def bound(self, evaluator: Any) -> Watcher:
        """Return a copy of the event for one path, which may keep what it learns there.

        Parameters
        ----------
        evaluator : Evaluator
        """
        ...


@runtime_checkable
class Watcher(Event, Protocol):
    """An event that finds its own points on an arc."""

    def found_on(self, solver: Any, arc: Any) -> list[Any]:
        """Return its points on an arc, in order.

        Parameters
        ----------
        solver : PathSolver
        arc : Arc
        """
        ...

    def accounts_for(self, arc: Any, found: Sequence[tuple[Any, Any]]) -> bool:
        """Return whether the events found explain the watched quantity's change; if not, a shorter arc is tried.

        Parameters
        ----------
        arc : Arc
        found : sequence of (Kind, Linearization)
        """
        ...

    def observe(self, u: Array) -> Mapping[str, float]:
        """Return scalars stored with a point.

        Parameters
        ----------
        u : ndarray, shape (N + 1,)
        """
        ...


@runtime_checkable
class SupportsPieces(Protocol):
    """A continuous map, smooth where no switch changes sign.

    Its pieces have `jacobian`, `bordered`, `differential`, `taylor`; the map has everything else.
    """

    def switches(self, y: Array, lam: float) -> Array:
        """Return smooth switches, shape (m,), that do not vanish along a path.

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float
        """
        ...

    def piece(self, signs: Array) -> Homotopy:
        """Return the smooth homotopy for these signs, defined slightly beyond.

        Parameters
        ----------
        signs : ndarray of int, shape (m,)
            Each -1 or +1.

        Raises
        ------
        ValueError
            If no piece has these signs.
        """
        ...


class SupportsBox(Protocol):
    """A box for callers without target, events and box."""

    box: Box


@runtime_checkable
class SupportsReferences(Protocol):
    """Publications of the method."""

    references: Sequence[str]
    """BibTeX entries."""


@lru_cache(maxsize=32)
def _names(protocol: Any) -> tuple[str, ...]:
    names = {**vars(protocol), **get_annotations(protocol)}
    return tuple(name for name in names if not name.startswith("_"))


def offers(part: Any, protocol: Any) -> bool:
    """Whether an object has a Protocol's attributes, ten times as fast as `isinstance`."""
    return all(getattr(part, name, None) is not None for name in _names(protocol))
