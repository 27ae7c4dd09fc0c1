"""Events: zeros of functions along the path, located on corrected points."""

from continuation.events.monitors import Event, KinkPoint, Monitor, TargetValue, TurningPoint

__all__ = ["Event", "KinkPoint", "Monitor", "TargetValue", "TurningPoint"]
