"""Numpy's warnings switched off for a whole trace, as switching is slow."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar, Token
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np

Given = ParamSpec("Given")
Returned = TypeVar("Returned")

_silent: ContextVar[bool] = ContextVar("silent", default=False)

silent: Callable[[], bool] = _silent.get
"""Whether this thread or task is in a `Silence`."""


class Silence:
    """A context without numpy warnings."""

    __slots__ = ("_before", "_errors")
    _before: Token[bool]
    _errors: np.errstate

    def __enter__(self) -> None:
        self._errors = np.errstate(all="ignore")
        self._errors.__enter__()
        self._before = _silent.set(True)

    def __exit__(self, *raised: Any) -> None:
        _silent.reset(self._before)
        self._errors.__exit__(*raised)


def without_warnings(**ignored: Any) -> Callable[[Callable[Given, Returned]], Callable[Given, Returned]]:
    """Decorator: no numpy warnings; free in a `Silence`."""

    def decorate(function: Callable[Given, Returned]) -> Callable[Given, Returned]:
        guarded = np.errstate(**ignored)(function)

        @wraps(function)
        def quiet(*arguments: Given.args, **named: Given.kwargs) -> Returned:
            return function(*arguments, **named) if silent() else guarded(*arguments, **named)

        return quiet

    return decorate
