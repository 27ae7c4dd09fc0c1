"""The table of numpy functions that jets support, and the call that looks them up."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np

FUNCTIONS: dict[Any, Callable[..., Any]] = {}
"""Rules by numpy function. The package fills it from `jets.functions`, whose rules are built on the class `Jet`."""


def unknown(operation: str) -> TypeError:
    """The error for what jets cannot do."""
    return TypeError(f"jets do not know {operation}; write it with numpy functions that they know, or give a jacobian")


def call(function: Any, args: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
    """Run a numpy function on jets; TypeError, naming the function, if it is not known in this form."""
    name = f"{function.__module__}.{function.__name__}"
    rule = FUNCTIONS.get(function)
    if rule is None:
        raise unknown(name)
    try:
        with np.errstate(all="ignore"):
            return rule(*args, **keywords)
    except TypeError:
        try:
            inspect.signature(rule).bind(*args, **keywords)
        except TypeError as mismatch:
            raise unknown(f"{name} with these arguments ({mismatch})") from None
        raise
