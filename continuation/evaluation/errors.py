"""Errors of evaluations."""

from __future__ import annotations

import os
from traceback import walk_tb
from typing import ClassVar

from continuation.rejection import Rejection


class EvaluationError(ArithmeticError):
    """The homotopy has no finite value or factorisation at a point."""

    rejection: ClassVar[Rejection] = Rejection.UNSOLVABLE


class NotFiniteError(EvaluationError):
    """The edge of the domain, or an overflow."""

    rejection = Rejection.NO_VALUE


class RaisedError(EvaluationError):
    """The homotopy raises ValueError: outside its domain, or by mistake."""

    rejection = Rejection.RAISED


class SingularPointError(EvaluationError):
    """The bordered matrix is singular."""

    rejection = Rejection.SINGULAR


MATHS_OWN = ("math domain error", "expected a")
"""Beginnings of `math`'s domain errors, to Python 3.13 and from 3.14."""


def unevaluated(what: str, error: BaseException) -> EvaluationError:
    """A domain error for exceptions of `math`, numpy and scipy, else the author's."""
    if isinstance(error, EvaluationError):
        # A homotopy inside this one raised it.
        return error
    *_, (frame, line) = walk_tb(error.__traceback__)
    module = str(frame.f_globals.get("__name__", "")).partition(".")[0]
    if type(error) is not ValueError or module in ("numpy", "scipy") or str(error).startswith(MATHS_OWN):
        return NotFiniteError(f"the {what} could not be evaluated: {error}")
    return RaisedError(f"ValueError: {error} ({os.path.basename(frame.f_code.co_filename)}, line {line})")
