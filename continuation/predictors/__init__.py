"""Predictors extrapolate the path."""

from continuation.predictors.base import Knot, Prediction, Predictor
from continuation.predictors.polynomial import Hermite, Tangent
from continuation.predictors.taylor import Taylor

__all__ = ["Hermite", "Knot", "Prediction", "Predictor", "Tangent", "Taylor"]
