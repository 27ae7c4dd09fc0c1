"""Piecewise smooth maps: switches, pieces, and the whole map."""

from __future__ import annotations

from typing import Any

import numpy as np
from attrs import field, frozen

from continuation.arguments.checks import complain
from continuation.arrays import Array, largest
from continuation.evaluation.products import USUAL_STEP, Exact, exact

Signs = tuple[int, ...]
"""The sign -1 or +1 of each switch: the name of a piece."""

REMEMBERED = 64
"""Pieces kept: kinks need the same few."""

NAMES = ("jacobian", "bordered", "differential", "taylor")


class SwitchError(ArithmeticError):
    """A switch has no finite value."""


@frozen(eq=False)
class Pieces:
    """The switches and pieces of one homotopy."""

    homotopy: Any
    _made: dict[Signs, Any] = field(factory=dict, init=False)
    _exact: list[Exact | None] = field(factory=list, init=False)

    def values(self, u: Array) -> Array:
        """The switches at u, shape (m,).

        `SwitchError` if not finite, `ValueError` unless a real vector.
        """
        try:
            with np.errstate(all="ignore"):
                found = np.asarray(self.homotopy.switches(u[:-1].copy(), float(u[-1])))
        except ArithmeticError as error:
            raise SwitchError(f"the switches could not be evaluated: {error}") from error
        if found.ndim != 1 or found.dtype.kind not in "fiu":
            raise complain(ValueError, "switches", "a vector of real numbers", found)
        if not np.isfinite(found).all():
            raise SwitchError("a switch is not finite")
        return np.array(found, dtype=float)

    def signs(self, u: Array) -> Signs:
        """The signs of a point; a zero switch counts as positive."""
        return tuple(np.where(self.values(u) >= 0.0, 1, -1).tolist())

    def piece(self, signs: Signs) -> Any:
        """The smooth homotopy of these signs."""
        if signs not in self._made:
            if len(self._made) >= REMEMBERED:
                self._made.clear()
            self._made[signs] = self.homotopy.piece(np.array(signs))
        return self._made[signs]

    def exists(self, signs: Signs) -> bool:
        """Whether these signs have a piece."""
        try:
            self.piece(signs)
        except ValueError:
            return False
        return True

    def along(self, u: Array, v: Array) -> Array:
        """Derivatives of the switches along v, shape (m,), by jets or differences."""
        switches, size = self.homotopy.switches, (largest(u) or 1.0) / (largest(v) or 1.0)
        if not self._exact:
            self._exact.append(exact(switches, u, size * v))
        if (products := self._exact[0]) is not None:
            return products(switches, u, v[None])[:, 0]
        h = USUAL_STEP * size
        change: Array = (self.values(u + h * v) - self.values(u - h * v)) / (2.0 * h)
        return change


class WholeMap:
    """All pieces as one homotopy that starts at u, shape (N + 1,), with the capabilities of the piece there."""

    def __init__(self, homotopy: Any, u: Array) -> None:
        self._pieces = Pieces(homotopy)
        self.start, self.residual = homotopy.start, homotopy.residual
        first = self._pieces.piece(self._pieces.signs(u))
        for name in NAMES[:-1]:
            if hasattr(first, name):
                setattr(self, name, self._local(name))

    def _local(self, name: str) -> Any:
        def at(y: Array, lam: float, *more: Any) -> Any:
            return getattr(self._pieces.piece(self._pieces.signs(np.append(y, lam))), name)(y, lam, *more)

        return at
