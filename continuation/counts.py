"""What a trace cost."""

from __future__ import annotations

from attrs import asdict, define


@define
class Counts:
    """What a trace cost. One factorisation is O(N^3) dense, one solve O(N^2), one residual what the plug-in says."""

    residuals: int = 0
    jacobians: int = 0
    factorizations: int = 0
    solves: int = 0
    accepted: int = 0
    rejected: int = 0

    def as_dict(self) -> dict[str, int]:
        """The counts by name."""
        return asdict(self)

    def copy(self) -> Counts:
        """The counts as they stand."""
        return Counts(**asdict(self))

    def __add__(self, other: Counts) -> Counts:
        mine, theirs = asdict(self), asdict(other)
        return Counts(**{name: mine[name] + theirs[name] for name in mine})
