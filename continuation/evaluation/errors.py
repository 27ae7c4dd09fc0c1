"""Why a homotopy has no value at a point: the errors that an evaluation raises, and which of them an exception is."""

from __future__ import annotations

import dis
import os
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


def unevaluated(what: str, error: BaseException) -> EvaluationError:
    """The error for a function that raised: of `math`, numpy and scipy it is the domain's edge, else its author's."""
    if isinstance(error, EvaluationError):
        # Of a homotopy that evaluates others, which has said it.
        return error
    place = error.__traceback__
    while place is not None and place.tb_next is not None:
        place = place.tb_next
    if type(error) is not ValueError or place is None:
        return NotFiniteError(f"the {what} could not be evaluated: {error}")
    code, module = place.tb_frame.f_code, str(place.tb_frame.f_globals.get("__name__", ""))
    written = code.co_code[place.tb_lasti] == dis.opmap["RAISE_VARARGS"]
    if not written or module.partition(".")[0] in ("numpy", "scipy"):
        return NotFiniteError(f"the {what} could not be evaluated: {error}")
    return RaisedError(f"ValueError: {error} ({os.path.basename(code.co_filename)}, line {place.tb_lineno})")
