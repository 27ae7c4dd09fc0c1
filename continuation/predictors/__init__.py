"""Predictors: from the points and tangents so far, a curve that runs ahead of the path."""

from continuation.predictors.base import Knot, Prediction, Predictor, SupportsSegment
from continuation.predictors.polynomial import Hermite, Polynomial, Secant, Tangent
from continuation.predictors.taylor import Taylor

__all__ = ["Hermite", "Knot", "Polynomial", "Prediction", "Predictor", "Secant", "SupportsSegment", "Tangent", "Taylor"]
