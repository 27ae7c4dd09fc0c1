"""Errors of evaluations."""

from __future__ import annotations

from typing import ClassVar

from continuation.rejection import Rejection


class EvaluationError(ArithmeticError):
    """The homotopy has no finite value or factorisation at a point."""

    rejection: ClassVar[Rejection] = Rejection.UNSOLVABLE


class NotFiniteError(EvaluationError):
    """The edge of the domain, an overflow, or a ValueError of the homotopy's own."""

    rejection = Rejection.NO_VALUE


class SingularPointError(EvaluationError):
    """The bordered matrix is singular."""

    rejection = Rejection.SINGULAR


def unevaluated(what: str, error: BaseException) -> EvaluationError:
    """The error of a homotopy that raised another one."""
    # A homotopy inside this one may have raised it.
    return error if isinstance(error, EvaluationError) else NotFiniteError(f"the {what} raised: {error}")
