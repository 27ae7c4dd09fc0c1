"""Paths: points, events, parts, refinement, interrupts."""

from continuation.path.path import LocatedEvent, Path, Step

__all__ = ["LocatedEvent", "Path", "Step"]
