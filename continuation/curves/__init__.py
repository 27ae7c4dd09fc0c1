"""Curves of events in a second parameter."""

from continuation.curves.curve import Curve
from continuation.curves.family import Family

__all__ = ["Curve", "Family"]
