"""Why a homotopy has no value at a point: the errors that an evaluation raises, and which of them an exception is."""

from __future__ import annotations

import os
from traceback import walk_tb
from typing import ClassVar

from continuation.rejection import Rejection


class EvaluationError(ArithmeticError):
    """The homotopy has no finite value, or no factorisation, at a point; the sentence says which."""

    rejection: ClassVar[Rejection] = Rejection.UNSOLVABLE


class NotFiniteError(EvaluationError):
    """The homotopy has no finite value at a point: the edge of its domain, or an overflow."""

    rejection = Rejection.NO_VALUE


class RaisedError(EvaluationError):
    """The homotopy's own code says ``raise ValueError(...)`` at a point: the edge of its domain, or a mistake in it."""

    rejection = Rejection.RAISED


class SingularPointError(EvaluationError):
    """The bordered matrix has no factorisation at a point: it is singular there, as in a branch point."""

    rejection = Rejection.SINGULAR


MATHS_OWN = ("math domain error", "expected a")
"""How `math` begins to say that an argument lies outside a function's domain: up to Python 3.13, and from 3.14 on."""


def unevaluated(what: str, error: BaseException) -> EvaluationError:
    """The error for a function that raised: of `math`, numpy and scipy it is the domain's edge, else its author's."""
    if isinstance(error, EvaluationError):
        # Of a homotopy that evaluates others, which has said it.
        return error
    *_, (frame, line) = walk_tb(error.__traceback__)
    module = str(frame.f_globals.get("__name__", "")).partition(".")[0]
    if type(error) is not ValueError or module in ("numpy", "scipy") or str(error).startswith(MATHS_OWN):
        return NotFiniteError(f"the {what} could not be evaluated: {error}")
    return RaisedError(f"ValueError: {error} ({os.path.basename(frame.f_code.co_filename)}, line {line})")
