"""What a plug-in is: three methods, and capabilities that are found by their presence."""

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
    """A map H: R^N x R -> R^N whose zero set holds the path. No base class is needed."""

    def start(self) -> tuple[Array, float]:
        """A point (y0, lam0) on, or near, the path."""
        ...

    def residual(self, y: Array, lam: float) -> Array:
        """H(y, lam), shape (N,). Must not modify `y`.

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
    """The derivative; without it products with `differential`, jets, complex step or differences serve."""

    def jacobian(self, y: Array, lam: float) -> tuple[Matrix, Array]:
        """(H_y, H_lam): an (N, N) matrix (dense, sparse, Banded, LinearOperator) and an (N,) array.

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
    """Where H_y may have entries, for a homotopy without `jacobian`: else that is looked for, from 64 unknowns on.

    Shape (N, N), an array or a sparse one: what is not zero counts. H_y then comes by groups of columns that have no
    equation in common, each evaluation checked by one more product: entries that are missing are noticed, and found.
    """

    sparsity: Matrix


@runtime_checkable
class SupportsTarget(Protocol):
    """The parameter value at which the path ends; 0 where a homotopy does not say, None for no target."""

    target: float | None


@runtime_checkable
class SupportsBordered(Protocol):
    """A factorisation of its own for [[H_y, H_lam], [border]], which replaces the library's."""

    def bordered(self, y: Array, lam: float, border: Array) -> BorderedSystem:
        """Factor the bordered matrix at (y, lam); `border` has shape (N + 1,).

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float
        border : ndarray, shape (N + 1,)
            The last row: (H_y, H_lam) has one more column than rows.

        Returns
        -------
        BorderedSystem
        """
        ...


@runtime_checkable
class SupportsDifferential(Protocol):
    """H' applied to a direction.

    With `bordered`, for a homotopy that never forms its matrix; without it and `jacobian`, H' is made of such products.
    """

    def differential(self, y: Array, lam: float, v: Array) -> Array:
        """H_y v_y + H_lam v_lam, shape (N,).

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float
        v : ndarray, shape (N + 1,)
            The direction (v_y, v_lam).

        Returns
        -------
        ndarray, shape (N,)
        """
        ...


class TangentPoint(Protocol):
    """A point of the path as a plug-in sees it: what coefficients of a series are made of."""

    @property
    def u(self) -> Array:
        """(y, lam) as one vector, shape (N + 1,)."""
        ...

    @property
    def tangent(self) -> Array:
        """Of unit length in the metric, shape (N + 1,)."""
        ...

    def solve(self, r: Array, rho: float = 0.0) -> Array:
        """The solution z, shape (N + 1,), of ``H' z = r``, ``border . z = rho``, the border dual to the tangent.

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
    """Path coefficients of its own, usually by convolutions, from the factorisation of the point."""

    def taylor(self, point: TangentPoint, order: int) -> Array:
        """Coefficients c, shape (order + 1, N + 1): u(s) = sum_k c[k] s^k, border . (u(s) - u(0)) = s.

        Parameters
        ----------
        point : TangentPoint
            Where the path is expanded.
        order : int
            Of the last coefficient, at least 1.

        Returns
        -------
        ndarray, shape (order + 1, N + 1)
        """
        ...


@runtime_checkable
class SupportsMaxStep(Protocol):
    """An interior path: how far one may go along v and stay inside."""

    def max_step(self, u: Array, v: Array) -> float:
        """The largest h >= 0 (or inf) for which u + t v is admissible for every t in [0, h).

        Parameters
        ----------
        u : ndarray, shape (N + 1,)
            A point inside.
        v : ndarray, shape (N + 1,)
            A direction, of any length.

        Returns
        -------
        float
        """
        ...


@runtime_checkable
class SupportsMetric(Protocol):
    """The inner product in which this homotopy's arclength makes sense."""

    metric: Metric


@runtime_checkable
class SupportsExtents(Protocol):
    """How large the unknowns and the parameter are, about: what moves by less than their round-off stands still.

    Positive, shape (N + 1,). Of use where unknowns stand at zero all along, and nothing else tells their units.
    """

    extents: Array


@runtime_checkable
class SupportsBlocks(Protocol):
    """Which unknowns are samples of one field: the default metric gives those of one label one scale."""

    blocks: Sequence[int]
    """A label for each unknown: 0, 1, ..."""


@runtime_checkable
class SupportsFinish(Protocol):
    """A problem's own way to end, tried after accepted steps; returns the end y at the target, or None."""

    def finish(self, y: Array, lam: float) -> Array | None:
        """The end point, certified by the problem, or None to go on tracing.

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
    """Extra scalars, stored with every point of an archive."""

    def observe(self, y: Array, lam: float) -> dict[str, float]:
        """Named scalars at a point; the same names at every point.

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
    """What the parameter and the unknowns are called: for axes, tables and archives. Each of the three is optional."""

    parameter_name: str
    names: Sequence[str]
    """One an unknown."""
    units: Mapping[str, str]
    """By name: of the parameter, the unknowns, and what is observed."""


@runtime_checkable
class SupportsEvents(Protocol):
    """Events that belong to the homotopy, added to those of the call."""

    events: Sequence[Event]


@runtime_checkable
class SupportsPieces(Protocol):
    """A piecewise smooth map: smooth where no switching function changes its sign, and continuous where one does.

    `start`, `residual` and the other capabilities that belong to a path (`target`, `max_step`, `metric`, `events`,
    `finish`, `observe`) are asked of the map; `jacobian`, `bordered`, `differential` and `taylor` of its pieces.
    """

    def switches(self, y: Array, lam: float) -> Array:
        """The switching functions, shape (m,): smooth, and none vanishes on an open part of a path.

        Parameters
        ----------
        y : ndarray, shape (N,)
        lam : float
        """
        ...

    def piece(self, signs: Array) -> Homotopy:
        """The smooth homotopy that the map is where the switches have these signs, defined a little beyond.

        Parameters
        ----------
        signs : ndarray of int, shape (m,)
            Each of them -1 or +1.

        Raises
        ------
        ValueError
            If such signs cannot hold together anywhere: then there is no such piece.
        """
        ...


class SupportsBox(Protocol):
    """Where its path ends for those who say nothing of that: no target, no events, no box."""

    box: Box


@runtime_checkable
class SupportsReferences(Protocol):
    """Where the method was published."""

    references: Sequence[str]
    """BibTeX entries."""


@lru_cache(maxsize=32)
def _names(protocol: Any) -> tuple[str, ...]:
    names = {**vars(protocol), **get_annotations(protocol)}
    return tuple(name for name in names if not name.startswith("_"))


def offers(part: Any, protocol: Any) -> bool:
    """Whether an object has what a Protocol of capabilities names: as `isinstance` says, in a tenth of its time."""
    return all(getattr(part, name, None) is not None for name in _names(protocol))
