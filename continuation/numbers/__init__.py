"""Arrays of truncated series of numbers or intervals, accepted by numpy.

Coefficients are floats or outward-rounded intervals; algebras are Taylor series, first derivatives, or either with one
more direction. Users call `continuation.jets` and `continuation.intervals`.
"""

from continuation.numbers.array import Interval, Jet
from continuation.numbers.functions import FUNCTION_RULES
from continuation.numbers.series import JetDomainError
from continuation.numbers.truncated import FUNCTIONS
from continuation.numbers.ufuncs import UndecidedError

__all__ = ["Interval", "Jet", "JetDomainError", "UndecidedError"]

FUNCTIONS.update(FUNCTION_RULES)
