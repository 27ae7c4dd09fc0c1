"""Step controllers: accept a step, choose the next length."""

from continuation.controllers.base import Bounds, Controller, Decision, StepMeasures
from continuation.controllers.rules import AllgowerGeorg, Curvature, Fixed, Geometric, IterationCount, SeriesRange

__all__ = [
    "AllgowerGeorg",
    "Bounds",
    "Controller",
    "Curvature",
    "Decision",
    "Fixed",
    "Geometric",
    "IterationCount",
    "SeriesRange",
    "StepMeasures",
]
