"""Numbers or intervals, times a truncated algebra: arrays on which functions in plain numpy give series and ranges.

A ring (floats, or ends of intervals that are rounded outward) and an algebra (Taylor series along one direction, first
derivatives in many, either beside one direction more) make an array that numpy accepts. One dispatch of numpy's
functions serves all of them. Users call `continuation.jets` and `continuation.intervals`.
"""

from continuation.numbers.array import Interval, Jet
from continuation.numbers.functions import FUNCTION_RULES
from continuation.numbers.series import JetDomainError
from continuation.numbers.truncated import FUNCTIONS
from continuation.numbers.ufuncs import UndecidedError

__all__ = ["Interval", "Jet", "JetDomainError", "UndecidedError"]

FUNCTIONS.update(FUNCTION_RULES)
