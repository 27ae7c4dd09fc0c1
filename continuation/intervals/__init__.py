"""Interval arithmetic on numpy arrays, rounded outward."""

from continuation.numbers import Interval, UndecidedError
from continuation.numbers.boxes import enclose, jacobian

__all__ = ["Interval", "UndecidedError", "enclose", "jacobian"]
