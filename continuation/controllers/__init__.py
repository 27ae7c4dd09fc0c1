"""Step controllers."""

from continuation.controllers.base import Bounds, Controller, Decision, StepMeasures
from continuation.controllers.rules import AllgowerGeorg, Fixed, SeriesRange

__all__ = ["AllgowerGeorg", "Bounds", "Controller", "Decision", "Fixed", "SeriesRange", "StepMeasures"]
