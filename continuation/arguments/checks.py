"""Checks of arguments: messages read ``name: expected ..., found ...``."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from numbers import Integral, Real
from typing import Any

import numpy as np
from attrs import Attribute

_SHOWN = 200
"""Characters of a value in a message."""

Validator = Callable[[Any, "Attribute[Any]", Any], None]


def complain(error: type[Exception], name: str, expected: str, value: Any) -> Exception:
    """The exception about an argument."""
    kind = f" ({type(value).__name__})" if error is TypeError else ""
    found = " ".join(repr(value).split())
    shown = found if len(found) <= _SHOWN else f"{found[:_SHOWN]} ..."
    return error(f"{name}: expected {expected}, found {shown}{kind}")


def is_number(value: Any) -> bool:
    """Whether `value` is a real number, not True or False."""
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def number(expected: str, allowed: Callable[[float], bool] = math.isfinite) -> Validator:
    """An attrs validator for real numbers.

    `expected`: allowed numbers, for messages. `allowed`: False for NaN.
    """

    def check(instance: Any, attribute: Attribute[Any], value: Any) -> None:
        if not is_number(value):
            raise complain(TypeError, attribute.alias or attribute.name, "a real number", value)
        if not allowed(float(value)):
            raise complain(ValueError, attribute.alias or attribute.name, expected, value)

    return check


def integer(least: float = -math.inf, most: float = math.inf) -> Validator:
    """An attrs validator for integers from `least` to `most`."""

    def check(instance: Any, attribute: Attribute[Any], value: Any) -> None:
        if not isinstance(value, Integral) or isinstance(value, bool):
            raise complain(TypeError, attribute.alias or attribute.name, "an integer", value)
        if value < least:
            raise complain(ValueError, attribute.alias or attribute.name, f"at least {least:g}", value)
        if int(value) > most:
            raise complain(ValueError, attribute.alias or attribute.name, f"at most {most:g}", value)

    return check


def one_of(*values: int) -> Validator:
    """An attrs validator for a few integers."""
    expected = f"one of {', '.join(map(str, values))}"

    def check(instance: Any, attribute: Attribute[Any], value: Any) -> None:
        if not isinstance(value, Integral) or value not in values:
            raise complain(ValueError, attribute.alias or attribute.name, expected, value)

    return check


def of_kind(expected: str, holds: Callable[[Any], bool]) -> Validator:
    """An attrs validator: TypeError unless `holds(value)`."""

    def check(instance: Any, attribute: Attribute[Any], value: Any) -> None:
        if not holds(value):
            raise complain(TypeError, attribute.alias or attribute.name, expected, value)

    return check


def sign(instance: Any, attribute: Attribute[Any], value: Any) -> None:
    """An attrs validator for -1, 0 or 1."""
    check_sign(attribute.name, value)


def check_flag(name: str, value: Any) -> None:
    """Raise TypeError unless `value` is True or False."""
    if not isinstance(value, bool | np.bool_):
        raise complain(TypeError, name, "True or False", value)


def check_sign(name: str, value: Any) -> None:
    """Raise unless `value` is -1, 0 or 1."""
    if not is_number(value) or value not in (-1, 0, 1):
        raise complain(ValueError, name, "-1, 0 or 1", value)


POSITIVE = number("a positive number", lambda x: x > 0.0)
POSITIVE_FINITE = number("a positive finite number", lambda x: 0.0 < x < math.inf)
NOT_NEGATIVE = number("a finite number, at least 0", lambda x: 0.0 <= x < math.inf)
FINITE = number("a finite number")
FRACTION = number("a number between 0 and 1", lambda x: 0.0 < x < 1.0)
SHARE = number("a number from 0 to 1", lambda x: 0.0 <= x <= 1.0)
FACTOR = number("a finite number above 1", lambda x: 1.0 < x < math.inf)


def instance_with(name: str, value: Any, attributes: Sequence[str], expected: str) -> None:
    """Raise TypeError unless `value` is an object with the attributes, not a class."""
    if isinstance(value, type):
        raise TypeError(f"{name}: expected {expected}, found the class {value.__name__}; {value.__name__}() is one")
    missing = [attribute for attribute in attributes if not hasattr(value, attribute)]
    if missing:
        raise TypeError(f"{name}: expected {expected}, found {value!r}, which has no `{missing[0]}`")


def real_vector(name: str, value: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """A copy of `value` as an array of floats.

    Raises `ValueError` for complex or masked entries.
    """
    if np.ma.isMaskedArray(value) and np.ma.getmaskarray(value).any():
        raise ValueError(f"{name}: expected real numbers, found a masked array with masked entries; fill them first")
    try:
        array = np.array(value)
    except ValueError:
        array = np.array(None)
    if array.dtype.kind not in "fiu":
        found = f"{array.dtype} numbers" if array.dtype.kind == "c" else " ".join(repr(value).split())[:200]
        raise ValueError(f"{name}: expected real numbers, found {found}")
    with np.errstate(over="ignore"):
        # Too large longdoubles become infinite.
        return array.astype(float)
