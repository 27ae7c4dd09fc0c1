"""Predictors: curves that extrapolate the path from its points and tangents."""

from continuation.predictors.base import Knot, Prediction, Predictor, SupportsSegment
from continuation.predictors.polynomial import Hermite, Polynomial, Secant, Tangent
from continuation.predictors.taylor import Taylor

__all__ = ["Hermite", "Knot", "Polynomial", "Prediction", "Predictor", "Secant", "SupportsSegment", "Tangent", "Taylor"]
