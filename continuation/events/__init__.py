"""Events: zeros of functions along the path."""

from continuation.events.monitors import Event, KinkPoint, Monitor, TargetValue, TurningPoint

__all__ = ["Event", "KinkPoint", "Monitor", "TargetValue", "TurningPoint"]
