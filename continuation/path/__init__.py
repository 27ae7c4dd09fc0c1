"""Paths, their points and events."""

from continuation.path.path import LocatedEvent, Path, Step

__all__ = ["LocatedEvent", "Path", "Step"]
