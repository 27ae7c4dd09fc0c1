"""Errors of evaluations."""

from __future__ import annotations

from typing import ClassVar

from continuation.rejection import Rejection


class EvaluationError(ArithmeticError):
    """The homotopy has no finite value or factorisation at a point."""

    rejection: ClassVar[Rejection] = Rejection.UNSOLVABLE


class NotFiniteError(EvaluationError):
    """A value is not finite, or the homotopy raised ValueError: the edge of the domain, or an overflow."""

    rejection = Rejection.NO_VALUE


class SingularPointError(EvaluationError):
    """The bordered matrix is singular."""

    rejection = Rejection.SINGULAR


def unevaluated(what: str, error: BaseException) -> EvaluationError:
    """`EvaluationError` for the homotopy's exception."""
    # A homotopy that wraps another passes it on.
    return error if isinstance(error, EvaluationError) else NotFiniteError(f"the {what} raised: {error}")
