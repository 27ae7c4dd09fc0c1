"""A path: its points and events, its parts, the same path with more points, and the path up to an interrupt."""

from continuation.path.path import LocatedEvent, Path, Step

__all__ = ["LocatedEvent", "Path", "Step"]
