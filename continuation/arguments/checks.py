"""Checks of arguments: messages read ``name: expected ..., found ...``."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from numbers import Integral, Real
from typing import Any

import numpy as np
from attrs import Attribute
from attrs.validators import and_

Validator = Callable[[Any, "Attribute[Any]", Any], None]


def complain(error: type[Exception], name: str, expected: str, value: Any) -> Exception:
    """The exception about an argument."""
    kind = f" ({type(value).__name__})" if error is TypeError else ""
    return error(f"{name}: expected {expected}, found {_shown(value)}{kind}")


def _shown(value: Any) -> str:
    return " ".join(repr(value).split())[:200]


def expect(fine: Any, name: str, expected: str, value: Any, error: type[Exception] = ValueError) -> None:
    """Raise the complaint unless `fine`."""
    if not fine:
        raise complain(error, name, expected, value)


def is_number(value: Any) -> bool:
    """Whether `value` is a real number, not True or False."""
    return isinstance(value, Real) and not isinstance(value, bool | np.bool_)


def of_kind(expected: str, holds: Callable[[Any], bool], error: type[Exception] = TypeError) -> Validator:
    """An attrs validator: an error unless `holds(value)`."""

    def check(instance: Any, attribute: Attribute[Any], value: Any) -> None:
        if not holds(value):
            raise complain(error, attribute.alias or attribute.name, expected, value)

    return check


def number(expected: str, allowed: Callable[[float], bool] = math.isfinite) -> Validator:
    """An attrs validator for real numbers.

    `expected`: names them in messages. `allowed`: False for NaN.
    """
    return and_(of_kind("a real number", is_number), of_kind(expected, lambda x: allowed(float(x)), ValueError))


def integer(least: float = -math.inf, most: float = math.inf) -> Validator:
    """An attrs validator for integers from `least` to `most`."""
    return and_(
        of_kind("an integer", lambda x: isinstance(x, Integral) and not isinstance(x, bool)),
        of_kind(f"at least {least:g}", lambda x: x >= least, ValueError),
        of_kind(f"at most {most:g}", lambda x: x <= most, ValueError),
    )


def one_of(*values: int) -> Validator:
    """An attrs validator for a few integers."""
    expected = f"one of {', '.join(map(str, values))}"
    return of_kind(expected, lambda x: isinstance(x, Integral) and x in values, ValueError)


def check_flag(name: str, value: Any) -> None:
    """Raise TypeError unless `value` is True or False."""
    expect(isinstance(value, bool | np.bool_), name, "True or False", value, TypeError)


def check_sign(name: str, value: Any) -> None:
    """Raise unless `value` is -1, 0 or 1."""
    expect(is_number(value) and value in (-1, 0, 1), name, "-1, 0 or 1", value)


def sign(instance: Any, attribute: Attribute[Any], value: Any) -> None:
    """An attrs validator for -1, 0 or 1."""
    check_sign(attribute.name, value)


POSITIVE = number("a positive number", lambda x: x > 0.0)
POSITIVE_FINITE = number("a positive finite number", lambda x: 0.0 < x < math.inf)
NOT_NEGATIVE = number("a finite number, at least 0", lambda x: 0.0 <= x < math.inf)
FINITE = number("a finite number")
FRACTION = number("a number between 0 and 1", lambda x: 0.0 < x < 1.0)
SHARE = number("a number from 0 to 1", lambda x: 0.0 <= x <= 1.0)
FACTOR = number("a finite number above 1", lambda x: 1.0 < x < math.inf)


def instance_with(name: str, value: Any, attributes: Sequence[str], expected: str) -> None:
    """Raise TypeError for a class, or an object without these attributes."""
    if isinstance(value, type):
        raise TypeError(f"{name}: expected {expected}, found the class {value.__name__}; {value.__name__}() is one")
    missing = [attribute for attribute in attributes if not hasattr(value, attribute)]
    if missing:
        raise TypeError(f"{name}: expected {expected}, found {value!r}, which has no `{missing[0]}`")


def real_vector(name: str, value: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """A copy of `value` as an array of floats; `ValueError` for complex or masked entries."""
    if np.ma.isMaskedArray(value) and np.ma.getmaskarray(value).any():
        raise ValueError(f"{name}: expected real numbers, found a masked array with masked entries; fill them first")
    try:
        array = np.array(value)
    except ValueError:
        array = np.array(None)
    if array.dtype.kind not in "fiu":
        found = f"{array.dtype} numbers" if array.dtype.kind == "c" else _shown(value)
        raise ValueError(f"{name}: expected real numbers, found {found}")
    with np.errstate(over="ignore"):
        # Too large longdoubles become infinite.
        return array.astype(float)
