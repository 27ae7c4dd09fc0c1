"""The event of a simple branch point."""

from __future__ import annotations

from attrs import field, frozen

from continuation.arguments.checks import integer
from continuation.arrays import Array
from continuation.status import Kind


@frozen
class BranchPoint:
    """Two branches cross: H' loses one rank.

    The tracer always watches for it; list it to stop there.
    """

    terminal: int = field(default=1, validator=integer(0))
    direction: int = field(default=0, init=False)
    kind: Kind = field(default=Kind.BRANCH_POINT, init=False)
    name: str = field(default="branch point", init=False)

    def monitor(self, u: Array, v: Array) -> float:
        """A constant, since the tracer watches."""
        return 1.0
