"""Length, angle and segment between two points of the path."""

from __future__ import annotations

import math

import numpy as np

from continuation.linearization import Linearization
from continuation.metric import inner, norm
from continuation.predictors import Prediction
from continuation.segment import Segment, hermite


def segment_between(a: Linearization, b: Linearization, prediction: Prediction) -> Segment:
    """The path between the two: the prediction where it is good enough for that, else the Hermite cubic."""
    # By name: an isinstance check of a Protocol costs more here than the rest of the function.
    if hasattr(prediction, "segment"):
        segment: Segment = prediction.segment(float(np.dot(a.border, b.u - a.u)), b.u)
        return segment
    return hermite(a.u, a.tangent, b.u, b.tangent, a.border)


def angle_between(a: Linearization, b: Linearization) -> float:
    """The angle between the tangents in the metric of a, radians."""
    cosine = inner(a.weights, a.tangent, b.tangent) / norm(a.weights, b.tangent)
    return math.acos(min(max(cosine, -1.0), 1.0))


def length_between(a: Linearization, b: Linearization, angle: float) -> float:
    """Arclength from a to b out of the chord: exact for a circle, an error of fifth order in the step otherwise."""
    half = 0.5 * angle
    chord = norm(a.weights, b.u - a.u)
    return chord * (half / math.sin(half)) if half > 1e-8 else chord
