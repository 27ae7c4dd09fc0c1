"""Numpy's warnings switched off, once for many evaluations: each time by itself takes as long as a small residual."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar, Token
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import numpy as np

Given = ParamSpec("Given")
Found = TypeVar("Found")

_silent: ContextVar[bool] = ContextVar("silent", default=False)

silent: Callable[[], bool] = _silent.get
"""Whether numpy warns of nothing since somebody, in this thread or task, is within a `Silence`."""


class Silence:
    """Within, numpy warns of nothing."""

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


def without_warnings(**ignored: Any) -> Callable[[Callable[Given, Found]], Callable[Given, Found]]:
    """Decorates a function within which numpy is not to warn, as `numpy.errstate` does; free of charge in a `Silence`.

    Parameters
    ----------
    **ignored
        As of `numpy.errstate`: each "ignore".
    """

    def decorate(function: Callable[Given, Found]) -> Callable[Given, Found]:
        guarded = np.errstate(**ignored)(function)

        @wraps(function)
        def quiet(*arguments: Given.args, **named: Given.kwargs) -> Found:
            return function(*arguments, **named) if silent() else guarded(*arguments, **named)

        return quiet

    return decorate
