"""Events: functions along the path whose zeros are located on corrected points, never interpolated."""

from continuation.events.monitors import Event, Monitor, SupportsResolution, TargetValue, TurningPoint

__all__ = ["Event", "Monitor", "SupportsResolution", "TargetValue", "TurningPoint"]
