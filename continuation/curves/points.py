"""Degenerate points of curves, as events."""

from __future__ import annotations

from typing import TYPE_CHECKING

from attrs import field, frozen

from continuation.arrays import Array
from continuation.status import Kind

if TYPE_CHECKING:
    from continuation.curves.curve import Curve


@frozen(eq=False)
class Sign:
    """Where a number changes its sign that a condition gives along with its values."""

    curve: Curve = field(repr=False)
    name: str
    terminal: int = field(default=0, init=False)
    direction: int = field(default=0, init=False)
    kind: Kind = field(default=Kind.EVENT, init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """The number."""
        return self.curve._at(u[:-1], float(u[-1])).local.sign(self.name)


@frozen(eq=False)
class OtherSwitch:
    """Where another switch of a piecewise smooth map vanishes: there the curve leaves the piece of its start."""

    curve: Curve = field(repr=False)
    index: int
    terminal: int = field(default=1, init=False)
    direction: int = field(default=0, init=False)
    kind: Kind = field(default=Kind.EVENT, init=False)

    @property
    def name(self) -> str:
        """Which of them."""
        return f"switch {self.index} vanishes"

    def monitor(self, u: Array, v: Array) -> float:
        """The switch."""
        n = self.curve.size.size - 1
        return float(self.curve.family(float(u[-1])).switches(u[:n], float(u[n]))[self.index])
