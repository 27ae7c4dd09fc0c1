"""Events: functions along the path whose zeros are located on corrected points, never interpolated."""

from continuation.events.monitors import Event, KinkPoint, Monitor, TargetValue, TurningPoint

__all__ = ["Event", "KinkPoint", "Monitor", "TargetValue", "TurningPoint"]
