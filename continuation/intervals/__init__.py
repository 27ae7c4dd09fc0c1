"""Interval arithmetic on numpy arrays: functions written in plain numpy over boxes, rounded outward."""

from continuation.intervals.array import FUNCTIONS, Interval, UndecidedError
from continuation.intervals.calculus import enclose, jacobian
from continuation.intervals.functions import RULES
from continuation.intervals.operations import apply

__all__ = ["Interval", "UndecidedError", "enclose", "jacobian"]

FUNCTIONS.update(RULES)
FUNCTIONS["ufunc"] = apply
