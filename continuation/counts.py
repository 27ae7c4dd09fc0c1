"""Counts of a trace's operations."""

from __future__ import annotations

from attrs import asdict, define, field


@define
class Counts:
    """Operations of a trace."""

    residuals: int = 0
    jacobians: int = 0
    factorizations: int = 0
    solves: int = 0
    accepted: int = 0
    rejected: int = 0
    notes: set[str] = field(factory=set, eq=False, repr=False, kw_only=True)
    """How missing derivatives were made; not archived."""

    def as_dict(self) -> dict[str, int]:
        """The counts by name."""
        return asdict(self, filter=lambda attribute, _: attribute.name != "notes")

    def copy(self) -> Counts:
        """A copy."""
        return Counts(*self.as_dict().values(), notes=set(self.notes))

    def __add__(self, other: Counts) -> Counts:
        mine, theirs = self.as_dict(), other.as_dict()
        return Counts(*(mine[name] + theirs[name] for name in mine), notes=self.notes | other.notes)

    def __str__(self) -> str:
        return "; ".join([repr(self), *sorted(self.notes)])
