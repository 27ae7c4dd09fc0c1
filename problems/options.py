"""Checks of the options of the problems, and the rule that overflow in an evaluation raises no warning."""

from __future__ import annotations

from decimal import Decimal
from numbers import Integral, Real
from typing import Any

import numpy as np
import scipy.sparse as sp
from attrs import Attribute

from continuation.arguments.checks import FINITE, integer
from continuation.arrays import Array
from continuation.arrays import finite as finite_sum
from continuation.budget import Budget
from continuation.linear.silence import without_warnings

quiet = without_warnings(over="ignore", invalid="ignore")
"""Decorates an evaluation whose overflow is to give inf or nan without a warning: the tracer handles these."""


positive_integer = integer(1)
finite = FINITE


def finite_or_none(instance: Any, attribute: Attribute[Any], value: Any) -> None:
    """As `finite`, with None allowed: a path without a target."""
    if value is not None:
        finite(instance, attribute, value)


def check_tolerance(value: Any) -> None:
    """Raise ValueError unless the argument `tolerance` is a number between 0 and 1."""
    if not isinstance(value, Real) or isinstance(value, bool) or not 0.0 < float(value) < 1.0:
        raise ValueError(f"tolerance: expected a number between 0 and 1, found {value!r}")


def check_seed(value: Any) -> None:
    """Raise ValueError unless the argument `seed` is an integer, at least 0."""
    if not isinstance(value, Integral) or isinstance(value, bool) or value < 0:
        raise ValueError(f"seed: expected an integer, at least 0, found {value!r}")


def check_budget(value: Any) -> None:
    """Raise TypeError unless the argument `budget` is a Budget or None."""
    if value is not None and not isinstance(value, Budget):
        raise TypeError(f"budget: expected a Budget, found {value!r}")


def real_array(name: str, value: Any) -> Array:
    """A copy of `value` as an array of floats, if it is made of real numbers that a float can hold.

    What nobody can change, a read-only array that owns its floats by rows, is taken as it is. Integers, floats,
    booleans, and objects that are real numbers, as fractions are, will do. Raises `ValueError` for anything else:
    complex numbers, dates, text, masked entries, rows of several lengths, numbers beyond 1e308.
    """
    if type(value) is np.ndarray and value.dtype == float:
        own = value.base is None and value.flags.c_contiguous and not value.flags.writeable
        kept: Array = value if own else np.array(value, order="C")
        return kept
    if np.ma.isMaskedArray(value) and np.ma.getmaskarray(value).any():
        raise ValueError(f"{name}: expected real numbers, found a masked array with masked entries; fill them first")
    try:
        # By rows, in which sums of products are taken; a matrix of MATLAB comes by columns.
        array = np.array(value, order="C")
        if array.dtype == object:
            if not all(_is_real(entry) for entry in array.flat):
                raise TypeError("objects that are no real numbers")
        elif array.dtype.kind not in "fiub":
            raise TypeError(f"dtype {array.dtype}")
        with np.errstate(over="ignore"):
            numbers: Array = array.astype(float, copy=False)
    except (TypeError, ValueError, OverflowError) as error:
        found = f"found {type(value).__name__} ({' '.join(str(error).split())[:100]})"
        raise ValueError(f"{name}: expected real numbers, {found}") from None
    if array.dtype.itemsize > numbers.itemsize and np.any(np.isinf(numbers) & np.isfinite(array)):
        raise ValueError(f"{name}: expected numbers below 1.8e308 in size, found larger ones")
    return numbers


def _is_real(entry: Any) -> bool:
    """Whether an object is a real number: one of Python's tower, or a decimal."""
    return isinstance(entry, (Real, Decimal, np.bool_)) or (isinstance(entry, np.ndarray) and entry.ndim == 0)


def sound_sparse(name: str, value: Any) -> Any:
    """A sparse matrix as CSR of floats, its structure checked: indices outside of the shape would corrupt memory.

    Entries that occur more than once add up, as floats. Raises `ValueError` if it holds anything but real numbers, or
    its indices do not belong to its shape.
    """
    if value.dtype.kind not in "fiub":
        raise ValueError(f"{name}: expected real numbers, found dtype {value.dtype}")
    if value.ndim != 2:
        raise ValueError(f"{name}: expected a matrix, found shape {value.shape}")
    try:
        if value.format in ("csr", "csc", "bsr"):
            # Of a copy of the outer object: scipy narrows the indices of the one that it checks.
            type(value)((value.data, value.indices, value.indptr), shape=value.shape).check_format(full_check=True)
        elif value.format == "coo":
            for indices, length in zip((value.row, value.col), value.shape):
                if len(indices) != len(value.data):
                    raise ValueError("there are not as many indices as entries")
                if len(indices) and not 0 <= indices.min() <= indices.max() < length:
                    raise ValueError(f"indices {indices.min()} to {indices.max()} where 0 to {length - 1} are possible")
        # Floats first: duplicates of small integers add up beyond them.
        matrix = sp.csr_array(value.astype(float))
        matrix.check_format(full_check=True)
        matrix.sum_duplicates()
    except (ValueError, TypeError, IndexError, OverflowError, MemoryError) as error:
        reason = " ".join(str(error).split())[:160]
        raise ValueError(f"{name}: expected a sparse matrix whose indices fit its shape, found {reason}") from None
    return matrix


def check_finite(name: str, value: Any) -> None:
    """A ValueError that says which entry of an array, or sparse matrix, is not finite, if there is one."""
    entries = value if isinstance(value, np.ndarray) else value.data
    # Numbers whose sum overflows may be finite all the same.
    if entries.size == 0 or finite_sum(entries.ravel()) or np.isfinite(entries).all():
        return
    at = np.argwhere(~np.isfinite(entries))[0]
    if sp.issparse(value):
        value = value.tocoo()
        at = np.array([value.coords[0][at[0]], value.coords[1][at[0]]])
    index = int(at[0]) if at.size == 1 else tuple(map(int, at))
    raise ValueError(f"{name}: expected finite numbers, found {entries[~np.isfinite(entries)][0]} at index {index}")


def finite_vector(name: str, value: Any, size: int | None = None) -> Array:
    """A copy of `value` as a vector of finite floats, of the given size if there is one, or ValueError naming it."""
    try:
        vector = real_array(name, value)
    except ValueError as error:
        raise ValueError(str(error).replace("expected real numbers", "expected a vector of real numbers", 1)) from None
    kind = np.asarray(value).dtype
    if kind.kind == "b" or vector.ndim != 1 or vector.size == 0:
        raise ValueError(f"{name}: expected a vector of real numbers, found shape {vector.shape}, dtype {kind}")
    if size is not None and vector.size != size:
        raise ValueError(f"{name}: expected {size} numbers, found {vector.size}")
    check_finite(name, vector)
    return vector
